// Packing of quadrics: extents by hand, boxes that hold the surface, anchors next to the eye.
#include "pack/primitives.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "support/scene_maker.h"

namespace glint::test::quadric_test {
using glm::dvec3;

Object objectOf(const Shape& shape, std::optional<Affine> transform = {}) {
    return {"/objects/0", shape, 0, transform};
}

void expectExtent(const Shape& shape, const dvec3& lo, const dvec3& hi) {
    const Extent e = quadricExtent(objectOf(shape));
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(e.lo[axis], lo[axis], 1e-14) << axis;
        EXPECT_NEAR(e.hi[axis], hi[axis], 1e-14) << axis;
    }
}

TEST(QuadricExtent, NamedFormsAlongAnAxis) {
    expectExtent(EllipsoidShape{{1, 2, 3}, {1, 2, 3}}, {0, 0, 0}, {2, 4, 6});
    expectExtent(CylinderShape{{0, 1, 0}, {0, 3, 0}, 2}, {-2, 1, -2}, {2, 3, 2});
    expectExtent(ConeShape{{0, 0, 0}, {0, 0, 5}, 1}, {-1, -1, 0}, {1, 1, 5});
    expectExtent(ConeShape{{0, 0, 0}, {0, 0, 5}, 1, 4}, {-4, -4, 0}, {4, 4, 5});
    expectExtent(HyperboloidShape{{0, 0, 0}, {5, 0, 0}, 2, 1}, {0, -2, -2}, {5, 2, 2});
    expectExtent(ParaboloidShape{{0, 0, 0}, {0, 2, 0}, 3}, {-3, 0, -3}, {3, 2, 3});
    expectExtent(QuadricShape{{1}, {-1, -2, -3}, {1, 2, 3}}, {-1, -2, -3}, {1, 2, 3});
}

// Leaning 45 degrees: z = x at the axis. The parabola y^2 = 4 h in its plane reaches lowest where its slope
// is that of the axis: h = 1/8 x 4 s^2 ... by hand for radius 1, height 1 (h = s^2, across s): -h/sqrt2 ...
// the least of (s^2 - s)/sqrt2 is -1/(4 sqrt2).
TEST(QuadricExtent, LeaningParaboloidBulgesBelowItsVertex) {
    const double c = std::sqrt(0.5);
    const Extent e = quadricExtent(objectOf(ParaboloidShape{{0, 0, 0}, {c, 0, c}, 1}));
    EXPECT_NEAR(e.lo.z, -0.25 * c, 1e-14);
    EXPECT_NEAR(e.hi.z, 2 * c, 1e-14);
    EXPECT_NEAR(e.hi.y, 1, 1e-14);
}

// They keep their transforms and are no instances: the region that the local frame is chosen by holds them.
TEST(QuadricExtent, TransformedQuadricsHaveARegion) {
    Scene scene;
    Affine map;
    map.linear = glm::dmat3(2);
    map.offset = {1e6, 0, 0};
    Material material;
    scene.materials = {material};
    scene.objects = {objectOf(EllipsoidShape{{0, 0, 0}, {1, 2, 3}}, map)};
    scene.camera.eye = {1e6, 0, 20};
    EXPECT_NEAR(packScene(scene).origin.x, 1e6, 16);
    EXPECT_EQ(packScene(scene).quadrics.size(), 1u);
}

