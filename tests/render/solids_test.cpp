// Spheres, boxes and quadrics whose hits are known.
#include <array>
#include <cmath>

#include "reference/tracer.h"
#include "support.h"

namespace glint::render::test::solids_test {

// Spheres on the device: published hits, tangents, rays from inside and from the surface.

using glm::dvec3;
using glm::vec3;

constexpr double kUnit = 0x1p-24;

class SphereTest : public RenderTest {
  protected:
    // The first hit after tMin, or nothing.
    static std::optional<float> hitOf(const dvec3& center, double radius, const RayInput& ray) {
        Scene scene = emptyScene();
        scene.camera.eye = dvec3(ray.origin);
        scene.camera.target = scene.camera.eye + dvec3(0, 0, -1);
        addSphere(scene, center, radius);
        const RayHit hit = RenderTest::hitOf(scene, ray);
        return hit.hit ? std::optional<float>(hit.t) : std::nullopt;
    }
    static RayInput after(RayInput ray, float tMin) {
        ray.tMin = tMin;
        return ray;
    }
};

// Shirley and Marschner: (1, 1, 1) - t (1, 1, 1) and the unit sphere, t = 1 -+ 1 / sqrt(3).
TEST_F(SphereTest, DiagonalThroughTheUnitSphere) {
    const RayInput ray = rayOf({1, 1, 1}, {-1, -1, -1});
    EXPECT_NEAR(hitOf({0, 0, 0}, 1, ray).value(), 1 - 1 / std::sqrt(3.0), 4 * kUnit);
    EXPECT_NEAR(hitOf({0, 0, 0}, 1, after(ray, 1)).value(), 1 + 1 / std::sqrt(3.0), 4 * kUnit * 1.6);
}

// Buck, The Ray Tracer Challenge, features/spheres.feature.
TEST_F(SphereTest, RayTracerChallenge) {
    const auto ray = [](float x, float y, float z) { return rayOf({x, y, z}, {0, 0, 1}); };
    EXPECT_EQ(hitOf({0, 0, 0}, 1, ray(0, 0, -5)), 4);
    EXPECT_EQ(hitOf({0, 0, 0}, 1, after(ray(0, 0, -5), 5)), 6);
    EXPECT_EQ(hitOf({0, 0, 0}, 1, ray(0, 1, -5)), 5);
    EXPECT_EQ(hitOf({0, 0, 0}, 1, after(ray(0, 1, -5), 5)), std::nullopt);
    EXPECT_EQ(hitOf({0, 0, 0}, 1, ray(0, 2, -5)), std::nullopt);
    EXPECT_EQ(hitOf({0, 0, 0}, 1, ray(0, 0, 0)), 1);
    EXPECT_EQ(hitOf({0, 0, 0}, 1, ray(0, 0, 5)), std::nullopt);
    EXPECT_EQ(hitOf({0, 0, 0}, 2, ray(0, 0, -5)), 3);
    EXPECT_EQ(hitOf({0, 0, 0}, 2, after(ray(0, 0, -5), 5)), 7);
    EXPECT_EQ(hitOf({5, 0, 0}, 1, ray(0, 0, -5)), std::nullopt);
}

// b is the ray's distance from the centre: t = 10 - sqrt(1 - b^2).
TEST_F(SphereTest, Tangents) {
    const auto hit = [](float b) { return hitOf({0, 0, 0}, 1, rayOf({b, 0, -10}, {0, 0, 1})); };
    EXPECT_NEAR(hit(0.99999994f).value(), 10 - std::sqrt(1 - 0.99999994 * 0.99999994), 4 * kUnit * 10);
    EXPECT_EQ(hit(1), 10);
    EXPECT_EQ(hit(1.0000001f), std::nullopt);
}

// A ray that starts on a sphere sees its far side only: r = |2 b / a|, the start taken as exactly on it.
TEST_F(SphereTest, InsideAndOutside) {
    EXPECT_EQ(hitOf({0, 0, 0}, 1, rayOf({0, 0, 0.5f}, {0, 0, 1})), 0.5f);
    EXPECT_EQ(hitOf({0, 0, 0}, 1, rayOf({0, 0, 0.5f}, {0, 0, -1})), 1.5f);
    EXPECT_EQ(hitOf({0, 0, 0}, 1, rayOf({0, 0, 1}, {0, 0, 1})), std::nullopt);  // t = 0 is excluded
    EXPECT_EQ(hitOf({0, 0, 0}, 1, rayOf({0, 0, 1}, {0, 0, -1})), 2);
}

// Boxes on the device and in the reference: hits known by hand, edges and corners, walls of boxes.

class BoxTest : public RenderTest {
  protected:
    // Of the device and, as a check on the test, of the reference, which must agree about what is hit.
    static std::vector<RayHit> hitsOf(const Scene& scene, const std::vector<RayInput>& rays) {
        const PackedScene packed = packScene(scene);
        const std::vector<RayHit> hits = RenderTest::hitsOf(packed, rays);
        const reference::Tracer tracer(packed);
        for (size_t i = 0; i < rays.size(); ++i) {
            const auto hit = tracer.closest({dvec3(rays[i].origin), dvec3(rays[i].direction)});
            EXPECT_EQ(hit.has_value(), hits[i].hit) << text(rays[i]);
        }
        return hits;
    }
};

TEST_F(BoxTest, FacesFromOutsideAndInside) {
    Scene scene = emptyScene();
    addObject(scene, BoxShape{{-1, -2, -3}, {1, 2, 3}});
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0f, 1.0f}) {
            vec3 out(0);
            out[axis] = side;
            const auto size = static_cast<float>(axis + 1);
            const std::vector<RayHit> hits = hitsOf(
                scene, {rayOf((size + 2) * out, -out), rayOf(vec3(0.25f), out), rayOf(size * out, -out)});
            EXPECT_EQ(hits[0].t, 2);
            EXPECT_EQ(hits[0].data.geometricNormal, out);
            EXPECT_EQ(hits[1].t, size - side * 0.25f);
            EXPECT_EQ(hits[1].data.position[axis], side * size) << "exactly on the face";
            EXPECT_EQ(hits[2].t, 2 * size) << "t = 0 is no hit: the far face";
        }
    }
}

