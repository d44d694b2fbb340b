// Tests of repacking after a change of time or an edit in the panel, and of the timeline, which plays by
// times that the test gives.
#include "view/view_scene.h"

#include <gtest/gtest.h>

#include "support/environment.h"
#include "support/support.h"

namespace glint::view::moments_test {
using glint::test::sameBytes;

const char* const kScene = R"({"camera": {"eye": [0, 1, 6]}, "ambient": 0.5,
  "lights": [{"type": "point", "position": [0, 5, 0]}],
  "materials": {"red": {"diffuse": [0.8, 0.1, 0.1]}, "blue": {"diffuse": [0.1, 0.1, 0.8]}},
  "meshes": {"part": {"file": "part.obj"}},
  "objects": [{"type": "mesh", "mesh": "part", "material": "red"},
              {"type": "mesh", "mesh": "part", "material": "red", "transform": [{"translate": [0, 3, 0]}]},
              {"type": "sphere", "center": [1, 0, 0], "radius": 0.5, "material": "blue"}],
  "animation": {"tracks": [
    {"target": "/camera/eye", "times": [0, 4], "values": [[0, 1, 6], [1, 1, 6]]},
    {"target": "/objects/2/center", "times": [1, 2], "values": [[1, 0, 0], [1, 1, 0]]},
    {"target": "/lights/0/position", "times": [2, 4], "values": [[0, 5, 0], [0, 6, 0]]},
    {"target": "/materials/blue/diffuse", "times": [1, 2], "values": [[0.1, 0.1, 0.8], [0.1, 0.8, 0.8]]}]}})";

class MomentsTest : public glint::test::FolderTest {
  protected:
    void SetUp() override {
        glint::test::writeText(file("scene.json"), kScene);
        glint::test::writeText(file("part.obj"),
                               "v -1 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 2 3 4\n");
    }
    Moments moments(std::optional<double> time = {}) { return {file("scene.json"), {}, time}; }
    static const Material& material(const Scene& scene, const std::string& name) {
        for (const Material& m : scene.materials)
            if (m.name == name) return m;
        throw std::runtime_error("no " + name);
    }
};

// In the first second the camera alone moves.
TEST_F(MomentsTest, ACameraThatMovesPacksNothing) {
    Moments m = moments();
    const Moment first = m.show();
    ASSERT_TRUE(first.scene);
    EXPECT_EQ(first.time, std::nullopt);
    m.show(0.25, first.edits, first.edits);  // from what the file says to a moment
    const Moment moved = m.show(0.5, first.edits, first.edits);
    EXPECT_EQ(moved.scene, nullptr);
    EXPECT_EQ(moved.time, 0.5);
    EXPECT_EQ(moved.file->camera.eye, glm::dvec3(0.125, 1, 6));
    const Moment later = m.show(1.5, first.edits, first.edits);
    ASSERT_TRUE(later.scene);
    EXPECT_EQ(later.file->camera.eye, glm::dvec3(0.375, 1, 6));
    EXPECT_EQ(m.show(1.5, first.edits, first.edits).scene, nullptr) << "the same moment";
}

// If lights and materials change alone no tree is built; the arrays are those of the file read then.
TEST_F(MomentsTest, WhatHasNotMovedIsNotBuiltAgain) {
    Moments m = moments();
    const Moment first = m.show();
    m.show(2.5, first.edits, first.edits);
    const uint64_t built = m.treesBuilt();
    EXPECT_EQ(built, 2u) << "the file's, and that of the ball's last place";
    const Moment later = m.show(3, first.edits, first.edits);
    ASSERT_TRUE(later.scene);
    EXPECT_EQ(m.treesBuilt(), built);
    Moments direct = moments(3);
    const PackedScene &kept = later.scene->packed, &read = direct.show().scene->packed;
    EXPECT_TRUE(sameBytes(kept.nodes, read.nodes));
    EXPECT_TRUE(sameBytes(kept.spheres, read.spheres));
    EXPECT_TRUE(sameBytes(kept.lights, read.lights));
    EXPECT_FALSE(sameBytes(kept.lights, first.scene->packed.lights));
}

// A material builds no tree.
TEST_F(MomentsTest, AnEditBuildsNoTree) {
    Moments m = moments();
    const Moment first = m.show();
    SceneEdits edits = first.edits;
    edits.materials[0].diffuse = Color(0.25);
    const uint64_t built = m.treesBuilt();
    const Moment changed = m.show({}, edits, first.edits);
    ASSERT_TRUE(changed.scene);
    EXPECT_EQ(changed.scene->scene.materials[0].diffuse, Color(0.25));
    EXPECT_NE(changed.file->materials[0].diffuse, Color(0.25));
    EXPECT_EQ(m.treesBuilt(), built);
}

// What the user has changed stays, what the animation moves besides moves.
TEST_F(MomentsTest, EditsStayWhileTheRestMoves) {
    Moments m = moments();
    const Moment first = m.show();
    SceneEdits edits = first.edits;
    for (Material& each : edits.materials)
        if (each.name == "red") each.diffuse = Color(0.25);
    const Moment later = m.show(2, edits, first.edits);
    ASSERT_TRUE(later.scene);
    EXPECT_EQ(material(later.scene->scene, "red").diffuse, Color(0.25));
    EXPECT_EQ(material(later.scene->scene, "blue").diffuse, Color(0.1, 0.8, 0.8));
    EXPECT_EQ(later.edits, SceneEdits::of(later.scene->scene));
}

// ---- the timeline ----

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
    t.loops = false;
    t.advance(9);
    EXPECT_EQ(t.frame(), 72);
    EXPECT_FALSE(t.playing());
    t.play(20);
    EXPECT_EQ(t.frame(), 24) << "playing restarts at the first frame";
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

}  // namespace glint::view::moments_test
