// Discs: numbers, rounding, boxes, and where the local frame begins.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pack/packed_scene.h"
#include "pack/primitives.h"
#include "support/scene_maker.h"

namespace glint::disc_test {
using namespace test;

TEST(PackDisc, RoundsAndNumbers) {
    Scene scene;
    scene.materials.resize(2);
    addObject(scene, SphereShape{{9, 0, 0}, 1});
    addObject(scene, DiscShape{{1, 2, 3}, {0, -7, 0}, 0.25}, 1);
    addObject(scene, TriangleShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
    const PackedScene packed = packScene(scene);
    ASSERT_EQ(packed.discs.size(), 1u);
    const shared::Disc& disc = packed.discs[0];
    EXPECT_EQ(disc.center, glm::vec3(1, 2, 3));
    EXPECT_EQ(disc.normal, glm::vec3(0, -1, 0));
    EXPECT_EQ(disc.radius, 0.25f);
    EXPECT_EQ(disc.id, 1u);
    EXPECT_EQ(disc.object, 1u);
    EXPECT_EQ(disc.material, 1u);
    EXPECT_EQ(packed.spheres[0].id, 0u);
    EXPECT_EQ(packed.triangles[0].id, 2u);
    // Three kinds: three leaves.
    EXPECT_EQ(packed.statistics.leaves, 3u);
}

// Along an axis the box is the flat square around the disc, whose thickness is exactly none.
TEST(PackDisc, BoxAlongAnAxis) {
    const Frame frame;
    const Box box = discBox(roundDisc({{1, 2, 3}, {0, 5, 0}, 0.5}, frame));
    EXPECT_EQ(box.lo.y, 2.0f);
    EXPECT_EQ(box.hi.y, 2.0f);
    for (const int axis : {0, 2}) {
        EXPECT_LE(box.lo[axis], axis == 0 ? 0.5f : 2.5f);
        EXPECT_GE(box.hi[axis], axis == 0 ? 1.5f : 3.5f);
        EXPECT_NEAR(box.hi[axis] - box.lo[axis], 1, 4 * 0x1p-22);
    }
}

// The rim never leaves the box, and on every axis it comes within a few roundings of both faces.
TEST(PackDisc, BoxesFitTheRim) {
    std::mt19937 engine(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int i = 0; i < 300; ++i) {
        glm::dvec3 normal(uniform(engine), uniform(engine), uniform(engine));
        if (i % 3 == 0) normal.x *= 1e-6;  // nearly along an axis, where 1 - n^2 cancels
        if (i % 5 == 0) normal.z *= 1e-5;
        const shared::Disc disc =
            roundDisc({10.0 * glm::dvec3(uniform(engine), uniform(engine), uniform(engine)), normal,
                       std::exp(5 * uniform(engine))},
                      Frame{});
        const Box box = discBox(disc);
        const glm::dvec3 n = glm::normalize(glm::dvec3(disc.normal));
        for (int axis = 0; axis < 3; ++axis) {
            // The rim's farthest points: along the axis as projected to the plane.
            glm::dvec3 e(0);
            e[axis] = 1;
            const glm::dvec3 along = glm::cross(n, glm::cross(e, n));
            if (glm::length(along) < 1e-9) continue;
            const glm::dvec3 reach = static_cast<double>(disc.radius) * glm::normalize(along);
            const double hi = disc.center[axis] + reach[axis], lo = disc.center[axis] - reach[axis];
            const double slack = 0x1p-21 * (std::abs(disc.center[axis]) + disc.radius);
            EXPECT_LE(hi, box.hi[axis]);
            EXPECT_GE(lo, box.lo[axis]);
            EXPECT_GE(hi, box.hi[axis] - slack);
            EXPECT_LE(lo, box.lo[axis] + slack);
        }
    }
}

TEST(PackDisc, CountsForTheLocalFrame) {
    Scene scene;
    scene.camera.eye = {1e7, 0, 5};
    scene.camera.target = {1e7, 0, 0};
    addObject(scene, DiscShape{{1e7, 0, 0}, {0, 0, 1}, 3});
    const PackedScene packed = packScene(scene);
    EXPECT_NEAR(packed.origin.x, 1e7, 8);
    EXPECT_EQ(packed.discs[0].center.x + packed.origin.x, 1e7);
}

}  // namespace glint::disc_test
