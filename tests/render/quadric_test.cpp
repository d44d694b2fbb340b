// Quadrics on the device: published hits, rims, lines that touch.
#include <array>
#include <cmath>

#include "support.h"

namespace glint::render::test::quadric_test {
using glm::dvec3;
using glm::vec3;

QuadricShape general(std::array<double, 10> coefficients, double half) {
    QuadricShape shape;
    std::copy(coefficients.begin(), coefficients.end(), shape.coefficients);
    shape.lo = dvec3(-half);
    shape.hi = dvec3(half);
    return shape;
}

class QuadricTest : public RenderTest {
  protected:
    static Scene sceneOf(const Shape& shape) {
        Scene scene = emptyScene();
        scene.camera.eye = {0, 0, 1e3};
        scene.objects.push_back({"quadric", shape, 0});
        return scene;
    }
    static std::vector<RayHit> hitsOf(const Shape& shape, const std::vector<RayInput>& rays) {
        const PackedScene packed = packScene(sceneOf(shape));
        Renderer renderer(device(), packed);
        return renderer.trace(rays, false);
    }
    static double hitOf(const Shape& shape, const dvec3& origin, const dvec3& direction, float tMin = 0) {
        RayInput ray = rayOf(vec3(origin), vec3(direction));
        ray.tMin = tMin;
        const RayHit hit = hitsOf(shape, {ray})[0];
        return hit.hit ? hit.t : -1;
    }
};

// J. Buck, The Ray Tracer Challenge, chapter 13, within 8 roundings of the way.
TEST_F(QuadricTest, ConesOfTheRayTracerChallenge) {
    const Shape cone = general({1, -1, 1, 0, 0, 0, 0, 0, 0, 0}, 64);
    EXPECT_EQ(hitOf(cone, {0, 0, -5}, {0, 0, 1}), 5) << "through the apex";
    const dvec3 slanted = glm::normalize(dvec3(-0.5, -1, 1));
    EXPECT_NEAR(hitOf(cone, {1, 1, -5}, slanted), 4.55006, 1e-5);
    EXPECT_NEAR(hitOf(cone, {1, 1, -5}, slanted, 5), 49.44994, 1e-4);
    // Parallel to a ruling. The book's 0.35355 divides by 2 b for b: (0, 0.25, -0.75) is not on its cone.
    EXPECT_NEAR(hitOf(cone, {0, 0, -1}, glm::normalize(dvec3(0, 1, 1))), std::sqrt(0.5), 1e-6);
    // A tangent along a ruling's mirror: the double root errs by the square root of rounding.
    EXPECT_NEAR(hitOf(cone, {0, 0, -5}, glm::normalize(dvec3(1, 1, 1))), 8.66025, 1e-2);
}

TEST_F(QuadricTest, HyperboloidAlongItsAsymptote) {
    const Shape shape = general({1, 1, -1, 0, 0, 0, 0, 0, 0, -1}, 0x1p25);
    EXPECT_EQ(hitOf(shape, {-2, 0, 0}, {1, 0, 1}), 0.75);
    EXPECT_NEAR(hitOf(shape, {-2, 0, 0}, {1, 0, 1 + 0x1p-23}), 0.749999966, 2e-7);
    EXPECT_NEAR(hitOf(shape, {-2, 0, 0}, {-1, 0, -1 - 0x1p-23}), 16777215.75, 8);
    EXPECT_NEAR(hitOf(shape, {-2, 0, 0}, {1, 0, 1.001}), 0.749718807, 2e-7);
}

TEST_F(QuadricTest, DegenerateSurfaces) {
    const Shape parabola = general({1, 0, 0, 0, 0, 0, 0, 0, -1, 0}, 16);
    EXPECT_EQ(hitOf(parabola, {0.5, 3, 10}, {0, 0, -1}), 9.75);
    EXPECT_NEAR(hitOf(parabola, {0, 0, 4}, {1, 0, -1}), 1.5615528128088303, 4e-7);
    const Shape doublePlane = general({1, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 8);
    EXPECT_EQ(hitOf(doublePlane, {-5, 0, 0}, {1, 0, 0}), 5);
    EXPECT_EQ(hitsOf(doublePlane, {rayOf({-5, 0, 0}, {2, 0, 0})})[0].data.geometricNormal, vec3(-1, 0, 0));
    EXPECT_EQ(hitOf(doublePlane, {0, -20, 0}, {0, 1, 0}), -1) << "in the plane";
    EXPECT_EQ(hitOf(general({1, 1, 1, 0, 0, 0, 0, 0, 0, 1}, 8), {0, 0, 20}, {0, 0, -1}), -1);
    EXPECT_EQ(hitOf(general({1, -1, 0, 0, 0, 0, 0, 0, 0, 0}, 8), {-5, 2, 0}, {1, 0, 0}), 3);
}

TEST_F(QuadricTest, CylinderAlongItsAxis) {
    const CylinderShape open{{0, 0, -8}, {0, 0, 0x1p20}, 1, false};
    EXPECT_EQ(hitOf(open, {0.5, 0, -20}, {0, 0, 1}), -1);
    EXPECT_NEAR(hitOf(open, {0, 0, 0}, {1e-6, 0, 1}), 1e6, 1);
    const CylinderShape capped{{0, 0, -8}, {0, 0, 8}, 1, true};
    EXPECT_EQ(hitOf(capped, {0.5, 0, -20}, {0, 0, 1}), 12);
    EXPECT_EQ(hitOf(capped, {0.5, 0, 0}, {0, 0, 1}), 8);
    EXPECT_EQ(hitOf(capped, {1.5, 0, -20}, {0, 0, 1}), -1);
}

// A closed body has no gap at its rims: rays from outside towards points of the rims pass no farther than the
// body reaches, and rays from its middle never leave it.
TEST_F(QuadricTest, NoGapAtTheRims) {
    Random random(8);
    for (int i = 0; i < 3; ++i) {
        const dvec3 base = random.box(3), axis = random.direction(), top = base + axis;
        const Shape shapes[] = {CylinderShape{base, top, 0.5, true}, ConeShape{base, top, 0.5, 0.2, true},
                                HyperboloidShape{base, top, 0.5, 0.3, true}};
        const double topRadius[] = {0.5, 0.2, 0.5};
        const dvec3 u = glm::normalize(glm::cross(axis, random.direction())), v = glm::cross(axis, u);
        std::vector<RayInput> rays;
        for (int k = 0; k < 2000; ++k) {
            const double angle = random.uniform(0, 6.3);
            const dvec3 out = std::cos(angle) * u + std::sin(angle) * v;
            const dvec3 rim = k % 2 ? base + 0.5 * out : top + topRadius[i % 3] * out;
            rays.push_back(rayTowards(base + 0.5 * axis, rim));
        }
        EXPECT_EQ(misses(hitsOf(shapes[i % 3], rays)), 0u) << i;
    }
}

// A line along the axis of a hyperboloid that touches its neck is inside: the outward normal looks along it,
// whichever way the axis and the side lie, though the gradient has one component alone and the line no part
// along it.
TEST_F(QuadricTest, ALineThatTouchesANeckIsInside) {
    for (int axis = 0; axis < 3; ++axis) {
        std::array<double, 10> coefficients = {1, 1, 1, 0, 0, 0, 0, 0, 0, -1};
        coefficients[axis] = -1;
        vec3 direction(0);
        direction[axis] = -1;
        for (const int side : {(axis + 1) % 3, (axis + 2) % 3}) {
            for (const float sign : {-1.0f, 1.0f}) {
                vec3 outwards(0);
                outwards[side] = sign;
                const RayHit hit =
                    hitsOf(general(coefficients, 2), {rayOf(outwards - 4.0f * direction, direction)})[0];
                ASSERT_TRUE(hit.hit);
                EXPECT_EQ(hit.t, 4);
                const vec3 normal = hit.data.geometricNormal;
                EXPECT_GT(glm::dot(normal, outwards), 0.99f) << axis << ' ' << side << ' ' << sign;
                EXPECT_GT(glm::dot(normal, direction), 0) << axis << ' ' << side << ' ' << sign;
            }
        }
    }
}

// Radius 1e6 and an eye 1 above: t within 1e-6 of 1, as for spheres.
TEST_F(QuadricTest, HugeCylinderUnderTheEye) {
    Scene scene = emptyScene();
    scene.objects.push_back({"pipe", CylinderShape{{-1e6, -1e6, 0}, {1e6, -1e6, 0}, 1e6}, 0});
    scene.camera.eye = {0, 1, 0};
    scene.camera.target = {0, 0, 0};
    scene.camera.up = {1, 0, 0};
    const PackedScene packed = packScene(scene);
    Renderer renderer(device(), packed);
    for (const double h : {100.0, 1.0, 0.25}) {
        const vec3 eye(dvec3(0, h, 0) - packed.origin);
        const RayHit hit = renderer.trace({rayOf(eye, {0, -1, 0})}, false)[0];
        ASSERT_TRUE(hit.hit);
        EXPECT_NEAR(hit.t / h, 1, 1e-6) << h;
    }
}

}  // namespace glint::render::test::quadric_test
