#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "scene/keyframes.h"
#include "scene/polygon_plane.h"
#include "scene/transform.h"
#include "support/support.h"

namespace glint::transform_test {

using glm::dvec3;
using test::expectNear;

dvec3 windingNormal(const dvec3& a, const dvec3& b, const dvec3& c) {
    return glm::cross(b - a, c - a);
}

// A right-angled corner of a solid at the origin, seen from outside; its outward normal is +z.
TriangleShape cornerTriangle() {
    return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
}

const Affine kShear = [] {
    Affine t;
    t.linear = glm::dmat3(1, 0, 0, 0.5, 2, 0, 0.25, 0, 3);  // columns
    t.offset = {1, 2, 3};
    return t;
}();
const Affine kMirror = scaling({-1, 1, 1});

TEST(Transform, QuarterTurnsAreExactAndCounterClockwise) {
    const dvec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    EXPECT_EQ(apply(rotation(z, 90), x), y);
    EXPECT_EQ(apply(rotation(x, 90), y), z);
    EXPECT_EQ(apply(rotation(y, 90), z), x);
    EXPECT_EQ(apply(rotation(z, -90), x), -y);
    EXPECT_EQ(apply(rotation(z, 180), x), -x);
    EXPECT_EQ(apply(rotation(z, 270), x), -y);
    EXPECT_EQ(apply(rotation(z, 360 * 1000 + 90), x), y);
    EXPECT_EQ(apply(rotation(z * 1e200, 90), x), y);  // the axis' length does not count
}

TEST(Transform, GeneralRotation) {
    // 120 degrees about (1,1,1) permutes the axes; 30 degrees: cosine sqrt(3)/2, sine 1/2.
    expectNear(apply(rotation({1, 1, 1}, 120), {1, 2, 3}), {3, 1, 2}, 1e-15);
    expectNear(apply(rotation({0, 1, 0}, 30), {0, 0, 1}), {0.5, 0, std::sqrt(3.0) / 2}, 1e-15);
}

TEST(Transform, ConditionNumberOfDiagonals) {
    // Frobenius: sqrt(a^2+b^2+c^2) sqrt(1/a^2+1/b^2+1/c^2)
    EXPECT_DOUBLE_EQ(conditionNumber(glm::dmat3(1)), 3);
    EXPECT_DOUBLE_EQ(conditionNumber(scaling(dvec3(1e-200)).linear), 3);
    EXPECT_DOUBLE_EQ(conditionNumber(scaling(dvec3(1e200)).linear), 3);
    EXPECT_DOUBLE_EQ(conditionNumber(scaling({1, 2, 4}).linear), std::sqrt(21.0 * (1 + 0.25 + 0.0625)));
    EXPECT_TRUE(std::isinf(conditionNumber(scaling({1, 0, 1}).linear)));
    EXPECT_TRUE(std::isinf(conditionNumber(glm::dmat3(0))));
    EXPECT_TRUE(std::isnan(conditionNumber(scaling({1, std::numeric_limits<double>::infinity(), 1}).linear)));
    EXPECT_TRUE(std::isnan(conditionNumber(scaling({1, std::nan(""), 1}).linear)));
}

TEST(Transform, Similarities) {
    EXPECT_DOUBLE_EQ(similarityFactor(glm::dmat3(1)).value(), 1);
    const Affine turned =
        then(then(rotation({1, 2, 3}, 77), scaling(dvec3(-1e-100))), rotation({3, 1, 0}, 11));
    EXPECT_NEAR(similarityFactor(turned.linear).value() / 1e-100, 1, 1e-14);
    // A turn by 45 degrees written with seven digits.
    EXPECT_NEAR(
        similarityFactor(glm::dmat3(0.7071068, 0.7071068, 0, -0.7071068, 0.7071068, 0, 0, 0, 1)).value(), 1,
        1e-6);
    EXPECT_FALSE(similarityFactor(scaling({1, 1, 1.00001}).linear));
    EXPECT_FALSE(similarityFactor(kShear.linear));
}

TEST(Transform, NormalsStayPerpendicularAndOutward) {
    for (const Affine& t :
         {kShear, kMirror, then(kMirror, kShear), rotation({1, 2, 3}, 50), scaling(dvec3(-2))}) {
        Mesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        mesh.normals = {{0, 0, 5}};
        mesh.corners = {{0, 1, 2}};
        mesh.normalCorners = {{0, 0, 0}};
        const Mesh out = transformed(mesh, t);
        const glm::uvec3 c = out.corners[0];
        const dvec3 winding =
            glm::normalize(windingNormal(out.positions[c.x], out.positions[c.y], out.positions[c.z]));
        expectNear(out.normals[0], winding, 1e-15);  // the vertex normal agrees with the winding
        // Outward: the solid's inside, below the triangle, is still on the other side.
        const dvec3 inside = apply(t, {0.25, 0.25, -1}) - apply(t, {0.25, 0.25, 0});
        EXPECT_LT(glm::dot(inside, winding), 0);

        const TriangleShape triangle = transformed(cornerTriangle(), t);
        expectNear(
            glm::normalize(windingNormal(triangle.vertices[0], triangle.vertices[1], triangle.vertices[2])),
            winding, 1e-15);
        const PlaneShape plane = transformed(PlaneShape{{0, 0, 0}, {0, 0, 0.1}}, t);
        expectNear(plane.normal, winding, 1e-15);
        EXPECT_EQ(plane.point, t.offset);
    }
}

TEST(Transform, MirroringExchangesCornersOfNormalsToo) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    mesh.normals = {{0, 0, 1}, {0, 0, 2}, {0, 0, 3}};
    mesh.corners = {{0, 1, 2}, {1, 3, 2}};
    mesh.normalCorners = {{0, 1, 2}, glm::uvec3(Mesh::kNoIndex)};
    mesh.faces = {7, 8};
    mesh.materials = {1, 0};
    const Mesh out = transformed(mesh, kMirror);
    EXPECT_EQ(out.corners[0], glm::uvec3(0, 2, 1));
    EXPECT_EQ(out.corners[1], glm::uvec3(1, 2, 3));
    EXPECT_EQ(out.normalCorners[0], glm::uvec3(0, 2, 1));
    EXPECT_EQ(out.normalCorners[1], glm::uvec3(Mesh::kNoIndex));
    EXPECT_EQ(out.faces, mesh.faces);
    EXPECT_EQ(out.materials, mesh.materials);
    EXPECT_EQ(out.positions[1], dvec3(-1, 0, 0));
}

