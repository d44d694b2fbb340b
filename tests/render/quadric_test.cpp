// Quadrics on the device: published hits, the reference's for random rays, no acne.
#include <array>
#include <cmath>

#include "reference/tracer.h"
#include "support.h"

namespace glint::render::test::quadric_test {
namespace {

using glm::dvec3;
using glm::vec3;

constexpr double kUnit = 0x1p-24;

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

TEST_F(QuadricTest, RandomQuadricsAgreeWithTheReference) {
    Random random(21);
    size_t hits = 0, different = 0;
    for (int i = 0; i < 14; ++i) {
        const dvec3 base = random.box(10), top = base + random.uniform(0.3, 3) * random.direction();
        const double r = random.uniform(0.2, 2);
        std::array<double, 10> c{};
        for (double& x : c) x = random.uniform(-1, 1);
        const bool capped = i % 2 == 0;
        const Shape shapes[] = {EllipsoidShape{base, dvec3(r, 1, 0.3)},
                                CylinderShape{base, top, r, capped},
                                ConeShape{base, top, r, 0, capped},
                                ConeShape{base, top, 0.4 * r, r, capped},
                                HyperboloidShape{base, top, r, 0.5 * r, capped},
                                ParaboloidShape{base, top, r, capped},
                                general(c, 2)};
        const Shape& shape = shapes[i % 7];
        const dvec3 middle = i % 7 == 6 ? dvec3(0) : 0.5 * (base + top);
        std::vector<RayInput> rays;
        for (int k = 0; k < 900; ++k)
            rays.push_back(rayTowards(middle + 12.0 * random.direction(), middle + random.box(1.2 * r)));
        const PackedScene packed = packScene(sceneOf(shape));
        Renderer renderer(device(), packed);
        const auto found = renderer.trace(rays, false);
        const reference::Tracer tracer(packed);
        for (size_t k = 0; k < rays.size(); ++k) {
            const reference::Ray ray{dvec3(rays[k].origin), dvec3(rays[k].direction)};
            const auto expected = tracer.closest(ray);
            if (found[k].hit != expected.has_value()) {
                ++different;
                continue;
            }
            if (!expected) continue;
            ++hits;
            const auto s = tracer.surfaceAt(ray, *expected);
            const double reach = glm::length(ray.direction),
                         cosine = std::abs(glm::dot(ray.direction, s.geometricNormal)) / reach;
            // 64 roundings of the coordinates, over the cosine; next to a silhouette the other surface may be
            // taken.
            const double bound = 64 * kUnit * (reach + 30) / cosine;
            if (cosine < 1e-2 || std::abs(found[k].t - expected->t) * reach > bound) {
                ++different;
                continue;
            }
            EXPECT_LE(glm::distance(dvec3(found[k].data.position), s.position), 2 * bound);
        }
    }
    EXPECT_GT(hits, 4000u);
    // Silhouettes, rims and cosines below 1/100: some per cent of random rays at the last.
    EXPECT_LT(different, hits / 50);
}

// Lit along the view by parallel light, everything seen is lit: nothing shades itself, at any place and size.
TEST_F(QuadricTest, NoAcne) {
    for (const double offset : {0.0, 1e3}) {
        for (const double size : {1e-3, 1.0, 1e3}) {
            const dvec3 at(offset, -offset, offset), axis = size * glm::normalize(dvec3(0.3, 1, 0.2));
            const Shape shapes[] = {EllipsoidShape{at, size * dvec3(1, 0.5, 0.7)},
                                    CylinderShape{at, at + axis, 0.6 * size, true},
                                    CylinderShape{at, at + axis, 0.6 * size, false},
                                    ConeShape{at, at + axis, 0.6 * size, 0, true},
                                    HyperboloidShape{at, at + axis, 0.6 * size, 0.3 * size, false},
                                    ParaboloidShape{at, at + axis, 0.6 * size, false}};
            Scene scene = emptyScene();
            for (int i = 0; i < 6; ++i) {
                const dvec3 aside = 2 * size * dvec3(i % 3 - 1, i / 3, 0);
                scene.objects.push_back({"quadric", shapes[i], 0, Affine{glm::dmat3(1), aside}});
            }
            const dvec3 view = glm::normalize(dvec3(0.3, -0.8, -0.6));
            scene.lights.push_back(DirectionalLight{view, Color(1)});
            scene.camera.projection = Projection::Orthographic;
            scene.camera.eye = at - 6 * size * view;
            scene.camera.target = at;
            scene.camera.height = 6 * size;
            const Picture picture = draw(device(), makeCase(scene, 128, 128));
            std::array<size_t, 6> seen{};
            size_t dark = 0;
            for (const PixelData& data : picture.data) {
                if (data.object >= 6) continue;
                ++seen[data.object];
                dark += data.shadowBits != 0;
            }
            for (const size_t pixels : seen) EXPECT_GT(pixels, 100u);
            EXPECT_EQ(dark, 0u) << offset << ' ' << size;
        }
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

}  // namespace
}  // namespace glint::render::test::quadric_test
