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
    double sum = 0, squares = 0;
    size_t pixels = 0;
    for (size_t i = 0; i < first.size(); ++i) {
        const glm::dvec3 half = (first[i] - second[i]) / 2.0;
        const double square = glm::dot(half, half) / 3;
        if (!std::isfinite(square)) continue;
        sum += square;
        squares += square * square;
        ++pixels;
    }
    if (pixels == 0) return {};
    // The variance of the sum, sum of E[d^2] - E[d]^2, is below sum of d^2 whatever the pixels'
    // distributions; Satterthwaite's number is 2 (sum of E[d])^2 over it (F. E. Satterthwaite, Biometrics
    // Bulletin 2, 1946).
    // Estimated from few pixels it comes out up to 2 too high: with 1 pixel it is always 2.
    return {sum / static_cast<double>(pixels), squares > 0 ? 2 * sum * sum / squares - 2 : 0, pixels};
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
// false if X <= E^2 / (s q) and Y > E^2 / s. About log-normal, both are likeliest together where s = E^2 /
// sqrt(q), and then each has the probability that a normal variable exceeds log(q) / (2 deviation), while
// that of their ratio exceeding q is of log(q) / (sqrt(2) deviation).
double tailOfClaim(double tail) {
    return std::erfc(normalQuantile(std::sqrt(tail))) / 2;
}

void BoundedMean::add(double x, double tail) {
    // Theorem 2 with c = 1/2: what is bet on this observation depends on earlier ones alone.
    const double before = (0.5 + sum_) / (count_ + 1.0);
    const double variance = squares_ / (count_ + 1.0);
    const double number = count_ + 1.0;
    const double bet =
        std::min(0.5, std::sqrt(2 * std::log(2 / tail) / (variance * number * std::log(1 + number))));
    const double away = 4 * (x - before) * (x - before);
    price_ += away * (-std::log(1 - bet) - bet) / 4;
    bets_ += bet;
    betSum_ += bet * x;
    sum_ += x;
    ++count_;
    const double after = (0.5 + sum_) / (count_ + 1.0);
    squares_ += (x - after) * (x - after);
}

double BoundedMean::halfWidth(double tail) const {
    if (count_ == 0) return 1;
    const double center = betSum_ / bets_;
    const double width = (std::log(2 / tail) + price_) / bets_;
    // The interval is about the mean weighted by bets; what is shown is the plain mean.
    const double low = std::max(center - width, 0.0), high = std::min(center + width, 1.0);
    return std::max(mean() - low, high - mean());
}

}  // namespace glint::converge
