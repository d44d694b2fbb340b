#include "view/display.h"

#include <gtest/gtest.h>

#include <set>

#include "core/quantize.h"
#include "view/session.h"

namespace glint::view::display_test {
Picture pictureOf(int width, int height) {
    Picture picture;
    picture.region = {0, 0, width, height};
    picture.color = Image(width, height, 4);
    picture.data.resize(static_cast<size_t>(width) * static_cast<size_t>(height));
    return picture;
}

Canvas shown(const Picture& picture, ViewLayer layer, double exposure) {
    return colorize(picture, layer, {exposure, ToneMap::Linear}, rangeOf(picture, layer));
}

TEST(Layers, NamesAreThoseOfTheCommandLine) {
    for (const EnumEntry<ViewLayer>& entry : kEnumEntries<ViewLayer>)
        EXPECT_TRUE(named<Aov>(entry.name)) << entry.name;
}

// sRGB of linear 0.5 is 188 (IEC 61966-2-1: 1.055 * 0.5^(1/2.4) - 0.055 = 0.7354, times 255 = 187.5).
TEST(Layers, ColourIsEncodedAndExposed) {
    Picture picture = pictureOf(1, 1);
    picture.color.pixels = {0.25f, 0.5f, 0.0f, 1.0f};
    EXPECT_EQ(shown(picture, ViewLayer::Color, 0).pixels[0] >> 8 & 255u, 188u);
    EXPECT_EQ(shown(picture, ViewLayer::Color, 1).pixels[0] & 255u, 188u);
    EXPECT_EQ(shown(picture, ViewLayer::Color, 8).pixels[0] & 0xffffu, 0xffffu);
}

TEST(Layers, NearIsWhite) {
    Picture picture = pictureOf(3, 1);
    picture.data[0].depth = 2;
    picture.data[1].depth = 4;
    const Canvas canvas = shown(picture, ViewLayer::Depth, 0);
    EXPECT_EQ(canvas.pixels[0], packColor(255, 255, 255));
    EXPECT_LT(canvas.pixels[1] & 255u, 64u);
    EXPECT_EQ(canvas.pixels[2], packColor(0, 0, 0));  // infinitely far: nothing there
}

// A part of a picture has the colours that it has in the whole, by the whole's range.
TEST(Layers, PartsShareTheRangeOfTheWhole) {
    Picture whole = pictureOf(4, 1), part = pictureOf(2, 1);
    for (uint32_t i = 0; i < 4; ++i) {
        whole.data[i].depth = 1 + i;
        whole.data[i].cost = 10 * i;
    }
    part.data = {whole.data[0], whole.data[1]};
    for (const ViewLayer layer : {ViewLayer::Depth, ViewLayer::Cost}) {
        const LayerRange range = rangeOf(whole, layer);
        const Canvas all = colorize(whole, layer, {}, range), some = colorize(part, layer, {}, range);
        EXPECT_EQ(some.pixels[0], all.pixels[0]);
        EXPECT_EQ(some.pixels[1], all.pixels[1]);
        EXPECT_NE(colorize(part, layer, {}, rangeOf(part, layer)).pixels[1], all.pixels[1]);
    }
}

// Reinhard: 1 / (1 + 1). Narkowicz's fit at 1: 2.54 / 3.16, by hand.
TEST(Layers, ToneMapsAreTheirFormulas) {
    EXPECT_NEAR(toneMapped({1, 1, 1}, ToneMap::Reinhard).x, 0.5, 1e-12);
    EXPECT_NEAR(toneMapped({1, 1, 1}, ToneMap::Aces).y, 2.54 / 3.16, 1e-12);
    EXPECT_EQ(toneMapped({0, 0, 0}, ToneMap::Aces), glm::dvec3(0));
    EXPECT_EQ(toneMapped({3, 0.5, 0}, ToneMap::Linear), glm::dvec3(3, 0.5, 0));
    EXPECT_LT(toneMapped(glm::dvec3(1e6), ToneMap::Reinhard).x, 1);
}

// A luminance of 1 is in the middle: green; 2^-8 and less blue, 2^8 and more red.
TEST(Layers, FalseColorShowsStops) {
    Picture picture = pictureOf(3, 1);
    const float values[] = {1.0f / 1024, 1, 1024};
    for (size_t i = 0; i < 3; ++i)
        for (size_t c = 0; c < 3; ++c) picture.color.pixels[4 * i + c] = values[i];
    const Canvas canvas = colorize(picture, ViewLayer::Color, {0, ToneMap::False}, {});
    EXPECT_EQ(canvas.pixels[0], packColor(0, 0, 255));
    EXPECT_EQ(canvas.pixels[1], packColor(0, 255, 0));
    EXPECT_EQ(canvas.pixels[2], packColor(255, 0, 0));
}

TEST(Layers, IdsInARowHaveOtherColours) {
    Picture picture = pictureOf(64, 1);
    for (uint32_t i = 0; i < 64; ++i) picture.data[i].object = i;
    const Canvas canvas = shown(picture, ViewLayer::Object, 0);
    EXPECT_EQ(std::set<uint32_t>(canvas.pixels.begin(), canvas.pixels.end()).size(), 64u);
}

TEST(Layers, HeatGoesFromBlueToRed) {
    Picture picture = pictureOf(3, 1);
    picture.data[1].cost = 50;
    picture.data[2].cost = 100;
    const Canvas canvas = shown(picture, ViewLayer::Cost, 0);
    EXPECT_EQ(canvas.pixels[0], packColor(0, 0, 255));
    EXPECT_EQ(canvas.pixels[1], packColor(0, 255, 0));
    EXPECT_EQ(canvas.pixels[2], packColor(255, 0, 0));
}

// Nothing to show is black, not a fault: the picture at hand was traced for another layer.
TEST(Layers, MissingDataIsBlack) {
    Picture picture = pictureOf(2, 2);
    picture.data.clear();
    for (const uint32_t pixel : shown(picture, ViewLayer::Normal, 0).pixels)
        EXPECT_EQ(pixel, packColor(0, 0, 0));
}

// Halton's first points by hand: 1 -> (1/2, 1/3), 2 -> (1/4, 2/3), 3 -> (3/4, 1/9).
TEST(Layers, ProgressiveSamplesAreHaltons) {
    EXPECT_EQ(progressiveOffset(0), glm::dvec2(0.5, 0.5));
    const double expected[3][2] = {{0.5, 1.0 / 3}, {0.25, 2.0 / 3}, {0.75, 1.0 / 9}};
    for (int k = 1; k <= 3; ++k) {
        EXPECT_NEAR(progressiveOffset(k).x, expected[k - 1][0], 1e-15);
        EXPECT_NEAR(progressiveOffset(k).y, expected[k - 1][1], 1e-15);
    }
}

// ---- canvases ----

Canvas greys(int width, int height, std::initializer_list<uint32_t> greys) {
    Canvas canvas(width, height);
    size_t i = 0;
    for (uint32_t g : greys) canvas.pixels[i++] = packColor(g, g, g);
    return canvas;
}

uint32_t grey(const Canvas& canvas, int x, int y) {
    return canvas.row(y)[x] & 255u;
}

TEST(Canvas, EqualSizesAreCopied) {
    const Canvas source = greys(2, 2, {1, 2, 3, 255});
    EXPECT_EQ(stretched(source, 2, 2, true).pixels, source.pixels);
}

TEST(Canvas, NearestRepeats) {
    const Canvas target = stretched(greys(2, 2, {10, 20, 30, 40}), 4, 4, false);
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 4; ++x)
            EXPECT_EQ(grey(target, x, y), 10u + 10u * (x / 2) + 20u * (y / 2)) << x << "," << y;
    }
}

// Two pixels over four: centres at -1/4, 1/4, 3/4, 5/4 of the way, clamped at the ends.
TEST(Canvas, SmoothInterpolates) {
    const Canvas target = stretched(greys(2, 1, {0, 200}), 4, 1, true);
    EXPECT_EQ(grey(target, 0, 0), 0u);
    EXPECT_EQ(grey(target, 1, 0), 50u);
    EXPECT_EQ(grey(target, 2, 0), 150u);
    EXPECT_EQ(grey(target, 3, 0), 200u);
    for (const uint32_t pixel : target.pixels) EXPECT_EQ(pixel >> 24, 255u);
}

TEST(Canvas, SmoothKeepsFlatColoursAndChannels) {
    for (const uint32_t pixel : stretched({3, 3, packColor(1, 254, 77)}, 7, 5, true).pixels)
        EXPECT_EQ(pixel, packColor(1, 254, 77));
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

}  // namespace glint::view::display_test
