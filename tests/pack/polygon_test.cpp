// Polygons: numbers, the array of vertices, boxes, leaves that the device can finish.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pack/packed_scene.h"
#include "pack/primitives.h"
#include "support/scene_maker.h"

namespace glint::polygon_test {
using namespace test;

PolygonShape ring(uint32_t corners, const glm::dvec3& center, double radius) {
    PolygonShape shape;
    for (uint32_t i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * i / corners;
        shape.vertices.push_back(center + radius * glm::dvec3(std::cos(angle), std::sin(angle), 0));
    }
    return shape;
}

TEST(PackPolygon, OutlinesAreClosedAndFilledUp) {
    Scene scene;
    scene.materials.resize(2);
    addObject(scene, DiscShape{});
    addObject(scene, PolygonShape{{{0, 0, 4}, {2, 0, 4}, {2, 2, 4}}});
    addObject(scene, PolygonShape{{{9, 9, 0}, {9, 8, 0}, {8, 8, 0}, {7, 8, 0}, {8, 9, 0}}}, 1);
    const PackedScene packed = packScene(scene);
    ASSERT_EQ(packed.polygons.size(), 2u);
    EXPECT_EQ(packed.discs[0].id, 0u);
    for (const shared::Polygon& p : packed.polygons) {
        ASSERT_TRUE(p.object == 1 || p.object == 2);
        const auto& given = std::get<PolygonShape>(scene.objects[p.object].shape).vertices;
        EXPECT_EQ(p.id, p.object);
        EXPECT_EQ(p.material, p.object - 1);
        EXPECT_EQ(p.primitive, 0u);
        EXPECT_EQ(p.normal, glm::vec3(0, 0, p.object == 1 ? 1 : -1));
        EXPECT_EQ(p.trips, p.object == 1 ? 1u : 2u);
        ASSERT_LE(p.firstVertex + 4 * p.trips + 1, packed.polygonVertices.size());
        for (size_t i = 0; i <= 4 * size_t{p.trips}; ++i)
            EXPECT_EQ(packed.polygonVertices[p.firstVertex + i].position,
                      glm::vec3(given[i < given.size() ? i : 0]))
                << i;
    }
    EXPECT_EQ(packed.polygonVertices.size(), 5u + 9u);
}

// T74: rounded to fp32 at 2^24 the thin one is a line; what the eye sees keeps the origin at 0.
TEST(PackPolygon, AreaIsJudgedAfterRounding) {
    const double far = 16777216;
    Scene scene;
    scene.camera.eye = {0, 0, 0};
    addObject(scene,
              PolygonShape{{{far, far, 0}, {far + 8, far, 0}, {far + 8, far + 0.5, 0}, {far, far + 0.5, 0}}});
    addObject(scene,
              PolygonShape{{{far, far, 0}, {far + 8, far, 0}, {far + 8, far + 4, 0}, {far, far + 4, 0}}});
    addObject(scene, SphereShape{{0, 0, -3}, 1});
    const PackedScene packed = packScene(scene);
    ASSERT_EQ(packed.polygons.size(), 1u);
    EXPECT_EQ(packed.polygons[0].id, 1u);
    EXPECT_EQ(packed.statistics.droppedZeroArea, 1u);
    ASSERT_EQ(packed.warnings.size(), 1u);
    EXPECT_EQ(packed.warnings[0].find("/objects/0: 1 of 1 polygons dropped: no area"), 0u)
        << packed.warnings[0];
}

// Flat along an axis but for the edge test's margin, 2^-20 of the size; else as thick as what the rounded
// vertices leave between themselves and their plane.
// Of an outline that crosses itself Newell's sum leaves a twentieth of the areas here: rounded vertices would
// turn the plane 20 times as far as they are off.
TEST(PackPolygon, ThePlaneIsThatOfTheVerticesAsRead) {
    const glm::dvec3 u = glm::normalize(glm::dvec3(1, 0.3, 0.7)),
                     v = glm::normalize(glm::dvec3(0.2, 1, -0.6));
    PolygonShape shape;
    for (const glm::dvec2 at : {glm::dvec2(0, 0), {3, 3}, {3, 0}, {0, 2.9}})
        shape.vertices.push_back(glm::dvec3(90, 40, -70) + at.x * u + at.y * v);
    Scene scene;
    scene.camera.eye = {0, 0, 0};
    addObject(scene, shape);
    const PackedScene packed = packScene(scene);
    const glm::dvec3 expected = glm::normalize(glm::cross(u, v));
    const glm::dvec3 normal(packed.polygons.at(0).normal);
    EXPECT_LT(glm::length(normal - std::copysign(1, glm::dot(normal, expected)) * expected), 0x1p-23);
}

TEST(PackPolygon, Boxes) {
    Scene flat;
    addObject(flat, ring(12, {1, 2, 3}, 2));
    const PackedScene packed = packScene(flat);
    constexpr float kMargin = 4 * 0x1p-20f;
    EXPECT_EQ(packed.boundsLo.z, 3.0f - kMargin);
    EXPECT_EQ(packed.boundsHi.z, 3.0f + kMargin);
    EXPECT_EQ(packed.boundsHi.x, 3.0f + kMargin);

    // (1, 1, 1/2) falls on (1, 1, 0), which is inside already.
    const Box box = polygonBox({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5f}, {0, 1, 0}}, {0, 0, 0}, {0, 0, 1});
    EXPECT_EQ(box.lo, glm::vec3(0));
    EXPECT_EQ(box.hi, glm::vec3(1, 1, 0.5f));
    const float h = std::sqrt(0.5f);
    const Box tilted = polygonBox({{0, 0, 0}, {1, 0, 0}, {1, 0, 1}}, {0, 0, 0}, {0, h, h});
    // (1, 0, 1) falls on the plane y + z = 0 at (1, -1/2, 1/2).
    EXPECT_LE(tilted.lo.y, -0.5f);
    EXPECT_NEAR(tilted.lo.y, -0.5, 1e-6);
}

// A polygon of the greatest size has a leaf of its own, and so have its neighbours; small ones share leaves.
TEST(PackPolygon, LeavesStayWithinTheTrips) {
    Scene scene;
    for (int i = 0; i < 40; ++i) addObject(scene, ring(12, {0, 0, 0.01 * i}, 1));
    const PackedScene small = packScene(scene);
    EXPECT_LT(small.statistics.leaves, 40u);
    EXPECT_EQ(small.polygonTripsPerLeaf, 4 * (3u + 2));
    addObject(scene, ring(8192, {0, 0, 1}, 1));
    const PackedScene great = packScene(scene);
    EXPECT_EQ(great.statistics.leaves, 41u);
    EXPECT_EQ(great.polygonTripsPerLeaf, 2048u + 2);
    EXPECT_EQ(packScene(Scene{}).polygonTripsPerLeaf, 0u);
}

}  // namespace glint::polygon_test
