#include "pack/area_vector.h"

#include <array>

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

glm::dvec3 exactAreaVector(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return {exactCross(a.y, a.z, b.y, b.z, c.y, c.z), exactCross(a.z, a.x, b.z, b.x, c.z, c.x),
            exactCross(a.x, a.y, b.x, b.y, c.x, c.y)};
}

}  // namespace glint
