// The pictures of glTF materials: GltfMaterials' textures.
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/image_io.h"
#include "import/gltf_material.h"

namespace glint {

namespace {

Wrap wrapOf(const JsonCursor& sampler, std::string_view key) {
    const auto mode = sampler.find(key);
    if (!mode) return Wrap::Repeat;
    const double number = mode->number();
    if (number == 10497) return Wrap::Repeat;
    if (number == 33071) return Wrap::Clamp;
    if (number == 33648) return Wrap::Mirror;
    mode->failWanted("must be 10497 (repeat), 33071 (clamp) or 33648 (mirror)");
}

// The file's number again from what readImage made of an 8- or 16-bit one (IEC 61966-2-1).
double srgbEncoded(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

// PNG and JPEG are all that glTF itself allows, WebP is an extension.
bool known(std::string_view bytes) {
    return bytes.substr(0, 12).ends_with("WEBP") || bytes.starts_with("\x89PNG\r\n\x1a\n") ||
           bytes.starts_with("\xff\xd8\xff");
}

}  // namespace

// Null, with a warning, for an image that is missing or cannot be read.
std::shared_ptr<const Image> GltfMaterials::image(size_t index) {
    if (const auto known = images_.find(index); known != images_.end()) return known->second;
    const JsonCursor image = file_.item(GltfList::Images, index);
    const auto uri = image.find("uri");
    const std::string source = uri ? uri->string() : "";
    if (const auto known = byUri_.find(source); uri && known != byUri_.end())
        return images_[index] = known->second;
    std::shared_ptr<const Image> decoded;
    try {
        const std::string owned = uri ? file_.readUri(*uri, true) : "";
        const std::string_view bytes =
            uri ? owned : file_.bufferView(file_.index(GltfList::BufferViews, image.require("bufferView")));
        if (!known(bytes)) image.fail("neither PNG, JPEG nor WebP");
        const auto* data = reinterpret_cast<const uint8_t*>(bytes.data());
        decoded = std::make_shared<const Image>(
            decodeImage({data, bytes.size()}, file_.name() + ": " + image.pointer(),
                        file_.files().mostPixels(), file_.files().context()));
        file_.files().takePicture(*decoded);
    } catch (const Error& error) {
        file_.warnOf(error, "drawn without this picture");
    }
    if (uri) byUri_[source] = decoded;
    return images_[index] = decoded;
}

std::optional<size_t> GltfMaterials::imageOf(const JsonCursor& info) {
    info.expectObject();
    const JsonCursor texture =
        file_.item(GltfList::Textures, file_.index(GltfList::Textures, info.require("index")));
    if (const auto source = texture.find("source")) return file_.index(GltfList::Images, *source);
    std::optional<size_t> webp;
    withExtension(texture, "EXT_texture_webp", [&](const JsonCursor& extension) {
        webp = file_.index(GltfList::Images, extension.require("source"));
    });
    if (webp) return webp;
    file_.warn(texture.pointer() + ": no \"source\"; drawn without this texture");
    return std::nullopt;
}

Texture GltfMaterials::sampled(const JsonCursor& texture, std::shared_ptr<const Image> image) {
    ImageTexture source;
    source.image = std::move(image);
    if (const auto reference = texture.find("sampler")) {
        const JsonCursor sampler =
            file_.item(GltfList::Samplers, file_.index(GltfList::Samplers, *reference));
        source.wrapU = wrapOf(sampler, "wrapS");
        source.wrapV = wrapOf(sampler, "wrapT");
        if (gltfNumber(sampler, "magFilter", 9729) == 9728) source.filter = TexelFilter::Nearest;
    }
    Texture result;
    result.source = std::move(source);
    return result;
}

GltfMaterials::Reference GltfMaterials::texture(const JsonCursor& info) {
    const auto index = imageOf(info);
    const auto picture = index ? image(*index) : nullptr;
    if (!picture) return {};
    Texture texture = sampled(
        file_.item(GltfList::Textures, file_.index(GltfList::Textures, info.require("index"))), picture);
    std::get<ImageTexture>(texture.source).file = file_.name() + ": /images/" + std::to_string(*index);
    double texCoord = gltfNumber(info, "texCoord", 0);
    std::optional<GltfUvTransform> turned;
    withExtension(info, "KHR_texture_transform", [&](const JsonCursor& transform) {
        const std::vector<double> offset = gltfNumbers(transform, "offset", 2);
        const std::vector<double> scale = gltfNumbers(transform, "scale", 2);
        const double rotation = gltfNumber(transform, "rotation", 0);
        texCoord = gltfNumber(transform, "texCoord", texCoord);
        const glm::dvec2 size = scale.empty() ? glm::dvec2(1) : glm::dvec2(scale[0], scale[1]);
        const glm::dvec2 shift = offset.empty() ? glm::dvec2(0) : glm::dvec2(offset[0], offset[1]);
        if (rotation != 0) {  // counter-clockwise, v counting downwards
            const double c = std::cos(rotation), s = std::sin(rotation);
            turned = GltfUvTransform{{c * size.x, -s * size.x}, {s * size.y, c * size.y}, shift};
            return;
        }
        texture.scale = size;
        // glTF's v' = shift + scale v counts downwards; with v = 1 - V, V' = 1 - v':
        texture.offset = {shift.x, 1 - shift.y - size.y};
    });
    if (!(texCoord >= 0 && texCoord < 1000)) info.fail("texCoord must be a small whole number");
    scene_.textures.push_back(std::move(texture));
    return {static_cast<uint32_t>(scene_.textures.size() - 1), static_cast<size_t>(texCoord), turned};
}

std::optional<GltfMaterials::Means> GltfMaterials::means(const JsonCursor& info) {
    const auto index = imageOf(info);
    const auto picture = index ? image(*index) : nullptr;
    if (!picture) return std::nullopt;
    if (const auto known = means_.find(*index); known != means_.end()) return known->second;
    Means means{};
    const auto pixels = static_cast<size_t>(picture->width) * static_cast<size_t>(picture->height);
    const auto channels = static_cast<size_t>(picture->channels);
    for (size_t c = 0; c < 3; c++) {
        double sum = 0, linear = 0;
        for (size_t i = 0; i < pixels; i++) {
            const auto value = static_cast<double>(picture->pixels[i * channels + (channels < 3 ? 0 : c)]);
            sum += srgbEncoded(value);
            linear += value;
        }
        means.numbers[c] = sum / static_cast<double>(pixels);
        means.color[static_cast<glm::length_t>(c)] = linear / static_cast<double>(pixels);
    }
    double alpha = 0;
    for (size_t i = 0; i < pixels; i++)
        alpha += channels == 4 ? static_cast<double>(picture->pixels[i * channels + 3]) : 1;
    means.numbers[3] = alpha / static_cast<double>(pixels);
    return means_.emplace(*index, means).first->second;
}

// Mean of one channel; 1, which has no effect, for an image that cannot be read.
double GltfMaterials::mean(const JsonCursor& info, int channel) {
    const auto found = means(info);
    return found ? found->numbers[channel] : 1;
}

}  // namespace glint