TEST(Transform, ExtremeScalesKeepNormals) {
    for (const double scale : {1e-150, 1e150}) {
        const PlaneShape plane =
            transformed(PlaneShape{{0, 0, 0}, {0, 3e-10, 0}}, scaling({scale, scale, -scale}));
        EXPECT_EQ(plane.normal, dvec3(0, 1, 0));
    }
}

TEST(Transform, SpheresTurnMoveAndGrow) {
    const SphereShape sphere =
        transformed(SphereShape{{1, 0, 0}, 2}, then(rotation({0, 0, 1}, 90), scaling(dvec3(-3)))).value();
    EXPECT_EQ(sphere.center, dvec3(0, -3, 0));
    EXPECT_DOUBLE_EQ(sphere.radius, 6);
}

// A disc stays round if it is scaled alike in its plane, with any scale across it.
TEST(Transform, DiscsStayRoundOrAreRefused) {
    const Affine t = then(scaling({-2, 5, 2}), then(rotation({0, 0, 1}, 90), translation({1, 0, 0})));
    const DiscShape disc = transformed(DiscShape{{1, 1, 0}, {0, 3, 0}, 2}, t).value();
    EXPECT_EQ(disc.center, dvec3(-4, -2, 0));  // (1, 1) -> (-2, 5) -> (-5, -2) -> (-4, -2)
    expectNear(disc.normal, {-1, 0, 0}, 1e-15);
    EXPECT_DOUBLE_EQ(disc.radius, 4);
    // Sheared along its plane: the disc only slides.
    Affine slide;
    slide.linear[1] = {0.5, 1, 0.25};  // y -> y (0.5, 1, 0.25)
    EXPECT_DOUBLE_EQ(discFactor({0, 1, 0}, slide.linear).value(), 1);
    for (const dvec3 normal : {dvec3(1, 0, 0), dvec3(0, 0, -1e-9), dvec3(1, 1, 1)})
        EXPECT_FALSE(discFactor(normal, scaling({2, 3, 2}).linear)) << normal.x;
    EXPECT_DOUBLE_EQ(discFactor({0, 1e9, 0}, scaling({1e-150, 1, 1e-150}).linear).value(), 1e-150);
    for (const dvec3 normal : {dvec3(1, 0, 0), dvec3(1, 1, 1), dvec3(-3, 2, 0.1)})
        EXPECT_NEAR(discFactor(normal, scaling(dvec3(3)).linear).value(), 3, 1e-14);
}

TEST(Transform, MirroringReversesOutlines) {
    const PolygonShape square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
    const PolygonShape moved = transformed(square, then(scaling({2, 3, 1}), translation({1, 1, 1})));
    EXPECT_EQ(moved.vertices[2], dvec3(3, 4, 1));
    EXPECT_EQ(polygonPlane(moved.vertices)->normal, dvec3(0, 0, 1));
    const PolygonShape mirrored = transformed(square, kMirror);
    EXPECT_EQ(mirrored.vertices[0], dvec3(0, 0, 0));
    EXPECT_EQ(mirrored.vertices[1], dvec3(0, 1, 0));
    EXPECT_EQ(mirrored.vertices[3], dvec3(-1, 0, 0));
    EXPECT_EQ(polygonPlane(mirrored.vertices)->normal, dvec3(0, 0, 1));
}

