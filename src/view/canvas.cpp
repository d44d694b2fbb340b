#include "view/canvas.h"

#include <algorithm>

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

}  // namespace

void stretch(const Canvas& source, Canvas& target, bool smooth) {
    if (source.width == target.width && source.height == target.height) {
        target.pixels = source.pixels;
        return;
    }
    if (source.pixels.empty()) return;
    const std::vector<Tap> columns = tapsOf(source.width, target.width, smooth);
    const std::vector<Tap> rows = tapsOf(source.height, target.height, smooth);
    const size_t chunks = static_cast<size_t>((target.height + kRowsAtOnce - 1) / kRowsAtOnce);
    parallelFor(chunks, [&](size_t chunk) {
        const int begin = static_cast<int>(chunk) * kRowsAtOnce;
        for (int y = begin; y < std::min(begin + kRowsAtOnce, target.height); ++y) {
            const Tap& down = rows[static_cast<size_t>(y)];
            const uint32_t* upper = source.row(down.first);
            const uint32_t* lower = source.row(down.second);
            uint32_t* out = target.row(y);
            for (int x = 0; x < target.width; ++x) {
                const Tap& t = columns[static_cast<size_t>(x)];
                if (!smooth) {
                    out[x] = upper[t.first];
                    continue;
                }
                out[x] = mix(mix(upper[t.first], upper[t.second], t.weight),
                             mix(lower[t.first], lower[t.second], t.weight), down.weight);
            }
        }
    });
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

}  // namespace glint::view
