// Playing, stepping and scrubbing, by a clock that the test turns.
#include <gtest/gtest.h>

#include "view/view_scene.h"

namespace glint::view::timeline_test {
Timeline twoSeconds(double start = 0) {
    Timeline t;
    t.follow(AnimationSpan{.framesPerSecond = 24, .tracks = 1, .start = start, .end = start + 2});
    return t;
}

// The very numbers of `glint render --frames`: frame / frames a second.
TEST(TimelineTest, StepsAreTheFramesOfRender) {
    Timeline t = twoSeconds();
    EXPECT_EQ(t.time(), std::nullopt);
    t.step(1);
    EXPECT_EQ(t.time(), 0.0);
    t.step(1);
    EXPECT_EQ(t.time(), 1 / 24.0);
    t.step(6);
    EXPECT_EQ(t.time(), 7 / 24.0);
    t.step(-3);
    EXPECT_EQ(t.time(), 4 / 24.0);
    EXPECT_EQ(t.frame(), 4);
    t.step(-9);
    EXPECT_EQ(t.time(), 0.0);
    t.goTo(900);
    EXPECT_EQ(t.time(), 2.0);
    Timeline other = twoSeconds();
    other.step(-1);
    EXPECT_EQ(other.time(), 2.0) << "from before the beginning to the end";
}

// From between two frames, as --time may put it, a step goes to the next one.
TEST(TimelineTest, StepsGoToFrames) {
    Timeline t = twoSeconds();
    t.setTime(0.5 / 24);
    t.step(1);
    EXPECT_EQ(t.time(), 1 / 24.0);
    t.setTime(1.5 / 24);
    t.step(-1);
    EXPECT_EQ(t.time(), 1 / 24.0);
}

TEST(TimelineTest, KeyframesMayBeginAndEndBetweenFrames) {
    Timeline t;
    t.follow(AnimationSpan{.framesPerSecond = 10, .tracks = 1, .start = 0.55, .end = 1.21});
    EXPECT_EQ(t.first(), 5);
    EXPECT_EQ(t.last(), 13);
    t.follow(AnimationSpan{
        .framesPerSecond = 30, .tracks = 1, .start = 0.1, .end = 0.7});  // 3, 21 but for rounding
    EXPECT_EQ(t.first(), 3);
    EXPECT_EQ(t.last(), 21);
}

// A device that takes 0.2 s for a frame shows every fifth one, and the second hand is right.
TEST(TimelineTest, LateFramesAreLeftOut) {
    Timeline t = twoSeconds();
    t.play(100);
    EXPECT_TRUE(t.playing());
    EXPECT_EQ(t.time(), 0.0);
    EXPECT_FALSE(t.advance(100.04));
    EXPECT_TRUE(t.advance(100.05));
    EXPECT_EQ(t.frame(), 1);
    EXPECT_TRUE(t.advance(101.21));
    EXPECT_EQ(t.frame(), 29);
    EXPECT_TRUE(t.playing());
}

TEST(TimelineTest, LoopsUnlessAsked) {
    Timeline t = twoSeconds(1);  // frames 24 to 72
    t.play(0);
    t.advance(1.99);
    EXPECT_EQ(t.frame(), 71);
    t.advance(2.001);
    EXPECT_EQ(t.frame(), 24) << "the last one is the first one";
    t.advance(2 + 2 + 0.5);
    EXPECT_EQ(t.frame(), 36);
    t.setLoops(false);
    t.advance(9);
    EXPECT_EQ(t.frame(), 72);
    EXPECT_FALSE(t.playing());
    t.play(20);
    EXPECT_EQ(t.frame(), 24) << "anew at the end";
}

// A file that is loaded again: the moment stays, and goes on.
TEST(TimelineTest, TheMomentStays) {
    Timeline t = twoSeconds();
    t.goTo(12);
    t.play(0);
    t.follow(AnimationSpan{.framesPerSecond = 48, .tracks = 1, .start = 0, .end = 4});
    EXPECT_EQ(t.time(), 0.5);
    EXPECT_EQ(t.frame(), 24);
    EXPECT_TRUE(t.advance(0.25));
    EXPECT_EQ(t.time(), 0.75);
}

TEST(TimelineTest, WithoutAnAnimationNothingMoves) {
    Timeline t;
    t.play(0);
    EXPECT_FALSE(t.playing());
    t.step(1);
    EXPECT_EQ(t.time(), std::nullopt);
    Timeline one;
    one.follow(AnimationSpan{.framesPerSecond = 24, .tracks = 1, .start = 1, .end = 1});
    one.play(0);
    EXPECT_FALSE(one.playing());
    Timeline gone = twoSeconds();
    gone.play(0);
    gone.follow(std::nullopt);
    EXPECT_FALSE(gone.advance(1));
}

}  // namespace glint::view::timeline_test
