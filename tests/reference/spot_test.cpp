// Spot lights: docs/reference/shading.md, "Spot light".
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/packed_scene_maker.h"

namespace glint::reference::test::spot_test {
using namespace glint::test;

using glm::dvec3;
using glm::vec3;

constexpr double kDegree = std::numbers::pi / 180;
// The cosines of the cone's edges are stored to 2^-24 of 1 - cos.
constexpr double kRounding = 1e-6;

// The colour of a white floor at `theta` degrees from below a lamp of height 2, seen from the side.
double floorAt(const SceneMaker& maker, double theta) {
    const PackedScene scene = maker.finish();
    const dvec3 point(2 * std::tan(theta * kDegree), 0, 0);
    return Tracer(scene).trace(rayTowards(point + dvec3(0, 1, 3), point)).color.x;
}

SceneMaker lamp(double angle, double penumbra, uint32_t kind = shared::kLightSpot) {
    SceneMaker maker;
    maker.plane(vec3(0), {0, 1, 0});
    maker.spot({0, 2, 0}, {0, -1, 0}, angle, penumbra, kind);
    return maker;
}

// Lambert's cosine is that of theta too.
TEST(ReferenceSpot, SmoothstepOfTheCosine) {
    const SceneMaker maker = lamp(20, 20);
    for (const double theta : {0.0, 10.0, 19.99})
        EXPECT_NEAR(floorAt(maker, theta), std::cos(theta * kDegree), kRounding) << theta;
    const double inner = std::cos(20 * kDegree), outer = std::cos(40 * kDegree);
    for (const double quarter : {0.25, 0.5, 0.75}) {
        // 3 x^2 - 2 x^3 at 1/4, 1/2, 3/4: 5/32, 1/2, 27/32.
        const double factor = quarter == 0.25 ? 5.0 / 32 : quarter == 0.5 ? 0.5 : 27.0 / 32;
        const double cosine = outer + quarter * (inner - outer);
        EXPECT_NEAR(floorAt(maker, std::acos(cosine) / kDegree), cosine * factor, kRounding) << quarter;
    }
    EXPECT_EQ(floorAt(maker, 40.01), 0);
    EXPECT_EQ(floorAt(maker, 80), 0);
}

TEST(ReferenceSpot, WithoutPenumbraAStep) {
    const SceneMaker maker = lamp(30, 0);
    EXPECT_NEAR(floorAt(maker, 29.9999), std::cos(29.9999 * kDegree), kRounding);
    EXPECT_EQ(floorAt(maker, 30.0001), 0);
}

TEST(ReferenceSpot, InverseSquare) {
    const SceneMaker maker = lamp(30, 0, shared::kLightSpotInverseSquare);
    EXPECT_NEAR(floorAt(maker, 0), 1.0 / 4, kRounding);
    // Distance 2 / cos: cos / (4 / cos^2).
    EXPECT_NEAR(floorAt(maker, 25), std::pow(std::cos(25 * kDegree), 3) / 4, kRounding);
}

TEST(ReferenceSpot, FullSphereIsAPointLight) {
    SceneMaker maker;
    maker.plane(vec3(0), {0, 1, 0});
    maker.spot({0, 2, 0}, {0, 1, 0}, 180, 0);  // away from the floor
    for (const double theta : {0.0, 45.0, 80.0})
        EXPECT_NEAR(floorAt(maker, theta), std::cos(theta * kDegree), kRounding);
}

// Outside the cone there is no shadow ray: nothing is tested for it, and nothing is called occluded.
TEST(ReferenceSpot, NoShadowRayOutsideTheCone) {
    SceneMaker maker = lamp(20, 10);
    maker.sphere({0, 1.9f, 0}, .01f);  // blocks the lamp for all of the floor within 6 degrees
    const PackedScene scene = maker.finish();
    const Tracer tracer(scene);
    const auto recordAt = [&](double theta) {
        const dvec3 point(2 * std::tan(theta * kDegree), 0, 0);
        return tracer.trace(rayTowards(point + dvec3(0, .5, 1), point), {}, true);
    };
    EXPECT_EQ(recordAt(1).shadowBits, 1u);
    EXPECT_EQ(recordAt(1).color, dvec3(0));
    const PixelRecord lit = recordAt(25), dark = recordAt(31);
    EXPECT_GT(lit.cost, dark.cost);
    EXPECT_EQ(dark.color, dvec3(0));
    SceneMaker without;
    without.plane(vec3(0), {0, 1, 0});
    without.sphere({0, 1.9f, 0}, .01f);
    const PackedScene unlit = without.finish();
    const dvec3 point(2 * std::tan(31 * kDegree), 0, 0);
    EXPECT_EQ(dark.cost, Tracer(unlit).trace(rayTowards(point + dvec3(0, .5, 1), point)).cost);
    // Blocked and outside the cone at once.
    SceneMaker aside;
    aside.plane(vec3(0), {0, 1, 0});
    aside.spot({0, 2, 0}, {1, 0, 0}, 20, 10);
    aside.sphere({0, 1.9f, 0}, .01f);
    const PackedScene turned = aside.finish();
    EXPECT_EQ(Tracer(turned).trace(rayTowards({0, .5, 1}, {0, 0, 0})).shadowBits, 0u);
}

// Where the cone's sharp edge meets the floor, rounding decides; a little aside it does not.
TEST(ReferenceSpot, JitterFindsTheEdge) {
    const SceneMaker maker = lamp(45, 0);  // radius 2
    const PackedScene scene = maker.finish();
    const Tracer tracer(scene);
    const auto lit = [&](double x) {
        int count = 0;
        for (uint64_t seed = 1; seed <= 64; ++seed) {
            count += tracer.trace(rayTowards({x, 1, 1}, {x, 0, 0}), {seed, 4}).color.x > 0;
        }
        return count;
    };
    EXPECT_EQ(lit(2 - 1e-4), 64);
    EXPECT_EQ(lit(2 + 1e-4), 0);
    const int edge = lit(2);
    EXPECT_GT(edge, 8);
    EXPECT_LT(edge, 56);
}

}  // namespace glint::reference::test::spot_test
