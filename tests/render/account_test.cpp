// The account of lost branches, by itself: how far it may be off.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "verify/film.h"

namespace glint::verify {

namespace {

TreeLosses lossesOf(uint32_t cut, uint32_t depth, uint32_t room, uint32_t crowded) {
    TreeLosses losses;
    losses.cut.add(cut, 0.1 * cut);
    losses.depth.add(depth, 0.2 * depth);
    losses.room.add(room, 0.3 * room);
    losses.crowdedMedia = crowded;
    return losses;
}

TEST(AccountTest, CountsOfPixelsAlikeAreExact) {
    const TreeLosses lost = lossesOf(40, 50, 60, 7);
    Account account(1);
    account.addAlike(lost, 1);
    EXPECT_TRUE(account.agrees(lost, 0));
    const std::function<uint64_t&(TreeLosses&)> counts[] = {
        [](TreeLosses& l) -> uint64_t& { return l.cut.count; },
        [](TreeLosses& l) -> uint64_t& { return l.depth.count; },
        [](TreeLosses& l) -> uint64_t& { return l.room.count; },
        [](TreeLosses& l) -> uint64_t& { return l.crowdedMedia; }};
    for (const auto& count : counts) {
        for (const int step : {-1, 1}) {
            TreeLosses device = lost;
            count(device) += static_cast<uint64_t>(step);
            EXPECT_FALSE(account.agrees(device, 0));
            EXPECT_TRUE(account.agrees(device, 1));
        }
    }
    TreeLosses device = lost;
    device.cut.count -= 3;
    EXPECT_FALSE(account.agrees(device, 1));
}

TEST(AccountTest, BoundsAreRightToA256th) {
    const TreeLosses lost = lossesOf(40, 0, 0, 0);
    Account account(1);
    account.addAlike(lost, 0.5);  // by the sample's weight
    TreeLosses device;
    device.cut.count = 40;
    for (const double sign : {-1.0, 1.0}) {
        device.cut.sum = 2 * (1 + sign * 0x1p-8);
        EXPECT_TRUE(account.agrees(device, 0));
        device.cut.sum = 2 * (1 + sign * 0x1p-7);
        EXPECT_FALSE(account.agrees(device, 0));
    }
}

// None can bring more than the brightest light there is.
TEST(AccountTest, WhatNoBranchLosesIsNothing) {
    Account account(1);
    account.addAlike(lossesOf(0, 9, 0, 0), 1);
    TreeLosses device = lossesOf(0, 9, 0, 0);
    EXPECT_TRUE(account.agrees(device, 5));
    device.room.sum = 0.1;
    EXPECT_FALSE(account.agrees(device, 5));
}

// For a path of two bounces with other hits: three hits, up to six branches.
TEST(AccountTest, PixelsOfOtherPathsMayLoseWhatTheirHitsCan) {
    Account account(1);
    account.addOther(2, 1);
    TreeLosses device;
    EXPECT_TRUE(account.agrees(device, 0));
    device.depth.add(6, 6);
    device.crowdedMedia = 3;
    EXPECT_TRUE(account.agrees(device, 0));
    device.crowdedMedia = 4;
    EXPECT_FALSE(account.agrees(device, 0));
    device.crowdedMedia = 0;
    device.depth.add(1, 0);
    EXPECT_FALSE(account.agrees(device, 0));
}

// Near the greatest floats the device returns infinity. A scene without a bound has infinity, too.
TEST(AccountTest, EndlessBoundsAreNotJudged) {
    Account account(1e38);
    account.addAlike(lossesOf(4, 0, 0, 0), 1);
    TreeLosses device;
    device.cut.count = 4;
    device.cut.sum = std::numeric_limits<double>::infinity();
    EXPECT_TRUE(account.agrees(device, 0));
    device.cut.count = 5;
    EXPECT_FALSE(account.agrees(device, 0));
}

}  // namespace

// The sum of a pixel's samples, by itself: how far from their mean a picture may be.

namespace {

// A picture of one pixel.
Picture pixelOf(float value) {
    Picture picture;
    picture.color = Image(1, 1, 4, value);
    picture.data.resize(1);
    return picture;
}

// How many pixels differ from the samples' mean in a picture of this value.
size_t differing(const Film& film, double value, uint32_t samples) {
    Picture whole = pixelOf(static_cast<float>(value));
    whole.samplesPerPixel = samples;
    return film.differing(whole).size();
}

// Four samples, each of a hit that one light shines on: eight additions, so 20 units of 2^-24.
TEST(FilmTest, AMeanErrsByItsAdditionsAlone) {
    const PackedSamples samples = PackedSamples::fixed(std::vector<glm::dvec2>(4, {0.5, 0.5}));
    ASSERT_EQ(samples.round, 4u);
    Film film(samples, {0, 0, 1, 1}, 1);
    for (uint32_t i = 0; i < 4; ++i) film.add(i, pixelOf(0.25f * static_cast<float>(i + 1)));
    EXPECT_EQ(differing(film, 0.625, 4), 0u);
    for (const double sign : {-1.0, 1.0}) {
        EXPECT_EQ(differing(film, 0.625 * (1 + sign * 0x1p-20), 4), 0u);
        EXPECT_EQ(differing(film, 0.625 * (1 + sign * 0x1p-19), 4), 1u);
    }
    EXPECT_EQ(differing(film, 0.625, 3), 1u);
}

// A thousandth of the least normal number, or what a device makes of that: light through thick dark glass.
TEST(FilmTest, SubnormalMeansErrByMore) {
    const PackedSamples samples = PackedSamples::fixed(std::vector<glm::dvec2>(5, {0.5, 0.5}));
    Film film(samples, {0, 0, 1, 1}, 1);
    for (uint32_t i = 0; i < 5; ++i) film.add(i, pixelOf(0x1p-147f));
    for (const double seen : {0x1p-147, 0x1.4p-147, 0.0}) EXPECT_EQ(differing(film, seen, 5), 0u) << seen;
    EXPECT_EQ(differing(film, 0x1p-119, 5), 1u);
}

}  // namespace

}  // namespace glint::verify
