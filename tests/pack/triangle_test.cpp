// Areas and parts of triangles.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "pack/area_vector.h"
#include "pack/build_tree.h"
#include "pack/packed_scene.h"
#include "pack/presplit.h"
#include "support/scene_maker.h"

namespace glint::triangle_test {

constexpr float kUlp = std::numeric_limits<float>::epsilon();

TEST(AreaVector, RightTriangle) {
    EXPECT_EQ(areaVector({0, 0, 0}, {2, 0, 0}, {0, 3, 0}), glm::dvec3(0, 0, 6));
    EXPECT_EQ(areaVector({0, 0, 0}, {0, 3, 0}, {2, 0, 0}), glm::dvec3(0, 0, -6));
    EXPECT_EQ(areaVector({1, 1, 1}, {1, 2, 1}, {1, 1, 2}), glm::dvec3(1, 0, 0));
}

TEST(AreaVector, NoAreaIsExactlyZero) {
    EXPECT_EQ(areaVector({0, 0, 0}, {1, 0, 0}, {2, 0, 0}), glm::dvec3(0));           // T27
    EXPECT_EQ(areaVector({1.1f, 2, 3}, {1.1f, 2, 3}, {1.1f, 2, 3}), glm::dvec3(0));  // T28
    EXPECT_EQ(areaVector({1, 2, 3}, {1, 2, 3}, {4, 5, 6}), glm::dvec3(0));
    // T26, pbrt's BadCases: vertical, x and z the same throughout.
    const float x = -1113.45459f, z = -56.2431908f;
    EXPECT_EQ(areaVector({x, -79.049614f, z}, {x, -87.0922699f, z}, {x, -79.2090149f, z}), glm::dvec3(0));
}

// p + k d for integers k: collinear, with all coordinates exact in fp32.
TEST(AreaVector, CollinearOnIntegerLattice) {
    std::mt19937 random(1);
    std::uniform_int_distribution<int> coordinate(-1000, 1000);
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 p(coordinate(random), coordinate(random), coordinate(random));
        const glm::vec3 d(coordinate(random), coordinate(random), coordinate(random));
        const float k = static_cast<float>(coordinate(random));
        EXPECT_EQ(areaVector(p, p + d, p + k * d), glm::dvec3(0));
    }
}

// Coordinates of so different sizes that even edges round in double, on one line: y = x, with 2^40 and 2^-40.
TEST(AreaVector, CollinearOverEightyBits) {
    const float big = std::ldexp(1.0f, 40), small = std::ldexp(1.0f, -40);
    EXPECT_EQ(areaVector({small, small, 0}, {big, big, 0}, {3, 3, 0}), glm::dvec3(0));
    // Off the line, a = (s, 2s), b = (B, B), c = (3, 3): (B - s)(3 - 2s) - (B - 2s)(3 - s) = 3s - Bs, and Bs
    // = 1.
    const glm::dvec3 n = areaVector({small, 2 * small, 0}, {big, big, 0}, {3, 3, 0});
    EXPECT_EQ(n.x, 0);
    EXPECT_EQ(n.y, 0);
    EXPECT_DOUBLE_EQ(n.z, 3.0 * small - 1.0);
}

// A needle one ulp high far from the axes: base b - a = (1, 1, 1), apex an ulp of z off the middle.
TEST(AreaVector, ThinnestNeedleHasItsNormal) {
    const glm::vec3 a(1, 1, 1), b(2, 2, 2), c(1.5f, 1.5f, 1.5f + kUlp);
    // (1,1,1) x (0.5, 0.5, 0.5 + e) = (e, -e, 0)
    EXPECT_EQ(areaVector(a, b, c), glm::dvec3(kUlp, -kUlp, 0));
}

// Truth in int64, for slivers: apex within a few units of the base's middle.
TEST(AreaVector, NeedlesAgreeWithIntegers) {
    std::mt19937 random(2);
    std::uniform_int_distribution<int64_t> large(-(1 << 23), 1 << 23), tiny(-2, 2);
    for (int i = 0; i < 2000; ++i) {
        const int64_t ax = large(random), ay = large(random), bx = large(random), by = large(random);
        // Near the middle of ab, a few units off.
        const int64_t cx = (ax + bx) / 2 + tiny(random), cy = (ay + by) / 2 + tiny(random);
        const int64_t area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
        const auto f = [](int64_t v) { return static_cast<float>(v); };
        const glm::dvec3 n = areaVector({f(ax), f(ay), 0}, {f(bx), f(by), 0}, {f(cx), f(cy), 0});
        EXPECT_EQ(n, glm::dvec3(0, 0, static_cast<double>(area)));
    }
}

TEST(AreaVector, EndsOfTheRange) {
    const float least = std::numeric_limits<float>::denorm_min(), most = std::numeric_limits<float>::max();
    const double l = least, m = most;
    EXPECT_EQ(areaVector({0, 0, 0}, {least, 0, 0}, {0, least, 0}), glm::dvec3(0, 0, l * l));
    EXPECT_EQ(areaVector({-most, 0, 0}, {most, 0, 0}, {-most, most, 0}), glm::dvec3(0, 0, 2 * m * m));
}

// Triangles cut into boxes, which hold the triangle and are smaller where its own box was mostly empty.

using namespace test;

const Box kRoot{glm::vec3(-10), glm::vec3(10)};

