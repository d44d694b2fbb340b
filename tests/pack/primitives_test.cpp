// Packing of single primitives.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "pack/packed_scene.h"
#include "pack/primitives.h"
#include "scene/transform.h"
#include "support/scene_maker.h"

namespace glint::primitives_test {

// Rounding of spheres, ordinary and anchored, and boxes that hold them whole.

constexpr long double operator""_l(long double x) {
    return x;
}

// The sphere that the packed form describes, in long double.
struct TrueSphere {
    long double center[3];
    long double radius;
};

TrueSphere truth(const shared::Sphere& s) {
    TrueSphere t{{s.point.x, s.point.y, s.point.z}, s.radius};
    const glm::vec3& n = s.anchorNormal;
    const long double length = std::sqrt(1.0_l * n.x * n.x + 1.0_l * n.y * n.y + 1.0_l * n.z * n.z);
    if (length == 0) return t;
    for (int i = 0; i < 3; ++i) t.center[i] -= 1.0_l * s.radius * n[i];
    t.radius = 1.0_l * s.radius * length;
    return t;
}

void expectTightlyInside(const shared::Sphere& sphere) {
    const Box box = sphereBox(sphere);
    const TrueSphere t = truth(sphere);
    for (int axis = 0; axis < 3; ++axis) {
        const long double lo = t.center[axis] - t.radius, hi = t.center[axis] + t.radius;
        EXPECT_LT(box.lo[axis], lo);
        EXPECT_GT(box.hi[axis], hi);
        // Tight: two units of fp32, and the margin for double.
        const long double slack = 0x1p-22_l * std::abs(lo) + 0x1p-46_l * t.radius + 1e-40_l;
        EXPECT_GT(box.lo[axis], lo - slack);
        EXPECT_LT(box.hi[axis], hi + (slack + 0x1p-22_l * std::abs(hi)));
    }
}

Frame frameWithEye(const glm::dvec3& eye) {
    return {glm::dvec3(0), eye};
}

TEST(PackSphere, OrdinaryIsItself) {
    const shared::Sphere s = roundSphere({{1, 2, 3}, 0.5}, frameWithEye({9, 9, 9}));
    EXPECT_EQ(s.point, glm::vec3(1, 2, 3));
    EXPECT_EQ(s.radius, 0.5f);
    EXPECT_EQ(s.anchorNormal, glm::vec3(0));
    expectTightlyInside(s);
}

// r = 64: anchored while the eye is nearer to the surface than 1, on either side.
TEST(PackSphere, AnchoredNearTheSurface) {
    const SphereShape ball{{0, 0, 0}, 64};
    for (const double y : {63.01, 64.0, 64.99}) {
        const shared::Sphere s = roundSphere(ball, frameWithEye({0, y, 0}));
        EXPECT_EQ(s.point, glm::vec3(0, 64, 0));
        EXPECT_EQ(s.anchorNormal, glm::vec3(0, 1, 0));
    }
    for (const double y : {0.0, 62.9, 63.0, 65.0, 65.1, 1e6})
        EXPECT_EQ(roundSphere(ball, frameWithEye({0, y, 0})).anchorNormal, glm::vec3(0)) << y;
}

// T60's planet: centre (0, -1e6, 0), eye above the top. The surface at the top is y = 0 to the last bit.
TEST(PackSphere, PlanetIsAnchoredAtItsTop) {
    const shared::Sphere s = roundSphere({{0, -1e6, 0}, 1e6}, frameWithEye({0, 0.25, 0}));
    EXPECT_EQ(s.point, glm::vec3(0, 0, 0));
    EXPECT_EQ(s.anchorNormal, glm::vec3(0, 1, 0));
    EXPECT_EQ(s.radius, 1e6f);
    expectTightlyInside(s);
    EXPECT_LT(sphereBox(s).hi.y, 1e-8f);
    const shared::Sphere ceiling = roundSphere({{0, 1e6, 0}, 1e6}, frameWithEye({0, -0.25, 0}));
    EXPECT_EQ(ceiling.anchorNormal, glm::vec3(0, -1, 0));
    expectTightlyInside(ceiling);
}

TEST(PackSphere, OriginIsSubtractedInDouble) {
    Frame frame{{1e9, 0, 0}, {1e9 + 3, 0, 0}};
    const shared::Sphere s = roundSphere({{1e9 + 0.125, 0, 0}, 1}, frame);
    EXPECT_EQ(s.point, glm::vec3(0.125f, 0, 0));
    frame.eye = {1e9, 5, 0};
    const shared::Sphere planet = roundSphere({{1e9, -6e6, 0}, 6e6}, frame);
    EXPECT_EQ(planet.point, glm::vec3(0, 0, 0));
    EXPECT_EQ(planet.anchorNormal, glm::vec3(0, 1, 0));
}

TEST(PackSphere, BoxesHoldSpheresOfAllSizes) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1, 1), exponent(-13, 17);
    for (int i = 0; i < 5000; ++i) {
        const glm::dvec3 center =
            std::pow(10.0, exponent(random)) * glm::dvec3(unit(random), unit(random), unit(random));
        const double radius = std::pow(10.0, exponent(random));
        glm::dvec3 out(unit(random), unit(random), unit(random));
        out /= glm::length(out);
        expectTightlyInside(roundSphere({center, radius}, frameWithEye(center + 100 * radius * out)));
        const shared::Sphere anchored =
            roundSphere({center, radius}, frameWithEye(center + (1 + 0.01 * unit(random)) * radius * out));
        if (radius > 1e-6 * glm::length(center)) {
            EXPECT_NE(anchored.anchorNormal, glm::vec3(0));
        }
        expectTightlyInside(anchored);
    }
}

