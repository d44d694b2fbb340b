// Rounding of spheres, ordinary and anchored, and boxes that hold them whole.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pack/primitives.h"

namespace glint::sphere_test {
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

}  // namespace glint::sphere_test
