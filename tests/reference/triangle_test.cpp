// Triangles, and a closed mesh of them.
#include <gtest/gtest.h>

#include "support/packed_scene_maker.h"

namespace glint::reference::test::triangle_test {

// Single triangles: answers from books, from other projects' tests, and from quadruple precision.

using namespace glint::test;

using glm::dvec3;
using glm::vec3;

std::optional<Hit> hitTriangle(const vec3& a, const vec3& b, const vec3& c, const Ray& ray) {
    SceneMaker maker;
    maker.triangle(a, b, c);
    return SceneTracer(maker).closest(ray);
}

// Embree's TriangleHit test and others use this one.
std::optional<Hit> hitUnitTriangle(const Ray& ray) {
    return hitTriangle(vec3(0), vec3(1, 0, 0), vec3(0, 1, 0), ray);
}

TEST(ReferenceTriangle, EdgesAndVerticesCount) {
    for (const dvec3 p : {dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(0, 1, 0), dvec3(.5, 0, 0), dvec3(0, .5, 0),
                          dvec3(.5, .5, 0)}) {
        EXPECT_TRUE(hitUnitTriangle(rayTowards({.3, .4, -2}, p)));
        EXPECT_TRUE(hitUnitTriangle(makeRay(p - dvec3(0, 0, 1), {0, 0, 1})));
    }
    EXPECT_FALSE(hitUnitTriangle(makeRay({0x1p-60, -0x1p-60, -1}, {0, 0, 1})));
    EXPECT_FALSE(hitUnitTriangle(makeRay({.5 + 0x1p-50, .5, -1}, {0, 0, 1})));
}

TEST(ReferenceTriangle, IntervalExcludesItsStartAndIncludesItsEnd) {
    Ray ray = makeRay({.25, .25, -1}, {0, 0, 1});
    ray.tMax = 1;
    EXPECT_TRUE(hitUnitTriangle(ray));
    ray.tMax = std::nextafter(1, 0);
    EXPECT_FALSE(hitUnitTriangle(ray));
    ray.tMax = 2;
    ray.tMin = 1;
    EXPECT_FALSE(hitUnitTriangle(ray));
    ray.tMin = std::nextafter(1, 0);
    EXPECT_TRUE(hitUnitTriangle(ray));
    EXPECT_FALSE(hitUnitTriangle(makeRay({.25, .25, 0}, {0, 0, 1}))) << "t = 0 is excluded";
    EXPECT_FALSE(hitUnitTriangle(makeRay({.25, .25, 1}, {0, 0, 1}))) << "behind the origin";
    ray = makeRay({.25, .25, 1}, {0, 0, 1});
    ray.tMin = -5;
    EXPECT_FALSE(hitUnitTriangle(ray)) << "a negative tMin does not reach behind the origin";
}

// Embree issue 298: a ray in the plane misses, along an edge too.
TEST(ReferenceTriangle, RayInPlaneMisses) {
    EXPECT_FALSE(hitUnitTriangle(makeRay({-1, .5, 0}, {1, 0, 0})));
    EXPECT_FALSE(hitUnitTriangle(makeRay({-1, 0, 0}, {1, 0, 0})));
    EXPECT_FALSE(hitUnitTriangle(makeRay({-1, 2, 0}, {1, -1, 0})));
    // Tilted: x + y + z = 1, a direction with d.n = 0, towards the centroid.
    EXPECT_FALSE(hitTriangle({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, makeRay({2, -1, 0}, {-2.5, 2, .5})));
}

// Barely tilted it hits: at x = 0.25 if z falls by 1e-7 per unit and starts at 1.25e-7 above.
TEST(ReferenceTriangle, RayNearlyInPlaneHits) {
    const auto hit = hitUnitTriangle(makeRay({-1, .25, 1.25e-7}, {1, 0, -1e-7}));
    ASSERT_TRUE(hit);
    EXPECT_DOUBLE_EQ(hit->t, 1.25);
}

// pbrt-v4, shapes_test.cpp, Triangle.BadCases; and collinear and coincident vertices.
TEST(ReferenceTriangle, ZeroAreaIsNeverHit) {
    const float x = -1113.45459f, z = -56.2431908f;
    EXPECT_FALSE(
        hitTriangle({x, -79.049614f, z}, {x, -87.0922699f, z}, {x, -79.2090149f, z},
                    makeRay({-1081.47925, 99.9999542, 87.7701111}, {-32.1072998, -183.355865, -144.607635})));
    EXPECT_FALSE(hitTriangle({0, 0, 0}, {1, 0, 0}, {2, 0, 0}, makeRay({.5, 0, -1}, {0, 0, 1})));
    EXPECT_FALSE(hitTriangle(vec3(0), vec3(0), vec3(0), makeRay({0, 0, -1}, {0, 0, 1})));
    EXPECT_FALSE(hitTriangle(vec3(1), vec3(1), vec3(2), makeRay({0, 0, 1}, {1, 1, 0})));
}

// All the scales that fp32 holds.
TEST(ReferenceTriangle, ExtremeScales) {
    for (const float s : {1e-38f, 1e-30f, 1e-15f, 1e18f, 1e30f, 1e38f}) {
        const auto hit =
            hitTriangle({-s, -s, 0}, {s, -s, 0}, {0, s, 0}, makeRay(dvec3(0, 0, -3.0 * s), {0, 0, 1}));
        ASSERT_TRUE(hit) << s;
        EXPECT_DOUBLE_EQ(hit->t, 3.0 * s);
        EXPECT_FALSE(
            hitTriangle({-s, -s, 0}, {s, -s, 0}, {0, s, 0}, makeRay(dvec3(s, s, -3.0 * s), {0, 0, 1})));
    }
}

TEST(ReferenceTriangle, SourceNeverHitsItself) {
    SceneMaker maker;
    maker.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const SceneTracer tracer(maker);
    const Ray ray = makeRay({.25, .25, -1e-9}, {0, 0, 1});
    EXPECT_TRUE(tracer.closest(ray));
    EXPECT_FALSE(tracer.closest(ray, 0));
    EXPECT_FALSE(tracer.closestBruteForce(ray, 0));
    EXPECT_TRUE(tracer.occluded(ray));
    EXPECT_FALSE(tracer.occluded(ray, 0));
}

// Straight through a corner of a cube, t = 9; and through points of its edges from many sides.
TEST(ReferenceWatertight, CubeCornersAndEdges) {
    SceneMaker maker;
    maker.cube(vec3(0), 1);
    const SceneTracer tracer(maker);
    for (int corner = 0; corner < 8; ++corner) {
        const dvec3 c(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        const auto hit = tracer.closest(makeRay(10.0 * c, -c));
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->t, 9);
    }
    Random random(19);
    for (int i = 0; i < 20000; ++i) {
        dvec3 at(random.uniform(-1, 1), random.below(2) ? 1 : -1, random.below(2) ? 1 : -1);
        at = i % 3 == 0 ? at : i % 3 == 1 ? dvec3(at.y, at.z, at.x) : dvec3(at.z, at.x, at.y);
        EXPECT_TRUE(tracer.closest(rayTowards(random.box(.9), at))) << "from inside, ray " << i;
    }
}

}  // namespace glint::reference::test::triangle_test
