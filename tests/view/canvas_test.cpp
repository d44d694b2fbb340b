#include "view/display.h"

#include <gtest/gtest.h>

#include "core/quantize.h"

namespace glint::view::canvas_test {
Canvas canvasOf(int width, int height, std::initializer_list<uint32_t> greys) {
    Canvas canvas(width, height);
    size_t i = 0;
    for (uint32_t g : greys) canvas.pixels[i++] = packColor(g, g, g);
    return canvas;
}

uint32_t grey(const Canvas& canvas, int x, int y) {
    return canvas.row(y)[x] & 255u;
}

TEST(Canvas, EqualSizesAreCopied) {
    const Canvas source = canvasOf(2, 2, {1, 2, 3, 255});
    Canvas target(2, 2);
    stretch(source, target, true);
    EXPECT_EQ(target.pixels, source.pixels);
}

TEST(Canvas, NearestRepeats) {
    Canvas target(4, 4);
    stretch(canvasOf(2, 2, {10, 20, 30, 40}), target, false);
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 4; ++x)
            EXPECT_EQ(grey(target, x, y), 10u + 10u * (x / 2) + 20u * (y / 2)) << x << "," << y;
    }
}

// Two pixels over four: centres at -1/4, 1/4, 3/4, 5/4 of the way, clamped at the ends.
TEST(Canvas, SmoothInterpolates) {
    Canvas target(4, 1);
    stretch(canvasOf(2, 1, {0, 200}), target, true);
    EXPECT_EQ(grey(target, 0, 0), 0u);
    EXPECT_EQ(grey(target, 1, 0), 50u);
    EXPECT_EQ(grey(target, 2, 0), 150u);
    EXPECT_EQ(grey(target, 3, 0), 200u);
    for (const uint32_t pixel : target.pixels) EXPECT_EQ(pixel >> 24, 255u);
}

TEST(Canvas, SmoothKeepsFlatColoursAndChannels) {
    Canvas source(3, 3, packColor(1, 254, 77)), target(7, 5);
    stretch(source, target, true);
    for (const uint32_t pixel : target.pixels) EXPECT_EQ(pixel, packColor(1, 254, 77));
}

TEST(Canvas, ImageGivesTheBytesBack) {
    Canvas canvas(256, 1);
    for (uint32_t i = 0; i < 256; ++i) canvas.pixels[i] = packColor(i, 255 - i, i / 2);
    const Image image = toImage(canvas);
    for (int i = 0; i < 256; ++i) {
        EXPECT_EQ(srgbByte(image.at(i, 0, 0)), i);
        EXPECT_EQ(srgbByte(image.at(i, 0, 1)), 255 - i);
        EXPECT_EQ(srgbByte(image.at(i, 0, 2)), i / 2);
    }
}

}  // namespace glint::view::canvas_test
