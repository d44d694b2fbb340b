// The pace of a moving image, and error targets with a tracer whose true image is known.
#include <gtest/gtest.h>

#include "../support/support.h"
#include "converge/known_film.h"
#include "view/session.h"

namespace glint::view::test::session_test {
using converge::kSide;

// In bands of ten rows, as the window draws.
void passOver(converge::Replicates& goal, const converge::Film& film, double depth = 0) {
    Request request;
    request.width = request.height = kSide;
    request.samples = goal.begin(1);
    for (int y = 0; y < kSide; y += 10) {
        request.region = Region{0, y, kSide, y + 10};
        Picture band = converge::drawn(film, request);
        if (depth > 0) band.losses.depth.add(1, depth);
        goal.add(band, {0, 0, kSide, kSide});
    }
    goal.end();
}

converge::Replicates goalOf(double error, uint32_t seed = 0, bool knowsDepth = true) {
    return {converge::jobOf(error, seed).request, {.error = error}, knowsDepth};
}

TEST(SessionUntil, EndsWhereRenderDoes) {
    const converge::Film film = converge::edgeFilm();
    for (uint32_t seed = 0; seed < 5; ++seed) {
        converge::Replicates goal = goalOf(0.02, seed);
        const converge::State& state = goal.state;
        double first = 0;
        while (!state.stop) {
            passOver(goal, film);
            if (goal.isDue()) goal.look(0);
            if (state.rounds == 1 && first == 0) first = state.budget.total();
        }
        const converge::Result result =
            converge::converge(converge::drawOf(film), converge::jobOf(0.02, seed));
        EXPECT_EQ(state.stop, converge::Stop::Reached);
        EXPECT_EQ(state.samplesPerPixel, result.samplesPerPixel);
        EXPECT_EQ(state.rounds, result.rounds);
        EXPECT_LE(state.budget.total(), 0.02);
        EXPECT_LT(state.budget.total(), first / 3);
        // All of its samples at once draw the same picture.
        Request request;
        request.width = request.height = kSide;
        request.samples = goal.taken();
        ASSERT_EQ(request.samples.count(), result.samplesPerPixel);
        const Picture again = converge::drawn(film, request);
        for (size_t i = 0; i < again.color.pixels.size(); ++i)
            EXPECT_NEAR(again.color.pixels[i], i % 4 == 3 ? 0 : result.picture.color.pixels[i], 1e-6);
    }
}

TEST(SessionUntil, SaysWhatNoSampleMends) {
    const converge::Film film = converge::edgeFilm();
    converge::Replicates rounded = goalOf(0.02);
    EXPECT_EQ(inWords(rounded.state, 0.02), "error not known yet; until 0.02");
    const auto twice = [&](converge::Replicates& goal, double depth) {
        for (int i = 0; i < 2; ++i) passOver(goal, film, depth);
        ASSERT_TRUE(goal.isDue());
    };
    twice(rounded, 0);
    rounded.look(0.03);
    EXPECT_EQ(rounded.state.stop, converge::Stop::Fixed);
    EXPECT_EQ(inWords(rounded.state, 0.02), "out of reach: rounding and cuts may take 0.03");

    // One branch of 8 in each of the four bands: sqrt(8 x 32 / 1600).
    converge::Replicates cut = goalOf(0.02);
    twice(cut, 8);
    cut.look(0);
    EXPECT_EQ(inWords(cut.state, 0.02), "out of reach: beyond the depth there may be 0.4");

    converge::Replicates flat = goalOf(0.02, 0, false);
    twice(flat, 0);
    flat.look(0);
    EXPECT_EQ(flat.state.stop, converge::Stop::Fixed);
    EXPECT_HAS(inWords(flat.state, 0.02), "with depth 0");
}

// ---- pace ----

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

// A quarter of the pixels takes a quarter of 0.1 s, with 5 ms of other work within 33 ms; 1/16 more is not.
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
    // Even when everything else takes all the time, a part of it is for the image.
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

}  // namespace glint::view::test::session_test
