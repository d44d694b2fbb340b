#include "import/mtl_maps.h"

#include <algorithm>

#include "core/error.h"
#include "core/quantize.h"
#include "core/text_file.h"

namespace glint {

namespace {

// Some exporters write a black colour beside a map: then the map counts alone.
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

std::optional<Texture> MtlMaps::load(const MtlMap& map) {
    ImageTexture image;
    image.file = map.file;
    try {
        image.image = files_.image(files_.findOrBeside(file_.parent_path(), map.file));
    } catch (const Error& e) {
        const std::string warning = file_.string() + ": " + e.what() + "; drawn without it";
        if (warned_.insert(warning).second) warnings_.push_back(warning);
        return std::nullopt;
    }
    image.wrapU = image.wrapV = map.clamp ? Wrap::Clamp : Wrap::Repeat;
    return Texture{std::move(image), map.scale, map.offset};
}

uint32_t MtlMaps::add(const MtlMapTable& maps, const char* key) {
    const auto map = maps.find(key);
    if (map == maps.end()) return Material::kNoTexture;
    auto texture = load(map->second);
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

void MtlMaps::applyAlpha(const MtlMap& map, const std::string& diffuseFile, Material& material) {
    const uint32_t diffuse = material.diffuseTexture;
    const Image* color = diffuse == Material::kNoTexture
                             ? nullptr
                             : std::get<ImageTexture>(textures_[diffuse].source).image.get();
    const bool own = color && map.file == diffuseFile;
    if (!(own && color->channels == 4)) {
        auto cover = load(map);
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

void MtlMaps::apply(const MtlMapTable& maps, Material& material) {
    const auto fileOf = [&](const char* key) {
        const auto map = maps.find(key);
        return map == maps.end() ? std::string() : map->second.file;
    };
    const std::string diffuse = fileOf("map_kd"), ambient = fileOf("map_ka");
    material.diffuseTexture = add(maps, "map_kd");
    const bool ambientIsDiffuse = material.ambient == material.diffuse;
    tint(material.diffuse, material.diffuseTexture);
    if (ambient.empty() || ambient == diffuse) {
        if (ambientIsDiffuse) material.ambient = material.diffuse;
        material.ambientTexture = material.diffuseTexture;
    } else {
        material.ambientTexture = add(maps, "map_ka");
        tint(material.ambient, material.ambientTexture);
    }
    if (material.specular != Color(0)) material.specularTexture = add(maps, "map_ks");
    if (material.mirror != Color(0)) material.mirrorTexture = material.specularTexture;
    if (const auto cover = maps.find("map_d"); cover != maps.end())
        applyAlpha(cover->second, diffuse, material);
}

}  // namespace glint