// Boxes are closed: a ray along a face meets the box, one a float beside it does not.
TEST_F(BoxTest, RaysAlongFacesAndEdges) {
    Scene scene = emptyScene();
    addObject(scene, BoxShape{{-1, -1, -1}, {1, 1, 1}});
    const float beside = std::nextafter(1.0f, 2.0f);
    std::vector<RayInput> hit, missed;
    for (const float zero : {0.0f, -0.0f}) {
        for (const float side : {-1.0f, 1.0f}) {
            hit.push_back(rayOf({-5, side, 0.5f}, {1, zero, zero}));  // in a face's plane
            hit.push_back(rayOf({-5, side, side}, {1, zero, zero}));  // along an edge
            hit.push_back(rayOf({5, side, -side}, {-1, zero, zero}));
            missed.push_back(rayOf({-5, side * beside, 0.5f}, {1, zero, zero}));
            missed.push_back(rayOf({-5, side, side * beside}, {1, zero, zero}));
            missed.push_back(rayOf({1, side, 0}, {1, zero, zero}));  // leaves at t = 0
        }
    }
    for (const RayHit& h : hitsOf(scene, hit)) {
        ASSERT_TRUE(h.hit);
        EXPECT_EQ(h.t, 4);
    }
    EXPECT_EQ(misses(hitsOf(scene, missed)), missed.size());
}

// Rays at exact corners, edges and inner points of the joints of a wall: no ray gets through, nor past the
// joints of the boxes behind, whose planes are the same floats.
TEST_F(BoxTest, NoRayGetsThroughAWall) {
    Random random(9);
    std::vector<float> xs{-4}, ys{-4};
    for (int i = 0; i < 8; ++i) {
        xs.push_back(xs.back() + static_cast<float>(random.uniform(0.2, 1)));
        ys.push_back(ys.back() + static_cast<float>(random.uniform(0.2, 1)));
    }
    Scene scene = emptyScene();
    for (size_t i = 0; i + 1 < xs.size(); ++i)
        for (size_t j = 0; j + 1 < ys.size(); ++j)
            addObject(scene, BoxShape{{xs[i], ys[j], 0}, {xs[i + 1], ys[j + 1], 0.125}});
    std::vector<RayInput> rays;
    for (size_t i = 1; i + 1 < xs.size(); ++i) {
        for (size_t j = 1; j + 1 < ys.size(); ++j) {
            for (int k = 0; k < 60; ++k) {
                const dvec3 joint(xs[i], ys[j], k % 2 == 0 ? 0.125 : 0.0625);
                const dvec3 along(0, k % 3 == 0 ? random.uniform(0, 0.2) : 0.0, 0);
                const dvec3 origin =
                    joint + dvec3(random.uniform(-9, 9), random.uniform(-9, 9), 1) *
                                (k % 5 == 0 ? dvec3(0, 0, 3) : dvec3(1, 1, random.uniform(1, 9)));
                rays.push_back(rayTowards(origin, joint + along));
            }
        }
    }
    EXPECT_EQ(missesOf(packScene(scene), rays), 0u);
}

// Quadrics on the device: published hits, rims, lines that touch.

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
        addObject(scene, shape);
        return scene;
    }
    static std::vector<RayHit> hitsOf(const Shape& shape, const std::vector<RayInput>& rays) {
        return RenderTest::hitsOf(packScene(sceneOf(shape)), rays);
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
// though the gradient has one component alone and the line no part along it.
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
    addObject(scene, CylinderShape{{-1e6, -1e6, 0}, {1e6, -1e6, 0}, 1e6});
    aim(scene.camera, {0, 1, 0}, {0, 0, 0}, {1, 0, 0});
    const PackedScene packed = packScene(scene);
    for (const double h : {100.0, 1.0, 0.25}) {
        const vec3 eye(dvec3(0, h, 0) - packed.origin);
        const RayHit hit = RenderTest::hitOf(packed, rayOf(eye, {0, -1, 0}));
        ASSERT_TRUE(hit.hit);
        EXPECT_NEAR(hit.t / h, 1, 1e-6) << h;
    }
}

}  // namespace glint::render::test::solids_test