class SplitTriangle : public testing::Test {
  protected:
    glm::vec3 point() {
        std::uniform_real_distribution<float> place(-9, 9);
        const float x = place(random_), y = place(random_), z = place(random_);
        return {x, y, z};
    }
    // A point of the triangle, in double.
    glm::dvec3 within(const Corners& c) {
        std::uniform_real_distribution<double> unit(0, 1);
        double u = unit(random_), v = unit(random_);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        return (1 - u - v) * glm::dvec3(c[0]) + u * glm::dvec3(c[1]) + v * glm::dvec3(c[2]);
    }
    static bool holds(const Box& box, const glm::dvec3& p) {
        for (int i = 0; i < 3; ++i)
            if (p[i] < box.lo[i] || p[i] > box.hi[i]) return false;
        return true;
    }
    std::mt19937 random_{7};
};

TEST_F(SplitTriangle, PartsHoldEveryPoint) {
    for (int k = 0; k < 400; ++k) {
        const Corners corners = {point(), point(), point()};
        const uint32_t parts = 1 + static_cast<uint32_t>(k % 17);
        const std::vector<Box> boxes = splitTriangle(corners, kRoot, parts);
        ASSERT_GE(boxes.size(), 1u);
        ASSERT_LE(boxes.size(), parts);
        for (int i = 0; i < 200; ++i) {
            const glm::dvec3 p = within(corners);
            EXPECT_TRUE(std::any_of(boxes.begin(), boxes.end(), [&](const Box& b) { return holds(b, p); }));
        }
    }
}

// The diagonal needle of a cube: its box is the cube, that of n parts along it n cubes of 1/n the edge.
TEST_F(SplitTriangle, DiagonalNeedle) {
    const Corners needle = {glm::vec3(-8), glm::vec3(8), glm::vec3(8, 8, 7.999f)};
    const std::vector<Box> boxes = splitTriangle(needle, {glm::vec3(-8), glm::vec3(8)}, 16);
    ASSERT_EQ(boxes.size(), 16u);
    double sum = 0;
    for (const Box& box : boxes) sum += box.halfArea();
    const double whole = 3 * 16.0 * 16;
    EXPECT_NEAR(sum, whole / 16, 0.01 * whole / 16);
}

// What the device may take for the triangle reaches 16 u of its size beyond it, and so do the parts.
TEST_F(SplitTriangle, PartsReachBeyondTheTriangle) {
    const Corners corners = {glm::vec3(-8), glm::vec3(8), glm::vec3(8, 8, -8)};
    Box all;
    for (const Box& box : splitTriangle(corners, kRoot, 8)) all.include(box);
    EXPECT_EQ(all.lo, glm::vec3(-8 - 0x1p-16f));
    EXPECT_EQ(all.hi, glm::vec3(8 + 0x1p-16f));
}

TEST_F(SplitTriangle, FlatOnesStayWhole) {
    const Corners point = {glm::vec3(1), glm::vec3(1), glm::vec3(1)};
    EXPECT_EQ(splitTriangle(point, kRoot, 8).size(), 1u);
}

// Slanting beams, as long as the scene and thin.
Scene beams() {
    Scene scene;
    std::mt19937 random(2);
    std::uniform_real_distribution<double> place(-5, 5);
    for (int i = 0; i < 200; ++i) {
        const double x = place(random), y = place(random);
        const glm::dvec3 a(x - 4, y - 4, -5), b(x + 4, y + 4, 5), side(0.02, -0.02, 0);
        addObject(scene, TriangleShape{{a, b, b + side}});
        addObject(scene, TriangleShape{{a, b + side, a + side}});
    }
    return scene;
}

TEST(BuildTree, SplitsBeams) {
    const PackedScene fast = packScene(beams(), {BuildQuality::Fast});
    EXPECT_EQ(fast.statistics.splitTriangles, 0u);
    EXPECT_EQ(fast.triangles.size(), 400u);
    for (const BuildQuality quality : {BuildQuality::Default, BuildQuality::High}) {
        const PackedScene split = packScene(beams(), {quality});
        EXPECT_GT(split.statistics.splitTriangles, 300u);
        EXPECT_LE(split.statistics.splitTriangles, 400u);
        EXPECT_EQ(split.triangles.size(), 400u + split.statistics.splitTriangles);
        EXPECT_LT(split.statistics.sahCost, 0.6 * fast.statistics.sahCost);
    }
}

TEST(BuildTree, LeavesEvenMeshesWhole) {
    Scene scene;
    addObject(scene, MeshShape{gridMesh(32)});
    for (const BuildQuality quality : {BuildQuality::Default, BuildQuality::High}) {
        const PackedScene packed = packScene(scene, {quality});
        EXPECT_EQ(packed.statistics.splitTriangles, 0u);
        EXPECT_EQ(packed.triangles.size(), 2u * 32 * 32);
    }
}

// Whatever is done, better quality is not a dearer tree.
TEST(BuildTree, QualityNeverCostsMore) {
    for (const Scene& scene : {beams(), [] {
                                   Scene s;
                                   addObject(s, MeshShape{gridMesh(16)});
                                   return s;
                               }()}) {
        const double fast = packScene(scene, {BuildQuality::Fast}).statistics.sahCost;
        const double normal = packScene(scene).statistics.sahCost;
        const double high = packScene(scene, {BuildQuality::High}).statistics.sahCost;
        EXPECT_LE(normal, fast);
        EXPECT_LE(high, normal);
    }
}

}  // namespace glint::triangle_test
