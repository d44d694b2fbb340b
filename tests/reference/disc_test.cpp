// Discs by formulas of their own: hits, the rim, sources.
#include <gtest/gtest.h>

#include "support/packed_scene_maker.h"

namespace glint::reference::test::disc_test {
using namespace glint::test;

using glm::dvec3;
using glm::vec3;

std::optional<Hit> hitDisc(const vec3& center, const vec3& normal, float radius, const Ray& ray) {
    SceneMaker maker;
    maker.disc(center, normal, radius);
    const PackedScene scene = maker.finish();
    const Tracer tracer(scene);
    const auto hit = tracer.closest(ray);
    EXPECT_EQ(hit, tracer.closestBruteForce(ray));
    EXPECT_EQ(hit.has_value(), tracer.occluded(ray));
    return hit;
}

// A 3-4-5 triangle: (0.6, 0.8) is on the rim in exact arithmetic, but not as floats; (3, 4) of radius 5 is
// both.
TEST(ReferenceDisc, TheRimIsAHit) {
    const vec3 up(0, 0, 1);
    for (const dvec3 p : {dvec3(0, 0, 2), dvec3(3, 4, 2), dvec3(-4, 3, 2), dvec3(5, 0, 2)}) {
        const auto hit = hitDisc(vec3(0), up, 5, makeRay(p, {0, 0, -1}));
        ASSERT_TRUE(hit) << p.x;
        EXPECT_EQ(hit->t, 2);
        EXPECT_EQ(hit->u, 0);
    }
    const double outside = std::nextafter(4.0, 5.0);
    EXPECT_FALSE(hitDisc(vec3(0), up, 5, makeRay({3, outside, 2}, {0, 0, -1})));
    EXPECT_TRUE(hitDisc(vec3(0), up, 5, makeRay({3, std::nextafter(4.0, 0.0), 2}, {0, 0, -1})));
    // From afar and aslant: (3, 4, 0) = (3 + 2^20, 4, 2^20) - 2^20 (1, 0, 1).
    EXPECT_TRUE(hitDisc(vec3(0), up, 5, makeRay({3 + 0x1p20, 4, 0x1p20}, {-1, 0, -1})));
    EXPECT_FALSE(hitDisc(vec3(0), up, 5, makeRay({3 + 0x1p20, outside, 0x1p20}, {-1, 0, -1})));
}

TEST(ReferenceDisc, BothSidesAndNoneFromTheEdge) {
    const vec3 center(1, 2, 3), normal(0, 1, 0);
    EXPECT_EQ(hitDisc(center, normal, 1, makeRay({1.5, 7, 3}, {0, -2, 0}))->t, 2.5);
    EXPECT_EQ(hitDisc(center, normal, 1, makeRay({1.5, 0, 3}, {0, 1, 0}))->t, 2);
    EXPECT_FALSE(hitDisc(center, normal, 1, makeRay({-5, 2, 3}, {1, 0, 0}))) << "in its plane";
    EXPECT_FALSE(hitDisc(center, normal, 1, makeRay({1, 2, 3}, {0, 1, 0}))) << "t = 0";
    EXPECT_FALSE(hitDisc(center, normal, 1, makeRay({1, 3, 3}, {0, 1, 0}))) << "behind";
}

TEST(ReferenceDisc, SurfaceAndSource) {
    SceneMaker maker;
    const uint32_t material = maker.material(vec3(0.5));
    maker.disc({0, 0, 0}, {0, 0, 1}, 2, material);
    maker.disc({0, 0, -1}, {0, 0, 1}, 2);
    const PackedScene scene = maker.finish();
    const Tracer tracer(scene);
    const Ray ray = makeRay({1, 0.5, 3}, {0, 0, -1});
    const auto hit = tracer.closest(ray);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->id, 0u);
    const Surface surface = tracer.surfaceAt(ray, *hit);
    EXPECT_EQ(surface.position, dvec3(1, 0.5, 0));
    EXPECT_EQ(surface.geometricNormal, dvec3(0, 0, 1));
    EXPECT_EQ(surface.shadingNormal, dvec3(0, 0, 1));
    EXPECT_EQ(surface.material, material);
    // The ray that starts on a disc never hits it again, however far its start is off.
    const auto next = tracer.closest(ray, hit->primitive);
    ASSERT_TRUE(next);
    EXPECT_EQ(next->id, 1u);
}

}  // namespace glint::reference::test::disc_test
