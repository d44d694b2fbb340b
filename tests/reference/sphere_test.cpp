// Spheres, ordinary and anchored: answers from books, closed forms, and quadruple precision.
#include <gtest/gtest.h>

#include "support/packed_scene_maker.h"

namespace glint::reference::test::sphere_test {
using namespace glint::test;

using glm::dvec3;
using glm::vec3;

std::optional<Hit> hitScene(const SceneMaker& maker, const Ray& ray) {
    const PackedScene scene = maker.finish();
    return Tracer(scene).closest(ray);
}

std::optional<Hit> hitSphere(const vec3& center, float radius, const Ray& ray) {
    SceneMaker maker;
    maker.sphere(center, radius);
    return hitScene(maker, ray);
}

// Both roots in front of the origin, the second by starting beyond the first.
std::vector<double> rootsOf(const vec3& center, float radius, Ray ray) {
    std::vector<double> roots;
    while (const auto hit = hitSphere(center, radius, ray)) {
        roots.push_back(hit->t);
        ray.tMin = hit->t;
    }
    return roots;
}

// J. Buck, The Ray Tracer Challenge, features/spheres.feature; roots behind the origin do not count here.
TEST(ReferenceSphere, RayTracerChallenge) {
    const dvec3 z(0, 0, 1);
    EXPECT_EQ(rootsOf(vec3(0), 1, makeRay({0, 0, -5}, z)), (std::vector<double>{4, 6}));
    EXPECT_EQ(rootsOf(vec3(0), 1, makeRay({0, 1, -5}, z)), (std::vector<double>{5}));
    EXPECT_TRUE(rootsOf(vec3(0), 1, makeRay({0, 2, -5}, z)).empty());
    EXPECT_EQ(rootsOf(vec3(0), 1, makeRay({0, 0, 0}, z)), (std::vector<double>{1}));
    EXPECT_TRUE(rootsOf(vec3(0), 1, makeRay({0, 0, 5}, z)).empty());
    EXPECT_EQ(rootsOf(vec3(0), 2, makeRay({0, 0, -5}, z)), (std::vector<double>{3, 7}));
    EXPECT_TRUE(rootsOf(vec3(5, 0, 0), 1, makeRay({0, 0, -5}, z)).empty());
}

// t = 10 - sqrt(1 - b^2); tangent at b = 1; a float beyond misses.
TEST(ReferenceSphere, GrazingAndTangent) {
    const float inside = 0.99999994f;
    const auto hit = hitSphere(vec3(0), 1, makeRay({inside, 0, -10}, {0, 0, 1}));
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->t, 9.999654733, 5e-10);
    const auto tangent = hitSphere(vec3(0), 1, makeRay({1, 0, -10}, {0, 0, 1}));
    ASSERT_TRUE(tangent);
    EXPECT_EQ(tangent->t, 10);
    EXPECT_FALSE(hitSphere(vec3(0), 1, makeRay({1.0000001f, 0, -10}, {0, 0, 1})));
}

// The same lines with directions 7 times as long: the touching t = k / 7 is no binary fraction, so that no
// partial result is exact. Only b^2 - a c of the integers, below 2^113, is.
TEST(ReferenceSphere, TangentsWithoutExactRoots) {
    for (int k = 1; k < 1 << 21; k += 1021) {
        const Ray ray = makeRay({-4.0 - 3.0 * k, 3.0 - 4.0 * k, 0}, {21, 28, 0});
        const auto hit = hitSphere(vec3(0), 5, ray);
        ASSERT_TRUE(hit) << k;
        EXPECT_DOUBLE_EQ(hit->t, k / 7.0);
        EXPECT_FALSE(hitSphere(vec3(0), std::nextafter(5.0f, 0.0f), ray)) << k;
    }
}

