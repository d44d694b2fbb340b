#include "pack/area_vector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace glint::area_vector_test {
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

// Coordinates of such different sizes that even edges round in double, on one line: y = x, with 2^40 and
// 2^-40.
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

// A needle one ulp high far from the axes: base b - a = (1, 1, 1), apex raised by one ulp of z off the
// middle.
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

}  // namespace glint::area_vector_test
