// Quadrics in the reference: published hits, hard quadratics, parts and sources.
#include <gtest/gtest.h>

#include <cmath>

#include "support/packed_scene_maker.h"

namespace glint::reference::test::quadric_test {
using namespace glint::test;

using glm::dvec3;

PackedScene packed(const Shape& shape, std::optional<Affine> transform = {}) {
    Scene scene;
    scene.materials.resize(1);
    scene.camera.eye = {0, 0, 1e3};
    scene.objects.push_back({"/objects/0", shape, 0, transform});
    return packScene(scene);
}

QuadricShape general(std::array<double, 10> coefficients, double half) {
    QuadricShape shape;
    std::copy(coefficients.begin(), coefficients.end(), shape.coefficients);
    shape.lo = dvec3(-half);
    shape.hi = dvec3(half);
    return shape;
}

// All hits of a ray in order, by starting again behind each.
std::vector<double> hitsOf(const Shape& shape, const dvec3& origin, const dvec3& direction) {
    const SceneTracer tracer(packed(shape));
    Ray ray = makeRay(origin, direction);
    std::vector<double> found;
    while (const auto hit = tracer.closest(ray)) {
        EXPECT_EQ(hit, tracer.closestBruteForce(ray));
        found.push_back(hit->t);
        ray.tMin = hit->t;
    }
    return found;
}

void expectHits(const std::vector<double>& found, const std::vector<double>& expected, double relative) {
    ASSERT_EQ(found.size(), expected.size());
    for (size_t i = 0; i < found.size(); ++i)
        EXPECT_NEAR(found[i], expected[i], relative * std::abs(expected[i]));
}

// J. Buck, The Ray Tracer Challenge, chapter 13: x^2 + z^2 = y^2.
TEST(ReferenceQuadric, ConesOfTheRayTracerChallenge) {
    const Shape cone = general({1, -1, 1, 0, 0, 0, 0, 0, 0, 0}, 64);
    expectHits(hitsOf(cone, {0, 0, -5}, {0, 0, 1}), {5}, 1e-12);
    // A tangent: rounding of the direction may part its double root by the square root of itself.
    EXPECT_NEAR(hitsOf(cone, {0, 0, -5}, glm::normalize(dvec3(1, 1, 1))).at(0), 8.660254037844386, 1e-7);
    expectHits(hitsOf(cone, {1, 1, -5}, glm::normalize(dvec3(-0.5, -1, 1))), {4.55006, 49.44994}, 1e-5);
    // Parallel to a ruling. The book's 0.35355 divides by 2 b for b: (0, 0.25, -0.75) is not on its cone.
    expectHits(hitsOf(cone, {0, 0, -1}, glm::normalize(dvec3(0, 1, 1))), {std::sqrt(0.5)}, 1e-9);
}

// (t - 2)^2 - z^2 t^2 = 1, solved with 40 decimal digits for the directions (1, 0, z) as rounded to fp32.
TEST(ReferenceQuadric, HyperboloidAlongItsAsymptote) {
    const Shape shape = general({1, 1, -1, 0, 0, 0, 0, 0, 0, -1}, 0x1p25);
    expectHits(hitsOf(shape, {-2, 0, 0}, {1, 0, 1}), {0.75}, 0);
    expectHits(hitsOf(shape, {-2, 0, 0}, {1, 0, 1 + 0x1p-23}), {0.7499999664723883}, 1e-12);
    expectHits(hitsOf(shape, {-2, 0, 0}, {-1, 0, -1 - 0x1p-23}), {16777215.750000026}, 1e-12);
    expectHits(hitsOf(shape, {-2, 0, 0}, {1, 0, 1.001f}), {0.7497188071893966}, 1e-12);
    expectHits(hitsOf(shape, {-2, 0, 0}, {-1, 0, -1.001f}), {1999.6567628648377}, 1e-12);
}

TEST(ReferenceQuadric, ParabolicCylinder) {
    const Shape shape = general({1, 0, 0, 0, 0, 0, 0, 0, -1, 0}, 16);
    expectHits(hitsOf(shape, {0.5, 3, 10}, {0, 0, -1}), {9.75}, 0);
    expectHits(hitsOf(shape, {0, 0, 4}, {1, 0, -1}), {1.5615528128088303}, 1e-15);
}

TEST(ReferenceQuadric, DegenerateSurfaces) {
    const Shape doublePlane = general({1, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 8);
    expectHits(hitsOf(doublePlane, {-5, 0, 0}, {1, 0, 0}), {5}, 0);
    EXPECT_TRUE(hitsOf(doublePlane, {0, -20, 0}, {0, 1, 0}).empty()) << "in the plane";
    expectHits(hitsOf(general({0, 0, 0, 0, 0, 0, 0, 2, 0, -2}, 8), {0, 5, 0}, {0, -1, 0}), {4}, 0);
    EXPECT_TRUE(hitsOf(general({1, 1, 1, 0, 0, 0, 0, 0, 0, 1}, 8), {0, 0, 20}, {0, 0, -1}).empty());
    // Two planes, x = y and x = -y.
    expectHits(hitsOf(general({1, -1, 0, 0, 0, 0, 0, 0, 0, 0}, 8), {-5, 2, 0}, {1, 0, 0}), {3, 7}, 1e-15);
}

TEST(ReferenceQuadric, CylinderAlongItsAxis) {
    const CylinderShape open{{0, 0, -8}, {0, 0, 0x1p20}, 1, false};
    EXPECT_TRUE(hitsOf(open, {0.5, 0, -20}, {0, 0, 1}).empty());
    expectHits(hitsOf(open, {0, 0, 0}, {1e-6, 0, 1}), {1e6}, 1e-12);
    const CylinderShape capped{{0, 0, -8}, {0, 0, 8}, 1, true};
    expectHits(hitsOf(capped, {0.5, 0, -20}, {0, 0, 1}), {12, 28}, 0);
}

TEST(ReferenceQuadric, NormalsPointOutward) {
    const SceneTracer tracer(packed(CylinderShape{{0, 0, -1}, {0, 0, 2}, 0.5, true}));
    const auto normalAt = [&](const dvec3& o, const dvec3& d) {
        const Ray ray = makeRay(o, d);
        return tracer.surfaceAt(ray, tracer.closest(ray).value()).geometricNormal;
    };
    EXPECT_EQ(normalAt({0.25, 0, 9}, {0, 0, -1}), dvec3(0, 0, 1));
    EXPECT_EQ(normalAt({0.25, 0, -9}, {0, 0, 1}), dvec3(0, 0, -1));
    EXPECT_EQ(normalAt({9, 0, 0}, {-1, 0, 0}), dvec3(1, 0, 0));
    EXPECT_EQ(normalAt({0, 0, 0}, {0, 1, 0}), dvec3(0, 1, 0)) << "from inside";
    EXPECT_EQ(normalAt({0, 0, 0}, {0, 0, 1}), dvec3(0, 0, 1)) << "the cap from inside";
}

// Where the gradient vanishes the surface faces the ray.
TEST(ReferenceQuadric, NoNormalAtAnApexAndOnADoublePlane) {
    const SceneTracer tracer(packed(general({1, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 8)));
    const Ray ray = makeRay({-5, 0, 0}, {2, 0, 0});
    EXPECT_EQ(tracer.surfaceAt(ray, tracer.closest(ray).value()).geometricNormal, dvec3(-1, 0, 0));
}

// As pbrt's Reintersect tests (src/pbrt/shapes_test.cpp): a ray that leaves outward never meets a convex body
// again; one that goes inward meets its other side.
TEST(ReferenceQuadric, RaysThatLeaveDoNotComeBack) {
    Random random(7);
    for (int i = 0; i < 300; ++i) {
        const double size = std::pow(10, random.uniform(-4, 4));
        const dvec3 base = random.box(1) * std::pow(10, random.uniform(-2, 3)), axis = random.direction();
        const Shape shapes[] = {EllipsoidShape{base, size * dvec3(1, random.uniform(0.2, 1), 3)},
                                CylinderShape{base, base + size * axis, 0.7 * size, true},
                                ConeShape{base, base + size * axis, 0.7 * size, 0.2 * size, true}};
        const SceneTracer tracer(packed(shapes[i % 3]));
        const Ray ray = rayTowards(base + 20 * size * random.direction(), base + 0.3 * size * axis);
        const auto hit = tracer.closest(ray);
        if (!hit) continue;
        const Surface s = tracer.surfaceAt(ray, *hit);
        for (int k = 0; k < 30; ++k) {
            const dvec3 out = glm::normalize(s.geometricNormal + 0.999 * random.direction());
            EXPECT_FALSE(tracer.closest(makeRay(s.position, out), hit->primitive)) << i << ' ' << k;
            const auto inner = tracer.closest(makeRay(s.position, -out), hit->primitive);
            ASSERT_TRUE(inner) << i << ' ' << k;
            EXPECT_GT(inner->t, 0);
        }
    }
}

// The ellipsoid that a sphere becomes is that ellipsoid.
TEST(ReferenceQuadric, TransformedSphereIsAnEllipsoid) {
    Affine stretch;
    stretch.linear = glm::dmat3(2, 0, 0, 0, 0.5, 0, 0, 0, 1);
    stretch.offset = {1, 2, 3};
    const PackedScene a = packed(EllipsoidShape{{0, 0, 0}, dvec3(1)}, stretch),
                      b = packed(EllipsoidShape{{1, 2, 3}, {2, 0.5, 1}});
    Random random(3);
    for (int i = 0; i < 200; ++i) {
        const Ray ray =
            rayTowards(dvec3(1, 2, 3) + 9.0 * random.direction(), dvec3(1, 2, 3) + random.box(0.4));
        const auto hitA = Tracer(a).closest(ray), hitB = Tracer(b).closest(ray);
        ASSERT_TRUE(hitA && hitB);
        EXPECT_NEAR(hitA->t, hitB->t, 1e-12);
        EXPECT_LT(glm::distance(Tracer(a).surfaceAt(ray, *hitA).geometricNormal,
                                Tracer(b).surfaceAt(ray, *hitB).geometricNormal),
                  1e-12);
    }
}

}  // namespace glint::reference::test::quadric_test