// Discs: numbers, rounding, boxes, and where the local frame begins.

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
    aim(scene.camera, {1e7, 0, 5}, {1e7, 0, 0});
    addObject(scene, DiscShape{{1e7, 0, 0}, {0, 0, 1}, 3});
    const PackedScene packed = packScene(scene);
    EXPECT_NEAR(packed.origin.x, 1e7, 8);
    EXPECT_EQ(packed.discs[0].center.x + packed.origin.x, 1e7);
}

// Polygons: numbers, the array of vertices, boxes, leaves that the device can finish.

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

// The areas of an outline that crosses itself cancel to a twentieth here, so rounded vertices would turn the
// plane by 20 times their error.
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

// Flat along an axis except for the edge test's margin, 2^-20 of the size; otherwise as thick as the distance
// of the rounded vertices from their plane.
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

// Boxes: rounding, frames, boxes of the tree, fate, media.

using glm::dmat3;
using glm::dvec3;

dmat3 rowsOf(const shared::Cuboid& c) {
    return glm::transpose(dmat3(dvec3(c.toLocal0), dvec3(c.toLocal1), dvec3(c.toLocal2)));
}

TEST(PackCuboid, WithoutATransformTheCornersAreExact) {
    Scene scene;
    scene.materials.resize(2);
    addObject(scene, SphereShape{{9, 0, 0}, 1});
    addObject(scene, BoxShape{{-1, 0.5, 2}, {3, 0.75, 2.125}}, 1);
    const PackedScene packed = packScene(scene);
    ASSERT_EQ(packed.cuboids.size(), 1u);
    const shared::Cuboid& c = packed.cuboids[0];
    EXPECT_EQ(c.lo, glm::vec3(-1, 0.5, 2));
    EXPECT_EQ(c.hi, glm::vec3(3, 0.75, 2.125));
    EXPECT_EQ(c.point, glm::vec3(0));
    EXPECT_EQ(rowsOf(c), dmat3(1));
    EXPECT_EQ(c.id, 1u);
    EXPECT_EQ(c.object, 1u);
    EXPECT_EQ(c.material, 1u);
    EXPECT_TRUE(packed.features.cuboids);
    EXPECT_FALSE(packed.features.instances);
}

TEST(PackCuboid, AxesThatKeepTheirSenseStayAxes) {
    Scene scene;
    addObject(scene, BoxShape{{-1, -1, -1}, {1, 1, 1}});
    addObject(scene, BoxShape{{-1, -1, -1}, {1, 1, 1}});
    scene.objects[0].transform = then(scaling({2, 3, 4}), translation({1, 2, 3}));
    scene.objects[1].transform = scaling({-1, 1, 1});  // turns the images on its faces
    const PackedScene packed = packScene(scene);
    const size_t baked = packed.cuboids[0].object == 0 ? 0 : 1;
    EXPECT_EQ(packed.cuboids[baked].lo, glm::vec3(-1, -1, -1));
    EXPECT_EQ(packed.cuboids[baked].hi, glm::vec3(3, 5, 7));
    EXPECT_EQ(packed.cuboids[1 - baked].toLocal0, glm::vec3(-1, 0, 0));
}

// Rows of length 1 that are 0 along the faces; corners at lo and hi; all within the box of the tree.
TEST(PackCuboid, UnderAnyTransform) {
    std::mt19937 engine(4);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int i = 0; i < 200; ++i) {
        dmat3 linear;
        for (int column = 0; column < 3; ++column)
            linear[column] = dvec3(uniform(engine), uniform(engine), uniform(engine));
        if (std::abs(glm::determinant(linear)) < 0.05) continue;
        const dvec3 low(uniform(engine), uniform(engine), uniform(engine));
        const BoxShape box{low, low + dvec3(0.1 + i % 3, 0.2, 1.5)};
        Scene scene;
        addObject(scene, box);
        scene.objects[0].transform = Affine{linear, {uniform(engine), 5, uniform(engine)}};
        const PackedScene packed = packScene(scene);
        ASSERT_EQ(packed.cuboids.size(), 1u);
        const shared::Cuboid& c = packed.cuboids[0];
        for (const glm::vec3& row : {c.toLocal0, c.toLocal1, c.toLocal2})
            EXPECT_NEAR(glm::length(dvec3(row)), 1, 1e-6);
        for (int corner = 0; corner < 8; ++corner) {
            const dvec3 own(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                            corner & 4 ? box.max.z : box.min.z);
            const dvec3 world = linear * own + scene.objects[0].transform->offset;
            const dvec3 y = rowsOf(c) * (world - dvec3(c.point));
            for (int axis = 0; axis < 3; ++axis) {
                const bool upper = (corner >> axis & 1) != 0;
                EXPECT_NEAR(y[axis], static_cast<double>(upper ? c.hi[axis] : c.lo[axis]), 4e-6);
                EXPECT_GE(world[axis], static_cast<double>(packed.boundsLo[axis]) - 1e-6);
                EXPECT_LE(world[axis], static_cast<double>(packed.boundsHi[axis]) + 1e-6);
            }
        }
    }
}

TEST(PackCuboid, TheEyeInsideIsInItsMedium) {
    for (const bool turned : {false, true}) {
        Scene scene;
        addObject(scene, BoxShape{{-1, -1, -1}, {1, 1, 1}});
        scene.materials[0].transmission = Color(1);
        if (turned) scene.objects[0].transform = rotation({1, 2, 3}, 40);
        scene.camera.eye = {0.9, 0, 0};
        EXPECT_EQ(packScene(scene).environment.eyeMedium0, 1u);
        scene.camera.eye = {1.9, 0, 0};
        EXPECT_EQ(packScene(scene).environment.eyeMedium0, 0u);
    }
}

}  // namespace glint::primitives_test
