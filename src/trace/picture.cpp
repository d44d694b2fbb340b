#include "trace/picture.h"

#include <algorithm>
#include <cmath>
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

int channelsOf(Aov aov) {
    switch (aov) {
        case Aov::Radiance:
        case Aov::Position:
        case Aov::Normal:
            return 3;
        case Aov::Uv:
            return 2;
        case Aov::Alpha:
        case Aov::Depth:
        case Aov::ObjectId:
        case Aov::PrimitiveId:
        case Aov::MaterialId:
        case Aov::Bounces:
        case Aov::Cost:
        case Aov::Error:
        case Aov::Samples:
            return 1;
    }
    return 0;
}

void fill(Aov aov, const PixelData& p, float* out) {
    switch (aov) {
        case Aov::Radiance:
        case Aov::Alpha:
        case Aov::Error:
        case Aov::Samples:
            return;  // not of the data
        case Aov::Depth:
            *out = static_cast<float>(p.depth);
            return;
        case Aov::Position:
            return fillVector(glm::vec3(p.position), out);
        case Aov::Normal:
            return fillVector(p.normal, out);
        case Aov::Uv:
            out[0] = p.u;
            out[1] = p.v;
            return;
        case Aov::ObjectId:
            *out = index(p.object);
            return;
        case Aov::PrimitiveId:
            *out = index(p.primitive);
            return;
        case Aov::MaterialId:
            *out = index(p.material);
            return;
        case Aov::Bounces:
            *out = static_cast<float>(p.bounces);
            return;
        case Aov::Cost:
            *out = static_cast<float>(p.cost);
            return;
    }
}

Image colorChannels(const Picture& picture, int first, int count) {
    Image image(picture.color.width, picture.color.height, count);
    const size_t pixels = image.pixels.size() / count;
    for (size_t i = 0; i < pixels; ++i) {
        for (int c = 0; c < count; ++c) image.pixels[i * count + c] = picture.color.pixels[i * 4 + first + c];
    }
    return image;
}

// The layers that stand in every picture, or in one drawn to an error.
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

void Picture::checkFinite(int x, int y) {
    if (isFinite(&color.pixels[indexOf(x, y) * 4])) return;
    const bool first = notFinite++ == 0;
    if (first || std::pair(y, x) < std::pair(firstNotFinite.y, firstNotFinite.x)) firstNotFinite = {x, y};
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
        const int channels = channelsOf(aov);
        if (!needsData(aov)) {
            layers.push_back({name, ownLayer(picture, aov)});
            continue;
        }
        Image image(picture.region.width(), picture.region.height(), channels);
        for (size_t i = 0; i < picture.data.size(); ++i)
            fill(aov, picture.data[i], &image.pixels[i * static_cast<size_t>(channels)]);
        layers.push_back({name, std::move(image)});
    }
    return layers;
}

}  // namespace glint
