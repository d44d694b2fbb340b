// Single triangles: answers from books, from other projects' tests, and from quadruple precision.
#include <gtest/gtest.h>

#include "quad_truth.h"
#include "support/packed_scene_maker.h"

namespace glint::reference::test::triangle_test {
namespace {

using namespace glint::test;

using glm::dvec3;
using glm::vec3;

std::optional<Hit> hitTriangle(const vec3& a, const vec3& b, const vec3& c, const Ray& ray) {
    SceneMaker maker;
    maker.triangle(a, b, c);
    const PackedScene scene = maker.finish();
    return Tracer(scene).closest(ray);
}

// Embree's TriangleHit test and others use this one.
std::optional<Hit> hitUnitTriangle(const Ray& ray) {
    return hitTriangle(vec3(0), vec3(1, 0, 0), vec3(0, 1, 0), ray);
}

// P. Shirley and S. Marschner, Fundamentals of Computer Graphics, ch. 4, exercise 2: x = 1 - t on x + y + z
// = 1.
TEST(ReferenceTriangle, ShirleyExercise) {
    const auto hit = hitTriangle({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, makeRay(dvec3(1), dvec3(-1)));
    ASSERT_TRUE(hit);
    EXPECT_DOUBLE_EQ(hit->t, 2.0 / 3);
    EXPECT_DOUBLE_EQ(hit->u, 1.0 / 3);
    EXPECT_DOUBLE_EQ(hit->v, 1.0 / 3);
}

// Embree, tutorials/verify, TriangleHitTest: from (u, v, -1) along z, t = 1 and the barycentrics are the
// coordinates.
TEST(ReferenceTriangle, EmbreeTriangleHit) {
    Random random(1);
    for (int i = 0; i < 256; ++i) {
        const double u = random.uniform(0, 1), v = random.uniform(0, 1 - u);
        const auto hit = hitUnitTriangle(makeRay({u, v, -1}, {0, 0, 1}));
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->t, 1);
        EXPECT_DOUBLE_EQ(hit->u, u);
        EXPECT_DOUBLE_EQ(hit->v, v);
    }
}

// Vulkan CTS, ray tracing direction tests: the length of the direction scales t.
TEST(ReferenceTriangle, DirectionLengthScalesT) {
    for (const double s : {1.0, 0.5, 3.7, 10.0, 1e-15, 1e15}) {
        const auto hit =
            hitTriangle({0, .5f, 5}, {-.5f, -.5f, 5}, {.5f, -.5f, 5}, makeRay({0, 0, 1}, {0, 0, s}));
        ASSERT_TRUE(hit) << s;
        EXPECT_DOUBLE_EQ(hit->t, 4 / s);
    }
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

// Needles (0,0,0), (1,0,0), (.5,h,0). Every hit and miss is right, and t and the barycentrics are as good as
// long double: the Cramer terms of v are |s| |d| |e1| = 2^-64 x 8 x 8 before the division by h.
TEST(ReferenceTriangle, NeedlesAgreeWithTheTruth) {
    Random random(30);
    for (const float h : {1e-4f, 1e-6f, 1e-8f}) {
        SceneMaker maker;
        const vec3 v0(0), v1(1, 0, 0), v2(.5f, h, 0);
        maker.triangle(v0, v1, v2);
        const PackedScene scene = maker.finish();
        const Tracer tracer(scene);
        int hits = 0;
        for (int i = 0; i < 20000; ++i) {
            const vec3 from(random.uniform(0, 1), random.uniform(-1, 1), 5);
            const vec3 at(random.uniform(0, 1), random.uniform(-.5, 1.5) * h, 0);
            const Ray ray = makeRay(from, at - from);
            const auto truth = triangleTruth(v0, v1, v2, ray);
            const auto hit = tracer.closest(ray);
            ASSERT_EQ(hit.has_value(), truth.has_value()) << "h " << h << " ray " << i;
            if (!hit) continue;
            ++hits;
            EXPECT_LE(distance(truth->t, hit->t), 0x1p-52);
            EXPECT_LE(distance(truth->u, hit->u), 0x1p-52 + 0x1p-58 / h);
            EXPECT_LE(distance(truth->v, hit->v), 0x1p-52 + 0x1p-58 / h);
        }
        EXPECT_GT(hits, 100);
    }
}

// At offset 1e7 the inputs are coarse (an ulp is 1), the algorithm is not: judged against the rounded inputs.
TEST(ReferenceTriangle, FarFromTheOriginAgreesWithTheTruth) {
    Random random(35);
    const vec3 offset(1e7f, -1e7f, 1e7f);
    int hits = 0;
    for (int i = 0; i < 3000; ++i) {
        const vec3 v[3] = {offset + vec3(random.box(8)), offset + vec3(random.box(8)),
                           offset + vec3(random.box(8))};
        const vec3 from = offset + vec3(random.box(10));
        const double u = random.uniform(-.2, 1), w = random.uniform(-.2, 1);
        const dvec3 at = (1 - u - w) * dvec3(v[0]) + u * dvec3(v[1]) + w * dvec3(v[2]);
        const Ray ray = makeRay(from, vec3(at - dvec3(from)));
        const auto truth = triangleTruth(v[0], v[1], v[2], ray);
        const auto hit = hitTriangle(v[0], v[1], v[2], ray);
        ASSERT_EQ(hit.has_value(), truth.has_value()) << i;
        if (!hit) continue;
        ++hits;
        EXPECT_LE(distance(truth->t, hit->t), 0x1p-50 * std::max(1.0, hit->t));
        EXPECT_LE(distance(truth->u, hit->u), 0x1p-45);
        EXPECT_LE(distance(truth->v, hit->v), 0x1p-45);
    }
    EXPECT_GT(hits, 500);
}

// Scaling by a power of two changes no rounding: the same hits, bit-equal barycentrics, t scaled exactly.
TEST(ReferenceTriangle, PowersOfTwoScaleExactly) {
    Random random(21);
    for (int i = 0; i < 200; ++i) {
        const vec3 v[3] = {vec3(random.box(1)), vec3(random.box(1)), vec3(random.box(1))};
        const dvec3 from = random.box(3),
                    d = (dvec3(v[0]) + dvec3(v[1]) + dvec3(v[2])) / 3.0 + random.box(.5) - from;
        const auto base = hitTriangle(v[0], v[1], v[2], makeRay(from, d));
        for (int k = -40; k <= 40; k += 8) {
            const float s = std::ldexp(1.0f, k);
            const auto hit =
                hitTriangle(s * v[0], s * v[1], s * v[2], makeRay(static_cast<double>(s) * from, d));
            ASSERT_EQ(hit.has_value(), base.has_value());
            if (!hit) continue;
            EXPECT_EQ(hit->t, std::ldexp(base->t, k));
            EXPECT_EQ(hit->u, base->u);
            EXPECT_EQ(hit->v, base->v);
        }
    }
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

// Mirroring x, cycling the vertices or turning the winding decides nothing.
TEST(ReferenceTriangle, SymmetriesKeepTheHit) {
    Random random(22);
    for (int i = 0; i < 1000; ++i) {
        const vec3 a(random.box(1)), b(random.box(1)), c(random.box(1));
        const dvec3 from = random.box(3);
        const dvec3 at = i % 3 == 0   ? dvec3(a)
                         : i % 3 == 1 ? .5 * dvec3(a) + .5 * dvec3(b)
                                      : dvec3(a) + random.box(1);
        const dvec3 flip(-1, 1, 1);
        const Ray ray = rayTowards(from, at), mirrored = makeRay(flip * ray.origin, flip * ray.direction);
        const auto hit = hitTriangle(a, b, c, ray);
        const vec3 flipped(-1, 1, 1);
        const auto mirrorHit = hitTriangle(flipped * a, flipped * b, flipped * c, mirrored);
        ASSERT_EQ(hit.has_value(), mirrorHit.has_value());
        if (hit) {
            EXPECT_EQ(hit->t, mirrorHit->t);
        }
        EXPECT_EQ(hit.has_value(), hitTriangle(b, c, a, ray).has_value());
        EXPECT_EQ(hit.has_value(), hitTriangle(c, a, b, ray).has_value());
        EXPECT_EQ(hit.has_value(), hitTriangle(a, c, b, ray).has_value());
    }
}

TEST(ReferenceTriangle, SourceNeverHitsItself) {
    SceneMaker maker;
    maker.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const PackedScene scene = maker.finish();
    const Tracer tracer(scene);
    const Ray ray = makeRay({.25, .25, -1e-9}, {0, 0, 1});
    EXPECT_TRUE(tracer.closest(ray));
    EXPECT_FALSE(tracer.closest(ray, 0));
    EXPECT_FALSE(tracer.closestBruteForce(ray, 0));
    EXPECT_TRUE(tracer.occluded(ray));
    EXPECT_FALSE(tracer.occluded(ray, 0));
}

}  // namespace
}  // namespace glint::reference::test::triangle_test
