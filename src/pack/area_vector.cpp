#include "pack/area_vector.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace glint {
namespace {

// Sum of six doubles with one rounding's error, 0 only if the sum is exactly 0. Grow-expansion: J. R.
// Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997,
// theorem 10; TwoSum: D. Knuth, TAOCP vol. 2.
double exactSum(const std::array<double, 6>& terms) {
    std::array<double, 6> parts{};
    size_t count = 0;
    for (double sum : terms) {
        for (size_t i = 0; i < count; ++i) {
            const double a = sum, b = parts[i];
            sum = a + b;
            const double bRounded = sum - a;
            parts[i] = (a - (sum - bRounded)) + (b - bRounded);
        }
        parts[count++] = sum;
    }
    double total = 0;
    for (size_t i = 0; i < count; ++i) total += parts[i];
    return total;
}

// (b-a) x (c-a) of 2-vectors of floats, multiplied out: each product has at most 48 bits and an exponent
// within -298..256, so it is exact in double.
double exactCross(double ax, double ay, double bx, double by, double cx, double cy) {
    return exactSum({bx * cy, -bx * ay, -ax * cy, -by * cx, by * ax, ay * cx});
}

}  // namespace

glm::dvec3 areaVector(const glm::vec3& v0, const glm::vec3& v1, const glm::vec3& v2) {
    const glm::dvec3 a(v0), b(v1), c(v2);
    const glm::dvec3 e1 = b - a, e2 = c - a;
    const glm::dvec3 p(e1.y * e2.z, e1.z * e2.x, e1.x * e2.y);
    const glm::dvec3 q(e1.z * e2.y, e1.x * e2.z, e1.y * e2.x);
    const glm::dvec3 n = p - q;
    const glm::dvec3 terms = glm::abs(p) + glm::abs(q);
    // With u = 2^-53: each edge is off by u, each product by 3u + O(u^2), so n is off by less than 4u (|p| +
    // |q|) + u |n|, which is under 2^-28 max|n| where |p| + |q| <= 2^22 max|n|. Nothing underflows: floats
    // are at least 2^-149.
    const double largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
    if (std::max({terms.x, terms.y, terms.z}) <= 0x1p22 * largest) return n;
    return {exactCross(a.y, a.z, b.y, b.z, c.y, c.z), exactCross(a.z, a.x, b.z, b.x, c.z, c.x),
            exactCross(a.x, a.y, b.x, b.y, c.x, c.y)};
}

}  // namespace glint
