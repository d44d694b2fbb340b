// A picture as the screen wants it: bytes R, G, B, A in a 32-bit word (R lowest), top row first.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"

namespace glint::view {

struct Canvas {
    int width = 0, height = 0;
    std::vector<uint32_t> pixels;

    Canvas() = default;
    Canvas(int w, int h, uint32_t color = 0xff000000u)
        : width(w), height(h), pixels(static_cast<size_t>(w) * static_cast<size_t>(h), color) {}
    uint32_t* row(int y) { return pixels.data() + static_cast<size_t>(y) * static_cast<size_t>(width); }
    const uint32_t* row(int y) const {
        return pixels.data() + static_cast<size_t>(y) * static_cast<size_t>(width);
    }
};

constexpr uint32_t packColor(uint32_t r, uint32_t g, uint32_t b) {
    return 0xff000000u | b << 16 | g << 8 | r;
}

// Fills `target` with `source` stretched to its size; smooth: bilinear, else each pixel takes the nearest.
// Of equal sizes, a plain copy.
void stretch(const Canvas& source, Canvas& target, bool smooth);

// The canvas as a linear image of 3 channels, so that writing it as PNG gives its bytes again.
Image toImage(const Canvas& canvas);

}  // namespace glint::view
