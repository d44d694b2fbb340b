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

uint32_t heat(double x) {
    const glm::dvec3 color = heatOf(x);
    return packUnit(color.x, color.y, color.z);
}

using PixelColor = std::function<uint32_t(const PixelData&)>;

// A floor reaches to the horizon; its last pixels would leave one grey to all the rest.
LayerRange depthRange(const Picture& picture) {
    std::vector<double> depths;
    depths.reserve(picture.data.size());
    for (const PixelData& d : picture.data) {
        if (std::isfinite(d.depth)) depths.push_back(d.depth);
    }
    if (depths.empty()) return {};
    const auto last =
        depths.begin() + static_cast<long>(std::min(depths.size() - 1, depths.size() * 95 / 100));
    std::nth_element(depths.begin(), last, depths.end());
    return {*std::min_element(depths.begin(), last + 1), *last};
}

PixelColor depthColor(const LayerRange& range, const Display& display) {
    const double width = range.hi > range.lo ? range.hi - range.lo : 1;
    const bool colored = display.toneMap == ToneMap::False;
    return [lo = range.lo, width, colored](const PixelData& d) {
        if (!std::isfinite(d.depth)) return kNothing;
        const double at = std::clamp((d.depth - lo) / width, 0.0, 1.0);
        if (colored) return heat(at);
        const double grey = 1 - 0.85 * at;
        return packUnit(grey, grey, grey);
    };
}

PixelColor heatColor(const LayerRange& range, uint32_t PixelData::*field) {
    return
        [field, most = range.hi](const PixelData& d) { return heat(static_cast<double>(d.*field) / most); };
}

PixelColor colorOf(ViewLayer layer, const Display& display, const LayerRange& range) {
    const auto id = [](uint32_t PixelData::*field) {
        return [field](const PixelData& d) { return idColor(d.*field); };
    };
    switch (layer) {
        case ViewLayer::Depth:
            return depthColor(range, display);
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
            return heatColor(range, &PixelData::bounces);
        default:
            return heatColor(range, &PixelData::cost);
    }
}

void forRows(int height, const std::function<void(int)>& body) {
    constexpr int kRowsAtOnce = 32;
    parallelFor(static_cast<size_t>((height + kRowsAtOnce - 1) / kRowsAtOnce), [&](size_t chunk) {
        const int begin = static_cast<int>(chunk) * kRowsAtOnce;
        for (int y = begin; y < std::min(begin + kRowsAtOnce, height); ++y) body(y);
    });
}

uint32_t shown(const glm::vec3& color, ToneMap toneMap) {
    if (toneMap == ToneMap::False) return heat(falseColorOf(luminance(glm::dvec3(color))));
    const glm::vec3 mapped =
        toneMap == ToneMap::Linear ? color : glm::vec3(toneMapped(glm::dvec3(color), toneMap));
    return packColor(srgbByte(mapped.x), srgbByte(mapped.y), srgbByte(mapped.z));
}

}  // namespace

LayerRange rangeOf(const Picture& picture, ViewLayer layer) {
    if (layer == ViewLayer::Depth) return depthRange(picture);
    if (layer != ViewLayer::Bounces && layer != ViewLayer::Cost) return {};
    uint32_t most = 1;
    for (const PixelData& d : picture.data)
        most = std::max(most, layer == ViewLayer::Cost ? d.cost : d.bounces);
    return {0, static_cast<double>(most)};
}

Canvas colorize(const Picture& picture, ViewLayer layer, const Display& display, const LayerRange& range) {
    Canvas canvas(picture.region.width(), picture.region.height());
    const size_t width = static_cast<size_t>(canvas.width);
    if (needsData(layer) && picture.data.size() != canvas.pixels.size()) return canvas;
    if (needsData(layer)) {
        const PixelColor color = colorOf(layer, display, range);
        forRows(canvas.height, [&](int y) {
            const PixelData* data = picture.data.data() + static_cast<size_t>(y) * width;
            std::transform(data, data + width, canvas.row(y), color);
        });
        return canvas;
    }
    const auto gain = static_cast<float>(std::exp2(display.exposure));
    forRows(canvas.height, [&](int y) {
        const float* in = picture.color.pixels.data() + static_cast<size_t>(y) * width * 4;
        uint32_t* out = canvas.row(y);
        for (size_t x = 0; x < width; ++x, in += 4)
            out[x] = shown(gain * glm::vec3(in[0], in[1], in[2]), display.toneMap);
    });
    return canvas;
}

}  // namespace glint::view
