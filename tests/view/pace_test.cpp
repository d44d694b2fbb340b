#include "view/session.h"

#include <gtest/gtest.h>

namespace glint::view::pace_test {
constexpr double kFull = 960 * 540;

// A device that traces a pixel in `secondsPerPixel`: the scale that the pace comes to.
double settledScale(Pace& pace, double secondsPerPixel, double other) {
    for (int i = 0; i < 40; ++i) {
        const double scale = pace.scale(kFull);
        const double pixels = kFull * scale * scale;
        pace.measured(pixels, pixels * secondsPerPixel, other);
    }
    return pace.scale(kFull);
}

TEST(Pace, StaysFullWhereThereIsTime) {
    Pace pace(0.033);
    EXPECT_EQ(settledScale(pace, 0.02 / kFull, 0.005), 1);
    EXPECT_EQ(pace.depth(9, kFull), 9);
}

// A quarter of the pixels takes a quarter of 0.1 s, which with 5 ms of other work is within 33 ms; a step of
// 1/16 more is not.
TEST(Pace, HoldsTheTarget) {
    Pace pace(0.033);
    const double scale = settledScale(pace, 0.1 / kFull, 0.005);
    EXPECT_LE(0.1 * scale * scale + 0.005, 0.033);
    EXPECT_GT(0.1 * (scale + 0.0625) * (scale + 0.0625) + 0.005, 0.033);
}

TEST(Pace, DropsDepthAfterResolution) {
    Pace pace(0.033);
    settledScale(pace, 0.2 / kFull, 0.005);
    EXPECT_EQ(pace.depth(9, kFull), 1);
    EXPECT_EQ(pace.depth(0, kFull), 0);
}

TEST(Pace, RecoversWhenThingsGetCheaper) {
    Pace pace(0.033);
    const double slow = settledScale(pace, 1.0 / kFull, 0.005);
    EXPECT_LT(slow, 0.25);
    EXPECT_EQ(settledScale(pace, 0.01 / kFull, 0.005), 1);
}

TEST(Pace, HasAFloor) {
    Pace pace(0.033);
    EXPECT_EQ(settledScale(pace, 100 / kFull, 0.005), Pace::kLeast);
    // Even when everything else takes all the time, a part of it is for the picture.
    EXPECT_GT(settledScale(pace, 0.02 / kFull, 1.0), Pace::kLeast);
}

TEST(Pace, AWindowWithoutPixelsIsNoFault) {
    Pace pace(0.033);
    pace.measured(0, 0.001, 0.001);
    EXPECT_GE(pace.scale(0), Pace::kLeast);
    EXPECT_LE(pace.scale(0), 1);
}

// A ray that ends in glass is black, so rays are followed through an object however coarse the image is.
TEST(Pace, FollowsRaysThroughGlass) {
    Pace pace(0.03);
    pace.measured(1e5, 10, 0);
    EXPECT_EQ(pace.depth(5, 1e6), 1);
    EXPECT_EQ(pace.depth(5, 1e6, true), Pace::kGlassDepth);
    EXPECT_EQ(pace.depth(2, 1e6, true), 2);
}

}  // namespace glint::view::pace_test