TEST(Transform, VertexThatIsNotFiniteStaysSo) {
    Mesh mesh;
    mesh.positions = {{std::nan(""), 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.normals = {{0, 0, 0}};
    mesh.corners = {{0, 1, 2}};
    const Mesh out = transformed(mesh, scaling(dvec3(2)));
    EXPECT_TRUE(std::isnan(out.positions[0].x));
    EXPECT_EQ(out.positions[1], dvec3(2, 0, 0));
    EXPECT_EQ(out.normals[0], dvec3(0));
}

using Value = std::vector<double>;

Keyframes numbers(Interpolation interpolation, Value times, Value values) {
    return {interpolation, false, 1, std::move(times), std::move(values)};
}

TEST(Keyframes, StepLinearAndTheEnds) {
    const Keyframes step = numbers(Interpolation::Step, {1, 2, 4}, {10, 20, -4});
    const Keyframes linear = numbers(Interpolation::Linear, {1, 2, 4}, {10, 20, -4});
    for (const Keyframes& k : {step, linear}) {
        EXPECT_EQ(valueAt(k, -3), Value{10});
        EXPECT_EQ(valueAt(k, 1), Value{10});
        EXPECT_EQ(valueAt(k, 2), Value{20});
        EXPECT_EQ(valueAt(k, 4), Value{-4});
        EXPECT_EQ(valueAt(k, 99), Value{-4});
    }
    EXPECT_EQ(valueAt(step, 1.999), Value{10});
    EXPECT_EQ(valueAt(linear, 1.25), Value{12.5});
    EXPECT_EQ(valueAt(linear, 3), Value{8});
    EXPECT_EQ(valueAt(numbers(Interpolation::Linear, {5}, {7}), 2), Value{7});
}

TEST(Keyframes, EveryComponentByItself) {
    const Keyframes k = {Interpolation::Linear, false, 3, {0, 1}, {0, 1, 2, 4, 5, 10}};
    EXPECT_EQ(valueAt(k, 0.5), (Value{2, 3, 6}));
}

// A cubic polynomial is reproduced from its values and slopes, with segments of any length.
TEST(Keyframes, CubicIsHermites) {
    const auto p = [](double t) { return 2 * t * t * t - 3 * t * t + t - 5; };
    const auto slope = [](double t) { return 6 * t * t - 6 * t + 1; };
    Keyframes k = numbers(Interpolation::Cubic, {-1, 0.5, 3}, {});
    for (const double t : k.times) k.values.insert(k.values.end(), {slope(t), p(t), slope(t)});
    for (double t = -1; t <= 3; t += 0.125) EXPECT_NEAR(valueAt(k, t)[0], p(t), 1e-13) << t;
    EXPECT_EQ(valueAt(k, -2)[0], p(-1));
    EXPECT_EQ(valueAt(k, 5)[0], p(3));
}

// Half way between two turns about one axis is the turn half way, at an even speed, the short way round.
TEST(Keyframes, RotationsGoAlongTheArc) {
    const auto turn = [](double degrees) {
        const double half = degrees * std::acos(-1.0) / 360;
        return Value{0, std::sin(half), 0, std::cos(half)};
    };
    for (const double end : {40.0, 170.0, 1e-6, -120.0}) {
        for (const double sign : {1.0, -1.0}) {
            Keyframes k = {Interpolation::Linear, true, 4, {0, 2}, turn(10)};
            for (const double c : turn(10 + end)) k.values.push_back(3 * sign * c);  // of any length
            for (const double t : {0.0, 0.5, 1.0, 1.7, 2.0}) {
                const Value expected = turn(10 + end * t / 2), got = valueAt(k, t);
                double dot = 0, length = 0;
                for (size_t i = 0; i < 4; ++i) dot += expected[i] * got[i], length += got[i] * got[i];
                EXPECT_NEAR(std::abs(dot), 1, 1e-12) << end << ' ' << t;
                EXPECT_NEAR(length, 1, 1e-12);
            }
        }
    }
}

TEST(Keyframes, CubicRotationsHaveLengthOne) {
    const Keyframes k = {Interpolation::Cubic, true, 4, {0, 1}, {0, 0, 0, 0, 0, 0, 0, 2, 1, 0, 0, 0,
                                                                 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0}};
    for (const double t : {0.0, 0.3, 0.5, 1.0}) {
        double length = 0;
        for (const double c : valueAt(k, t)) length += c * c;
        EXPECT_NEAR(length, 1, 1e-12);
    }
    EXPECT_EQ(valueAt(k, 0), (Value{0, 0, 0, 1}));
}

}  // namespace glint::transform_test