// A planet of radius 1e6 seen from height h, straight down: t = h, where c/q in fp32 gives 1.0158 for h = 1.
TEST(ReferenceSphere, GiantSphereFromClose) {
    for (const double h : {100.0, 1.0, 0.25, 0.0625, 1e-6}) {
        const Ray ray = makeRay({0, h, 0}, {0, -1, 0});
        const auto ordinary = hitSphere({0, -1e6f, 0}, 1e6f, ray);
        ASSERT_TRUE(ordinary);
        EXPECT_NEAR(ordinary->t, h, 1e6 * 0x1p-60);
        SceneMaker maker;
        maker.anchoredSphere(vec3(0), {0, 1, 0}, 1e6f);
        const auto anchored = hitScene(maker, ray);
        ASSERT_TRUE(anchored);
        EXPECT_DOUBLE_EQ(anchored->t, h);
    }
}

// A ray that starts on the sphere meets it again at -2 b / a, however its start was rounded, or never.
TEST(ReferenceSphere, SourceHitsOnlyItsOtherSide) {
    SceneMaker maker;
    maker.sphere(vec3(0), 1);
    maker.anchoredSphere({100, 0, 0}, {0, 1, 0}, 1000);
    const PackedScene scene = maker.finish();
    const Tracer tracer(scene);
    for (uint32_t i = 0; i < 2; ++i) {
        const uint32_t source = shared::kKindSphere << shared::kPrimitiveKindShift | i;
        const bool anchored = scene.spheres[i].anchorNormal != vec3(0);
        const dvec3 at = anchored ? dvec3(100, 0, 0) : dvec3(0, 1, 0);
        const double diameter = anchored ? 2000 : 2;
        for (const double error : {-1e-12, 0.0, 1e-12}) {
            const dvec3 start = at + dvec3(0, error, 0);
            const auto inward = tracer.closest(makeRay(start, {0, -1, 0}), source);
            ASSERT_TRUE(inward);
            EXPECT_NEAR(inward->t, diameter, 1e-11);
            // At 45 degrees the chord is 2 r cos 45.
            const auto slanted = tracer.closest(makeRay(start, glm::normalize(dvec3(1, -1, 0))), source);
            ASSERT_TRUE(slanted);
            EXPECT_NEAR(slanted->t, diameter * std::sqrt(.5), 1e-9);
            EXPECT_FALSE(tracer.closest(makeRay(start, {0, 1, 0}), source));
            EXPECT_FALSE(tracer.closest(makeRay(start, {1, 1e-9, 0}), source));
        }
    }
}

TEST(ReferenceSphere, SurfaceLiesOnTheSphere) {
    Random random(61);
    SceneMaker maker;
    maker.sphere({3, 4, 5}, 2.5f);
    maker.anchoredSphere({0, -50, 0}, {0, 1, 0}, 1e6f);
    const PackedScene scene = maker.finish();
    const Tracer tracer(scene);
    int seen[2] = {0, 0};
    for (int i = 0; i < 2000; ++i) {
        const Ray ray =
            rayTowards(1e3 * (random.box(100) + dvec3(0, 130, 0)), dvec3(3, 4, 5) + random.box(5));
        const auto hit = tracer.closest(ray);
        ASSERT_TRUE(hit);
        const Surface surface = tracer.surfaceAt(ray, *hit);
        ++seen[surface.object];
        EXPECT_NEAR(glm::length(surface.geometricNormal), 1, 1e-15);
        EXPECT_EQ(surface.geometricNormal, surface.shadingNormal);
        const dvec3 y = surface.position - dvec3(0, -50, 0);
        const double error = surface.object == 0
                                 ? glm::length(surface.position - dvec3(3, 4, 5)) - 2.5
                                 : (glm::dot(y, y) + 2e6 * y.y) / (2 * glm::length(y + dvec3(0, 1e6, 0)));
        EXPECT_LE(std::abs(error), 16 * 0x1p-53 * (200 + glm::length(surface.position)));
        EXPECT_GT(glm::dot(surface.geometricNormal,
                           surface.position - (surface.object ? dvec3(0, -1e6, 0) : dvec3(3, 4, 5))),
                  0)
            << "outward";
    }
    EXPECT_GT(seen[0], 100);
    EXPECT_GT(seen[1], 100);
}

}  // namespace glint::reference::test::sphere_test
