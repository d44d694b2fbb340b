#include "view/layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "core/parallel.h"
#include "core/quantize.h"

namespace glint::view {

namespace {

constexpr uint32_t kNothing = packColor(0, 0, 0);

uint32_t packUnit(double r, double g, double b) {
    return packColor(linearByte(r), linearByte(g), linearByte(b));
}

// Well-spread bits for numbers in a row: the finaliser of MurmurHash3 (Appleby 2008).
uint32_t scatter(uint32_t h) {
    h ^= h >> 16;
    h *= 0x85ebca6bu;
    h ^= h >> 13;
    h *= 0xc2b2ae35u;
    return h ^ h >> 16;
}

uint32_t idColor(uint32_t id) {
    if (id == PixelData::kNoIndex) return kNothing;
    const uint32_t h = scatter(id + 1);
    return packColor(64 + (h & 127u) + (h >> 24 & 63u), 64 + (h >> 8 & 127u) + (h >> 26 & 63u),
                     64 + (h >> 16 & 127u) + (h >> 20 & 63u));
}

// Blue, cyan, green, yellow, red for 0 to 1.
uint32_t heat(double x) {
    const double at = 4 * std::clamp(x, 0.0, 1.0);
    const auto ramp = [](double v) { return std::clamp(v, 0.0, 1.0); };
    return packUnit(ramp(at - 2), at < 2 ? ramp(at) : ramp(4 - at), ramp(2 - at));
}

using PixelColor = std::function<uint32_t(const PixelData&)>;

PixelColor depthColor(const Picture& picture) {
    std::vector<double> depths;
    depths.reserve(picture.data.size());
    for (const PixelData& d : picture.data) {
        if (std::isfinite(d.depth)) depths.push_back(d.depth);
    }
    if (depths.empty()) return [](const PixelData&) { return kNothing; };
    // A floor reaches to the horizon; its last pixels would leave one grey to all the rest.
    const auto last =
        depths.begin() + static_cast<long>(std::min(depths.size() - 1, depths.size() * 95 / 100));
    std::nth_element(depths.begin(), last, depths.end());
    const double lo = *std::min_element(depths.begin(), last + 1);
    const double range = *last > lo ? *last - lo : 1;
    return [lo, range](const PixelData& d) {
        if (!std::isfinite(d.depth)) return kNothing;
        const double grey = 1 - 0.85 * std::min((d.depth - lo) / range, 1.0);
        return packUnit(grey, grey, grey);
    };
}

PixelColor heatColor(const Picture& picture, uint32_t PixelData::*field) {
    uint32_t most = 1;
    for (const PixelData& d : picture.data) most = std::max(most, d.*field);
    return [field, most](const PixelData& d) { return heat(static_cast<double>(d.*field) / most); };
}

PixelColor colorOf(const Picture& picture, ViewLayer layer) {
    const auto id = [](uint32_t PixelData::*field) {
        return [field](const PixelData& d) { return idColor(d.*field); };
    };
    switch (layer) {
        case ViewLayer::Depth:
            return depthColor(picture);
        case ViewLayer::Normal:
            return [](const PixelData& d) {
                if (d.object == PixelData::kNoIndex) return kNothing;
                const glm::dvec3 n = 0.5 * glm::dvec3(d.normal) + 0.5;
                return packUnit(n.x, n.y, n.z);
            };
        case ViewLayer::Uv:
            return [](const PixelData& d) {
                if (d.object == PixelData::kNoIndex) return kNothing;
                return packUnit(static_cast<double>(d.u), static_cast<double>(d.v), 0.25);
            };
        case ViewLayer::Object:
            return id(&PixelData::object);
        case ViewLayer::Primitive:
            return [](const PixelData& d) {
                if (d.object == PixelData::kNoIndex) return kNothing;
                return idColor(scatter(d.object) ^ d.primitive);
            };
        case ViewLayer::Material:
            return id(&PixelData::material);
        case ViewLayer::Bounces:
            return heatColor(picture, &PixelData::bounces);
        default:
            return heatColor(picture, &PixelData::cost);
    }
}

void forRows(int height, const std::function<void(int)>& body) {
    constexpr int kRowsAtOnce = 32;
    parallelFor(static_cast<size_t>((height + kRowsAtOnce - 1) / kRowsAtOnce), [&](size_t chunk) {
        const int begin = static_cast<int>(chunk) * kRowsAtOnce;
        for (int y = begin; y < std::min(begin + kRowsAtOnce, height); ++y) body(y);
    });
}

}  // namespace

Canvas colorize(const Picture& picture, ViewLayer layer, double exposure) {
    Canvas canvas(picture.region.width(), picture.region.height());
    const size_t width = static_cast<size_t>(canvas.width);
    if (needsData(layer) && picture.data.size() != canvas.pixels.size()) return canvas;
    if (needsData(layer)) {
        const PixelColor color = colorOf(picture, layer);
        forRows(canvas.height, [&](int y) {
            const PixelData* data = picture.data.data() + static_cast<size_t>(y) * width;
            std::transform(data, data + width, canvas.row(y), color);
        });
        return canvas;
    }
    const auto gain = static_cast<float>(std::exp2(exposure));
    forRows(canvas.height, [&](int y) {
        const float* in = picture.color.pixels.data() + static_cast<size_t>(y) * width * 4;
        uint32_t* out = canvas.row(y);
        for (size_t x = 0; x < width; ++x, in += 4)
            out[x] = packColor(srgbByte(in[0] * gain), srgbByte(in[1] * gain), srgbByte(in[2] * gain));
    });
    return canvas;
}

}  // namespace glint::view
