#include "view/display.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/parallel.h"
#include "core/quantize.h"

namespace glint::view {

namespace {

constexpr int kRowsAtOnce = 32;  // a thread's share must outweigh its start

// The two neighbours of each target pixel along an axis, and the weight of the second in 1/256.
struct Tap {
    int first, second;
    uint32_t weight;
};

std::vector<Tap> tapsOf(int from, int to, bool smooth) {
    std::vector<Tap> taps(static_cast<size_t>(to));
    for (int i = 0; i < to; ++i) {
        const double at = (i + 0.5) * from / to - (smooth ? 0.5 : 0.0);
        const double inside = std::clamp(at, 0.0, static_cast<double>(from - 1));
        const int first = static_cast<int>(inside);
        const auto weight = smooth ? static_cast<uint32_t>((inside - first) * 256) : 0u;
        taps[static_cast<size_t>(i)] = {first, std::min(first + 1, from - 1), weight};
    }
    return taps;
}

// Two channels at once: bytes 0 and 2 of each word, with room for the carry between them.
uint32_t mix(uint32_t a, uint32_t b, uint32_t weight) {
    constexpr uint32_t kEven = 0x00ff00ffu;
    const uint32_t even = ((a & kEven) * (256 - weight) + (b & kEven) * weight) >> 8 & kEven;
    const uint32_t odd = ((a >> 8 & kEven) * (256 - weight) + (b >> 8 & kEven) * weight) & ~kEven;
    return even | odd;
}

constexpr uint32_t kNothing = packColor(0, 0, 0);

uint32_t packUnit(const glm::dvec3& color) {
    return packColor(linearByte(color.x), linearByte(color.y), linearByte(color.z));
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

uint32_t colorOf(const PixelData& d, ViewLayer layer, const Display& display, const LayerRange& range) {
    switch (layer) {
        case ViewLayer::Color:
            break;
        case ViewLayer::Depth: {
            if (!std::isfinite(d.depth)) return kNothing;
            const double width = range.hi > range.lo ? range.hi - range.lo : 1;
            const double at = std::clamp((d.depth - range.lo) / width, 0.0, 1.0);
            return packUnit(rangeColor(layer, display.toneMap, at));
        }
        case ViewLayer::Normal:
            return d.object == PixelData::kNoIndex ? kNothing : packUnit(0.5 * glm::dvec3(d.normal) + 0.5);
        case ViewLayer::Uv:
            return d.object == PixelData::kNoIndex ? kNothing : packUnit(glm::dvec3(d.u, d.v, 0.25));
        case ViewLayer::Object:
            return idColor(d.object);
        case ViewLayer::Primitive:
            return d.object == PixelData::kNoIndex ? kNothing : idColor(scatter(d.object) ^ d.primitive);
        case ViewLayer::Material:
            return idColor(d.material);
        case ViewLayer::Bounces:
            return packUnit(rangeColor(layer, display.toneMap, d.bounces / range.hi));
        case ViewLayer::Cost:
            return packUnit(rangeColor(layer, display.toneMap, d.cost / range.hi));
    }
    return kNothing;
}

void forRows(int height, const std::function<void(int)>& body) {
    parallelFor(Context{}, static_cast<size_t>((height + kRowsAtOnce - 1) / kRowsAtOnce), [&](size_t chunk) {
        const int begin = static_cast<int>(chunk) * kRowsAtOnce;
        for (int y = begin; y < std::min(begin + kRowsAtOnce, height); ++y) body(y);
    });
}

// Exposure and tone map of linear colors: a function of red, green and blue.
auto developer(const Display& display) {
    return [gain = static_cast<float>(std::exp2(display.exposure)), toneMap = display.toneMap](
               float r, float g, float b) {
        const glm::vec3 color = gain * glm::vec3(r, g, b);
        return toneMap == ToneMap::Linear ? color : glm::vec3(toneMapped(glm::dvec3(color), toneMap));
    };
}

// Blue, cyan, green, yellow, red for 0 to 1, as the screen's own numbers, 0..1.
glm::dvec3 heatOf(double x) {
    const double at = 4 * std::clamp(x, 0.0, 1.0);
    const auto ramp = [](double v) { return std::clamp(v, 0.0, 1.0); };
    return {ramp(at - 2), at < 2 ? ramp(at) : ramp(4 - at), ramp(2 - at)};
}

constexpr uint32_t kLine = packColor(255, 255, 255);

}  // namespace

// False color: 0 blue to 1 red for the luminance, by the screen's own numbers.
glm::dvec3 toneMapped(const glm::dvec3& color, ToneMap toneMap) {
    if (toneMap == ToneMap::Reinhard) return color / (1 + std::max(luminance(color), 0.0));
    if (toneMap == ToneMap::Aces) {
        const glm::dvec3 x = glm::max(color, glm::dvec3(0));
        return glm::clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
    }
    if (toneMap != ToneMap::False) return color;
    const double stops = std::log2(std::max(1e-30, luminance(color)));
    const glm::dvec3 heat = heatOf(0.5 + 0.5 * stops / kFalseStops);
    return {linearFromSrgb(heat.x), linearFromSrgb(heat.y), linearFromSrgb(heat.z)};
}

glm::dvec3 rangeColor(ViewLayer layer, ToneMap toneMap, double x) {
    const bool grey = layer == ViewLayer::Depth && toneMap != ToneMap::False;
    return grey ? glm::dvec3(1 - 0.85 * x) : heatOf(x);
}

void applyDisplay(Image& color, const Display& display) {
    if (display == Display{}) return;
    const auto develop = developer(display);
    for (size_t i = 0; i < color.pixels.size(); i += 4) {
        float* const pixel = &color.pixels[i];
        const glm::vec3 shown = develop(pixel[0], pixel[1], pixel[2]);
        std::copy_n(&shown.x, 3, pixel);
    }
}

Canvas stretched(Canvas source, int width, int height, bool smooth) {
    if (source.width == width && source.height == height) return source;
    Canvas target(width, height);
    if (source.pixels.empty()) return target;
    const std::vector<Tap> columns = tapsOf(source.width, width, smooth);
    const std::vector<Tap> rows = tapsOf(source.height, height, smooth);
    forRows(height, [&](int y) {
        const Tap& down = rows[static_cast<size_t>(y)];
        const uint32_t* upper = source.row(down.first);
        const uint32_t* lower = source.row(down.second);
        uint32_t* out = target.row(y);
        for (int x = 0; x < width; ++x) {
            const Tap& t = columns[static_cast<size_t>(x)];
            out[x] = smooth ? mix(mix(upper[t.first], upper[t.second], t.weight),
                                  mix(lower[t.first], lower[t.second], t.weight), down.weight)
                            : upper[t.first];
        }
    });
    return target;
}

Image toImage(const Canvas& canvas) {
    Image image(canvas.width, canvas.height, 3);
    for (size_t i = 0; i < canvas.pixels.size(); ++i) {
        for (size_t c = 0; c < 3; ++c) {
            const double encoded = static_cast<double>(canvas.pixels[i] >> (8 * c) & 0xffu) / 255;
            image.pixels[i * 3 + c] = static_cast<float>(linearFromSrgb(encoded));
        }
    }
    return image;
}

LayerRange rangeOf(const Picture& picture, ViewLayer layer) {
    if (layer == ViewLayer::Depth) return depthRange(picture);
    if (layer != ViewLayer::Bounces && layer != ViewLayer::Cost) return {};
    uint32_t most = 1;
    for (const PixelData& d : picture.data)
        most = std::max(most, layer == ViewLayer::Cost ? d.cost : d.bounces);
    return {0, static_cast<double>(most)};
}

Canvas colorize(const Picture& picture, ViewLayer layer, const Display& display, const LayerRange& range) {
    if (!needsData(layer)) return canvasOf(picture.color, display);
    Canvas canvas(picture.region.width(), picture.region.height());
    if (picture.data.size() != canvas.pixels.size()) return canvas;
    forRows(canvas.height, [&](int y) {
        const auto data = picture.data.begin() + static_cast<long>(y) * canvas.width;
        std::transform(data, data + canvas.width, canvas.row(y),
                       [&](const PixelData& d) { return colorOf(d, layer, display, range); });
    });
    return canvas;
}

Canvas canvasOf(const Image& image, const Display& display) {
    const auto develop = developer(display);
    Canvas canvas(image.width, image.height);
    const int green = std::min(1, image.channels - 1), blue = std::min(2, image.channels - 1);
    forRows(image.height, [&](int y) {
        const float* in = image.pixels.data() + static_cast<long>(y) * image.width * image.channels;
        uint32_t* const out = canvas.row(y);
        for (int x = 0; x < image.width; ++x, in += image.channels) {
            const glm::vec3 c = develop(in[0], in[green], in[blue]);
            out[x] = packColor(srgbByte(c.x), srgbByte(c.y), srgbByte(c.z));
        }
    });
    return canvas;
}

void measure(Comparison& comparison, const Image* a) {
    comparison.figures.reset();
    comparison.fault.clear();
    if (!comparison.linear || a == nullptr) {
        comparison.fault = "no colours to compare";
    } else if (a->width != comparison.linear->width || a->height != comparison.linear->height) {
        comparison.fault = "the images differ in size";
    } else {
        comparison.figures = compareImages(*a, *comparison.linear, 0, 1);
    }
}

void compose(const Comparison& comparison, const Image* a, const Display& display, bool flash,
             Canvas& shown) {
    if (comparison.mode == CompareMode::Difference) {
        if (a == nullptr || !comparison.figures) return;
        const Image difference = differenceImage(*a, *comparison.linear, static_cast<float>(comparison.gain));
        shown = stretched(canvasOf(difference, {}), shown.width, shown.height, false);
        return;
    }
    if (comparison.mode == CompareMode::Flicker && !flash) return;
    const Canvas other =
        stretched(comparison.linear ? canvasOf(*comparison.linear, display) : comparison.canvas, shown.width,
                  shown.height, false);
    const int end = comparison.mode == CompareMode::Flicker
                        ? shown.width
                        : static_cast<int>(std::lround(comparison.wipe * shown.width));
    for (int y = 0; y < shown.height; ++y) {
        std::copy_n(other.row(y), std::clamp(end, 0, shown.width), shown.row(y));
        if (end > 0 && end < shown.width) shown.row(y)[end] = kLine;
    }
}

}  // namespace glint::view