// Points of each surface from a parametrisation, under a random map.
TEST(QuadricBox, HoldsTheSurface) {
    std::mt19937 engine(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto random = [&] { return dvec3(uniform(engine), uniform(engine), uniform(engine)); };
    for (int i = 0; i < 200; ++i) {
        Affine map;
        map.linear = glm::dmat3(random(), random(), random()) + glm::dmat3(1.2);
        map.offset = 100.0 * random();
        const dvec3 base = random(), top = base + random();
        const dvec3 w = glm::normalize(top - base), u = glm::normalize(glm::cross(w, random())),
                    v = glm::cross(w, u);
        const double r = 0.5 + 0.4 * uniform(engine);
        const Shape shapes[] = {CylinderShape{base, top, r, true}, ConeShape{base, top, r, 0, true},
                                HyperboloidShape{base, top, r, 0.5 * r}, ParaboloidShape{base, top, r}};
        for (int kind = 0; kind < 4; ++kind) {
            const Object object = objectOf(shapes[kind], map);
            const Frame frame{dvec3(0), dvec3(0, 0, 500)};
            const Box box = quadricBox(object, frame, roundQuadric(object, frame));
            for (int k = 0; k < 100; ++k) {
                const double h = 0.5 + 0.5 * uniform(engine), angle = std::numbers::pi * uniform(engine);
                const double radius[] = {
                    r, r * (1 - h), r * std::sqrt(0.25 + 0.75 * (2 * h - 1) * (2 * h - 1)), r * std::sqrt(h)};
                const dvec3 p = map.linear * (base + h * (top - base) +
                                              radius[kind] * (std::cos(angle) * u + std::sin(angle) * v)) +
                                map.offset;
                for (int axis = 0; axis < 3; ++axis) {
                    ASSERT_LE(static_cast<double>(box.lo[axis]), p[axis]) << kind;
                    ASSERT_GE(static_cast<double>(box.hi[axis]), p[axis]) << kind;
                }
            }
        }
    }
}

TEST(RoundQuadric, FormOfACylinder) {
    const auto q =
        roundQuadric(objectOf(CylinderShape{{0, 0, 0}, {0, 4, 0}, 2, true}), {dvec3(0), {0, 0, 99}});
    EXPECT_EQ(q.point, glm::vec3(0, 2, 0));
    EXPECT_EQ(q.toLocal2, glm::vec3(0, 0.5, 0));
    EXPECT_EQ(q.squares, glm::vec3(1, 1, 0));
    EXPECT_EQ(q.constant, -1);
    EXPECT_EQ(q.lo.z, -1);
    EXPECT_EQ(q.hi.z, 1);
    EXPECT_EQ(q.caps, shared::kCapLower | shared::kCapUpper);
}

// A cone is measured from its tip, where the other coefficients vanish.
TEST(RoundQuadric, ConesStartFromTheirApex) {
    const auto q =
        roundQuadric(objectOf(ConeShape{{1, 1, 1}, {2, 3, 4}, 0.3, 0, true}), {dvec3(0), {0, 0, 99}});
    EXPECT_EQ(q.point, glm::vec3(2, 3, 4));
    EXPECT_EQ(q.hi.z, 0);
    EXPECT_NEAR(q.constant, 0, 1e-30);
    EXPECT_LT(glm::length(q.linear), 1e-15f);
}

// An eye 1 above a cylinder of radius 1e6: as for spheres, the radius drops out of the equation.
TEST(RoundQuadric, AnchoredNextToTheEye) {
    const CylinderShape shape{{-1e6, -1e6, 0}, {1e6, -1e6, 0}, 1e6};
    const auto q = roundQuadric(objectOf(shape), {dvec3(0), {0, 1, 0}});
    EXPECT_LT(glm::length(q.point), 1e-3f);
    EXPECT_LT(std::abs(q.constant), 1e-12f);
    EXPECT_GT(glm::length(q.linear), 0.1f);
}

// An eye 1 before the end of a cone of size 1000: the plane of the end is at exactly 0, not at 2^-24 of the
// way from the middle. Seen from afar the cone is measured from its apex.
TEST(RoundQuadric, AnchoredAtTheCapNextToTheEye) {
    const ConeShape shape{{0, 0, 0}, {0, 0, -1000}, 700, 300, true};
    const auto near = roundQuadric(objectOf(shape), {dvec3(0), {50, 20, 1}});
    EXPECT_EQ(near.point, glm::vec3(50, 20, 0));
    EXPECT_EQ(near.lo.z, 0);
    const auto far = roundQuadric(objectOf(shape), {dvec3(0), {50, 20, 3000}});
    EXPECT_NEAR(far.point.z, -1750, 1e-3);
    const auto beside = roundQuadric(objectOf(shape), {dvec3(0), {900, 0, 1}});
    EXPECT_NEAR(beside.point.z, -1750, 1e-3) << "the eye is not before the cap";
}

TEST(RoundQuadric, LongPipesAreMeasuredFromTheEyesPlace) {
    const CylinderShape shape{{-100, 0, 0}, {100, 0, 0}, 10};
    EXPECT_EQ(roundQuadric(objectOf(shape), {dvec3(0), {60, 0, 100}}).point, glm::vec3(60, 0, 0));
    EXPECT_EQ(roundQuadric(objectOf(shape), {dvec3(0), {600, 0, 100}}).point, glm::vec3(100, 0, 0));
}

}  // namespace glint::test::quadric_test
