#include "trace/picture.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace glint {

namespace {

float index(uint32_t value) {
    return value == PixelData::kNoIndex ? -1.0f : static_cast<float>(value);
}

void fillVector(const glm::vec3& v, float* out) {
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

// The channels of a layer, and how it is made of a pixel's data; null for layers that do not come from it.
struct LayerSource {
    int channels;
    void (*fill)(const PixelData& p, float* out);
};
constexpr LayerSource kSources[] = {
    {3, nullptr},  // Radiance, and so on in the order of Aov
    {1, nullptr},
    {1, [](const PixelData& p, float* out) { *out = static_cast<float>(p.depth); }},
    {3, [](const PixelData& p, float* out) { fillVector(glm::vec3(p.position), out); }},
    {3, [](const PixelData& p, float* out) { fillVector(p.normal, out); }},
    {2,
     [](const PixelData& p, float* out) {
         out[0] = p.u;
         out[1] = p.v;
     }},
    {1, [](const PixelData& p, float* out) { *out = index(p.object); }},
    {1, [](const PixelData& p, float* out) { *out = index(p.primitive); }},
    {1, [](const PixelData& p, float* out) { *out = index(p.material); }},
    {1, [](const PixelData& p, float* out) { *out = static_cast<float>(p.bounces); }},
    {1, [](const PixelData& p, float* out) { *out = static_cast<float>(p.cost); }},
    {1, nullptr},
    {1, nullptr}};
static_assert(std::size(kSources) == kEnumEntries<Aov>.size());

Image colorChannels(const Picture& picture, int first, int count) {
    Image image(picture.color.width, picture.color.height, count);
    const size_t pixels = image.pixels.size() / count;
    for (size_t i = 0; i < pixels; ++i) {
        for (int c = 0; c < count; ++c) image.pixels[i * count + c] = picture.color.pixels[i * 4 + first + c];
    }
    return image;
}

// The layers of every image, or of one rendered to an error.
Image ownLayer(const Picture& picture, Aov aov) {
    if (aov == Aov::Radiance) return colorChannels(picture, 0, 3);
    if (aov == Aov::Alpha) return colorChannels(picture, 3, 1);
    Image image(picture.color.width, picture.color.height, 1);
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        if (aov == Aov::Error && !picture.errors.empty()) image.pixels[i] = picture.errors[i];
        if (aov == Aov::Samples)
            image.pixels[i] =
                static_cast<float>(picture.samples.empty() ? picture.samplesPerPixel : picture.samples[i]);
    }
    return image;
}

bool isFinite(const float* color) {
    return std::isfinite(color[0]) && std::isfinite(color[1]) && std::isfinite(color[2]);
}

}  // namespace

void PictureFlaws::add(const PictureFlaws& other) {
    const glm::ivec2 first = firstNotFinite, another = other.firstNotFinite;
    if (other.notFinite > 0 &&
        (notFinite == 0 || std::pair(another.y, another.x) < std::pair(first.y, first.x)))
        firstNotFinite = another;
    notFinite += other.notFinite;
    losses.add(other.losses);
}

void Picture::checkFinite(int x, int y) {
    if (!isFinite(&color.pixels[indexOf(x, y) * 4])) add({1, {x, y}, {}});
}

void blackenNotFinite(Picture& picture) {
    for (size_t i = 0; i < picture.color.pixels.size(); i += 4) {
        float* color = &picture.color.pixels[i];
        if (!isFinite(color)) std::fill_n(color, 3, 0.0f);
    }
}

std::vector<Layer> makeLayers(const Picture& picture, std::span<const Aov> aovs) {
    std::vector<Layer> layers;
    for (const Aov aov : aovs) {
        const std::string name(nameOf(aov));
        const LayerSource& source = kSources[static_cast<size_t>(aov)];
        if (!source.fill) {
            layers.push_back({name, ownLayer(picture, aov)});
            continue;
        }
        Image image(picture.region.width(), picture.region.height(), source.channels);
        for (size_t i = 0; i < picture.data.size(); ++i)
            source.fill(picture.data[i], &image.pixels[i * static_cast<size_t>(source.channels)]);
        layers.push_back({name, std::move(image)});
    }
    return layers;
}

}  // namespace glint
