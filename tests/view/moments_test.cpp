// What another moment, and what the panel has changed, take to be packed.
#include "view/view_scene.h"

#include <gtest/gtest.h>

#include <cstring>

#include "support/environment.h"
#include "support/support.h"

namespace glint::view::moments_test {
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
    const auto sameBytes = [](const auto& a, const auto& b) {
        return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
    };
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

}  // namespace glint::view::moments_test
