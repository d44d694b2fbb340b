#include "import/mtl_maps.h"

#include <algorithm>

#include "core/error.h"
#include "core/quantize.h"
#include "core/text_file.h"

namespace glint {

namespace {

// A map that is given counts though its colour is left black, as some exporters write it.
void tint(Color& color, uint32_t texture) {
    if (texture != Material::kNoTexture && color == Color(0)) color = Color(1);
}

// `color` (or white, if null) with the grey of `cover` as alpha, in the size of `color`. A grey image is
// decoded as sRGB like any other, but a coverage is a plain number, so it is encoded again.
Image withAlpha(const Image* color, const Image& cover) {
    const int width = color ? color->width : cover.width, height = color ? color->height : cover.height;
    Image result(width, height, 4, 1.0f);
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            if (color)
                for (int c = 0; c < 3; c++) result.at(x, y, c) = color->at(x, y, color->channels < 3 ? 0 : c);
            const auto column =
                static_cast<int>((static_cast<int64_t>(2 * x) + 1) * cover.width / (2 * width));
            const auto row =
                static_cast<int>((static_cast<int64_t>(2 * y) + 1) * cover.height / (2 * height));
            result.at(x, y, 3) = static_cast<float>(srgbByte(cover.at(column, row, 0))) / 255.0f;
        }
    }
    return result;
}

}  // namespace

std::optional<Texture> MtlMaps::load(const std::string& name, const tinyobj::texture_option_t& options) {
    // Files written on Windows spell folders with a backslash.
    std::string path = name;
    std::replace(path.begin(), path.end(), '\\', '/');
    ImageTexture image;
    image.file = name;
    try {
        image.image = files_.image(files_.resolve(file_.parent_path(), path));
    } catch (const Error& e) {
        const std::string warning = file_.string() + ": " + e.what() + "; drawn without it";
        if (warned_.insert(warning).second) warnings_.push_back(warning);
        return std::nullopt;
    }
    image.wrapU = image.wrapV = options.clamp ? Wrap::Clamp : Wrap::Repeat;
    return Texture{std::move(image),
                   {options.scale[0], options.scale[1]},
                   {options.origin_offset[0], options.origin_offset[1]}};
}

uint32_t MtlMaps::add(const std::string& name, const tinyobj::texture_option_t& options) {
    if (name.empty()) return Material::kNoTexture;
    auto texture = load(name, options);
    if (!texture) return Material::kNoTexture;
    textures_.push_back(std::move(*texture));
    return static_cast<uint32_t>(textures_.size() - 1);
}

std::shared_ptr<const Image> MtlMaps::combined(const Image* color,
                                               const std::shared_ptr<const Image>& cover) {
    std::shared_ptr<const Image>& made = combined_[{color, cover.get()}];
    if (!made) {
        const Image& size = color ? *color : *cover;
        if (static_cast<uint64_t>(size.width) * static_cast<uint64_t>(size.height) > files_.mostPixels())
            throw Error(ErrorKind::Scene,
                        printable(file_.string() + ": its textures take more memory than there is"));
        made = std::make_shared<const Image>(withAlpha(color, *cover));
        files_.takePicture(*made);
    }
    return made;
}

void MtlMaps::applyAlpha(const tinyobj::material_t& from, Material& material) {
    if (from.alpha_texname.empty()) return;
    const uint32_t diffuse = material.diffuseTexture;
    const Image* color = diffuse == Material::kNoTexture
                             ? nullptr
                             : std::get<ImageTexture>(textures_[diffuse].source).image.get();
    const bool own = color && from.alpha_texname == from.diffuse_texname;
    if (!(own && color->channels == 4)) {
        auto cover = load(from.alpha_texname, from.alpha_texopt);
        if (!cover) return;
        auto& image = std::get<ImageTexture>(cover->source);
        if (color) {
            cover->scale = textures_[diffuse].scale;
            cover->offset = textures_[diffuse].offset;
        }
        image.image = combined(color, image.image);
        textures_.push_back(std::move(*cover));
        const auto combined = static_cast<uint32_t>(textures_.size() - 1);
        if (material.ambientTexture == diffuse) material.ambientTexture = combined;
        material.diffuseTexture = combined;
    }
    material.alphaCutoff = 0.5;
}

void MtlMaps::apply(const tinyobj::material_t& from, Material& material) {
    material.diffuseTexture = add(from.diffuse_texname, from.diffuse_texopt);
    const bool ambientIsDiffuse = material.ambient == material.diffuse;
    tint(material.diffuse, material.diffuseTexture);
    if (from.ambient_texname.empty() || from.ambient_texname == from.diffuse_texname) {
        if (ambientIsDiffuse) material.ambient = material.diffuse;
        material.ambientTexture = material.diffuseTexture;
    } else {
        material.ambientTexture = add(from.ambient_texname, from.ambient_texopt);
        tint(material.ambient, material.ambientTexture);
    }
    if (material.specular != Color(0))
        material.specularTexture = add(from.specular_texname, from.specular_texopt);
    if (material.mirror != Color(0)) material.mirrorTexture = material.specularTexture;
    applyAlpha(from, material);
}

}  // namespace glint
