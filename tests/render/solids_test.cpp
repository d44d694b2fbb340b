// Boxes and quadrics: faces, walls, rims, necks.
#include <array>
#include <cmath>

#include "support.h"

namespace glint::render::test::solids_test {

using glm::dvec3;
using glm::vec3;

class BoxTest : public RenderTest {};

TEST_F(BoxTest, FacesFromOutsideAndInside) {
    const PackedScene scene = packScene(sceneOf(BoxShape{{-1, -2, -3}, {1, 2, 3}}));
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0f, 1.0f}) {
            vec3 out(0);
            out[axis] = side;
            const auto size = static_cast<float>(axis + 1);
            const std::vector<RayHit> hits = hitsOfBoth(
                scene, {rayOf((size + 2) * out, -out), rayOf(vec3(0.25f), out), rayOf(size * out, -out)});
            EXPECT_EQ(hits[0].t, 2);
            EXPECT_EQ(hits[0].data.geometricNormal, out);
            EXPECT_EQ(hits[1].t, size - side * 0.25f);
            EXPECT_EQ(hits[1].data.position[axis], side * size) << "exactly on the face";
            EXPECT_EQ(hits[2].t, 2 * size) << "t = 0 is no hit: the far face";
        }
    }
}

// Boxes are closed: a ray along a face hits the box, a ray an ulp beside it misses.
TEST_F(BoxTest, RaysAlongFacesAndEdges) {
    const PackedScene scene = packScene(sceneOf(BoxShape{{-1, -1, -1}, {1, 1, 1}}));
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
    for (const RayHit& h : hitsOfBoth(scene, hit)) {
        ASSERT_TRUE(h.hit);
        EXPECT_EQ(h.t, 4);
    }
    EXPECT_EQ(missesOf(scene, missed), missed.size());
}

// No ray at exact corners, edges or inner points of a wall's joints gets through.
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

class QuadricTest : public RenderTest {};

// No ray from the middle of a closed body leaves it at its rims.
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
        EXPECT_EQ(missesOf(packScene(sceneOf(shapes[i % 3])), rays), 0u) << i;
    }
}

// A line along the axis of a hyperboloid that touches its neck is inside, so the outward normal points along
// it, although the gradient has only one component, orthogonal to the line.
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
                const RayHit hit = hitOf(sceneOf(generalQuadric(coefficients, 2)),
                                         rayOf(outwards - 4.0f * direction, direction));
                ASSERT_TRUE(hit.hit);
                EXPECT_EQ(hit.t, 4);
                const vec3 normal = hit.data.geometricNormal;
                EXPECT_GT(glm::dot(normal, outwards), 0.99f) << axis << ' ' << side << ' ' << sign;
                EXPECT_GT(glm::dot(normal, direction), 0) << axis << ' ' << side << ' ' << sign;
            }
        }
    }
}

// Beside the apex rounding decides the sign of the normal, and of the equation where the eye lies on the
// mirrored cone. Every hit from outside enters.
TEST_F(QuadricTest, ALineAlongAConeThroughItsApexEnters) {
    const PackedScene packed = packScene(sceneOf(ConeShape{{0, -1, 0}, {0, 1, 0}, 1, 0, true}));
    std::vector<RayInput> rays;
    for (int i = -30; i <= 30; ++i)
        for (int j = -30; j <= 30; ++j)
            rays.push_back(rayOf({0, 3, 1}, glm::normalize(vec3(dvec3(4e-6 * i, -2 + 3e-6 * j, -1)))));
    const std::vector<RayHit> hits = hitsOf(packed, rays);
    size_t entered = 0, left = 0;
    for (size_t i = 0; i < hits.size(); ++i) {
        if (!hits[i].hit) continue;
        const bool enters = glm::dot(hits[i].data.geometricNormal, rays[i].direction) < 0;
        ++(enters ? entered : left);
    }
    EXPECT_GT(entered, 500u);
    EXPECT_EQ(left, 0u);
}

// Radius 1e6 and an eye 1 above: t within 1e-6 of 1, as for spheres.
TEST_F(QuadricTest, HugeCylinderUnderTheEye) {
    Scene scene = sceneOf(CylinderShape{{-1e6, -1e6, 0}, {1e6, -1e6, 0}, 1e6});
    aim(scene.camera, {0, 1, 0}, {0, 0, 0}, {1, 0, 0});
    const PackedScene packed = packScene(scene);
    for (const double h : {100.0, 1.0, 0.25}) {
        const vec3 eye(dvec3(0, h, 0) - packed.origin);
        const RayHit hit = hitOf(packed, rayOf(eye, {0, -1, 0}));
        ASSERT_TRUE(hit.hit);
        EXPECT_NEAR(hit.t / h, 1, 1e-6) << h;
    }
}

}  // namespace glint::render::test::solids_test
