#include "converge/bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace glint::converge {

double normalQuantile(double tail) {
    if (!(tail > 0 && tail < 1)) throw std::invalid_argument("a tail lies in (0, 1)");
    // erfc is monotone and good to the last digits in both tails, so halving the interval is enough.
    double low = -40, high = 40;
    for (int i = 0; i < 80; ++i) {
        const double middle = (low + high) / 2;
        (std::erfc(middle / std::sqrt(2.0)) / 2 > tail ? low : high) = middle;
    }
    return (low + high) / 2;
}

double fisherQuantile(double tail, double freedom1, double freedom2) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    if (!(freedom1 > 0) || !(freedom2 >= 2)) return kNone;
    const double z = normalQuantile(tail);
    const double a = 2 / (9 * freedom1), b = 2 / (9 * freedom2);
    const double divisor = (1 - b) * (1 - b) - z * z * b;
    if (!(divisor > 0)) return kNone;
    const double root = (1 - b) * (1 - b) * a + (1 - a) * (1 - a) * b - z * z * a * b;
    const double cubeRoot = ((1 - a) * (1 - b) + z * std::sqrt(std::max(root, 0.0))) / divisor;
    return cubeRoot * cubeRoot * cubeRoot;
}

MeanSquare meanSquareOf(std::span<const glm::dvec3> first, std::span<const glm::dvec3> second) {
    MeanSquare mean;
    double sum = 0, squares = 0;
    for (size_t i = 0; i < first.size(); ++i) {
        const glm::dvec3 half = (first[i] - second[i]) / 2.0;
        const double square = glm::dot(half, half) / 3;
        if (!std::isfinite(square)) continue;
        sum += square;
        squares += square * square;
        ++mean.pixels;
    }
    if (mean.pixels == 0) return mean;
    mean.value = sum / static_cast<double>(mean.pixels);
    // Satterthwaite's number is 2 (sum of E[d])^2 over the variance of the sum (F. E. Satterthwaite,
    // Biometrics Bulletin 2, 1946). The second moment bounds the variance of d for any distribution. From few
    // pixels the number comes out up to 2 too high: from 1 pixel it is always 2.
    if (squares > 0) mean.freedom = 2 * sum * sum / squares - 2;
    return mean;
}

double rootMeanSquareBound(const MeanSquare& estimate, double tail) {
    if (estimate.value == 0) return 0;
    return std::sqrt(estimate.value * fisherQuantile(tail, estimate.freedom, estimate.freedom));
}

double unseenBound(size_t pixels, double samples, double tail) {
    if (pixels == 0) return 0;
    return -std::expm1(std::log(tail) / samples) / std::sqrt(static_cast<double>(pixels));
}

// With mean square s, estimate s X and realised s Y, X and Y independent and alike, the claim is made and
// false if X <= E^2 / (s q) and Y > E^2 / s. Both are likeliest together at s = E^2 / sqrt(q), where each is
// off by the root of q alone.
double tailOfClaim(double tail) {
    return std::erfc(normalQuantile(std::sqrt(tail))) / 2;
}

}  // namespace glint::converge
