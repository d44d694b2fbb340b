#include "view/layers.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "view/keys.h"
#include "view/session.h"

namespace glint::view::layers_test {
namespace {

Picture pictureOf(int width, int height) {
    Picture picture;
    picture.region = {0, 0, width, height};
    picture.color = Image(width, height, 4);
    picture.data.resize(static_cast<size_t>(width) * static_cast<size_t>(height));
    return picture;
}

TEST(Layers, NamesAreThoseOfTheCommandLine) {
    for (const EnumEntry<ViewLayer>& entry : kEnumEntries<ViewLayer>)
        EXPECT_TRUE(named<Aov>(entry.name)) << entry.name;
}

// sRGB of linear 0.5 is 188 (IEC 61966-2-1: 1.055 * 0.5^(1/2.4) - 0.055 = 0.7354, times 255 = 187.5).
TEST(Layers, ColourIsEncodedAndExposed) {
    Picture picture = pictureOf(1, 1);
    picture.color.pixels = {0.25f, 0.5f, 0.0f, 1.0f};
    EXPECT_EQ(colorize(picture, ViewLayer::Color, 0).pixels[0] >> 8 & 255u, 188u);
    EXPECT_EQ(colorize(picture, ViewLayer::Color, 1).pixels[0] & 255u, 188u);
    EXPECT_EQ(colorize(picture, ViewLayer::Color, 8).pixels[0] & 0xffffu, 0xffffu);
}

TEST(Layers, NearIsWhite) {
    Picture picture = pictureOf(3, 1);
    picture.data[0].depth = 2;
    picture.data[1].depth = 4;
    const Canvas canvas = colorize(picture, ViewLayer::Depth, 0);
    EXPECT_EQ(canvas.pixels[0], packColor(255, 255, 255));
    EXPECT_LT(canvas.pixels[1] & 255u, 64u);
    EXPECT_EQ(canvas.pixels[2], packColor(0, 0, 0));  // infinitely far: nothing there
}

TEST(Layers, IdsInARowHaveOtherColours) {
    Picture picture = pictureOf(64, 1);
    for (uint32_t i = 0; i < 64; ++i) picture.data[i].object = i;
    const Canvas canvas = colorize(picture, ViewLayer::Object, 0);
    EXPECT_EQ(std::set<uint32_t>(canvas.pixels.begin(), canvas.pixels.end()).size(), 64u);
}

TEST(Layers, HeatGoesFromBlueToRed) {
    Picture picture = pictureOf(3, 1);
    picture.data[1].cost = 50;
    picture.data[2].cost = 100;
    const Canvas canvas = colorize(picture, ViewLayer::Cost, 0);
    EXPECT_EQ(canvas.pixels[0], packColor(0, 0, 255));
    EXPECT_EQ(canvas.pixels[1], packColor(0, 255, 0));
    EXPECT_EQ(canvas.pixels[2], packColor(255, 0, 0));
}

// Nothing to show is black, not a fault: the picture at hand was traced for another layer.
TEST(Layers, MissingDataIsBlack) {
    Picture picture = pictureOf(2, 2);
    picture.data.clear();
    for (const uint32_t pixel : colorize(picture, ViewLayer::Normal, 0).pixels)
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

}  // namespace
}  // namespace glint::view::layers_test
