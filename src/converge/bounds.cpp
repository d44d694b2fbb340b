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

void MeanSquareSum::add(double square, uint32_t replicates) {
    if (!std::isfinite(square)) return;
    // With d the estimate by R replicates, of normal samples, E[d^2] = (R + 1) / (R - 1) E[d]^2, so that its
    // variance, 2 / (R - 1) E[d]^2, is 2 / (R + 1) of the second moment, and the variance of (mean - truth)^2
    // R - 1 times as much. With two the whole second moment is taken, which is no less than the variance
    // whatever the distribution; with more twice what normal samples need, as pixels of which few samples see
    // something are skew: those that saw less err more than their replicates show.
    const double r = replicates;
    const double variance = (replicates == 2 ? 3 : 4) / (r + 1) * square * square;
    sum_ += square;
    ofEstimate_ += variance;
    ofError_ += (r - 1) * variance;
    if (replicates == 2) byTwo_ += variance;
    ++pixels_;
}

MeanSquare MeanSquareSum::result() const {
    if (pixels_ == 0) return {};
    const double value = sum_ / static_cast<double>(pixels_);
    if (ofEstimate_ == 0) return {value, 0, 0, pixels_};
    // Satterthwaite's number is 2 (sum of E[d])^2 over the variance of the sum (F. E. Satterthwaite,
    // Biometrics Bulletin 2, 1946). Estimated from few pixels by two replicates it comes out up to 2 too
    // high: with 1 pixel it is always 2.
    const double tooHigh = 2 * byTwo_ / ofEstimate_;
    return {value, 2 * sum_ * sum_ / ofEstimate_ - tooHigh, 2 * sum_ * sum_ / ofError_ - tooHigh, pixels_};
}

MeanSquare meanSquareOf(std::span<const glm::dvec3> first, std::span<const glm::dvec3> second) {
    MeanSquareSum sum;
    for (size_t i = 0; i < first.size(); ++i) {
        const glm::dvec3 half = (first[i] - second[i]) / 2.0;
        sum.add(glm::dot(half, half) / 3, 2);
    }
    return sum.result();
}

double rootMeanSquareBound(const MeanSquare& estimate, double tail) {
    if (estimate.value == 0) return 0;
    return std::sqrt(estimate.value * fisherQuantile(tail, estimate.realized, estimate.freedom));
}

double unseenBound(size_t pixels, double samples, double tail) {
    if (pixels == 0) return 0;
    return -std::expm1(std::log(tail) / samples) / std::sqrt(static_cast<double>(pixels));
}

// With mean square s, estimate s X and realised s Y, X and Y independent, the claim is made and false if X <=
// E^2 / (s q) and Y > E^2 / s. About log-normal with variances in proportion to 1 / freedom, both are
// likeliest together at some s; the quantile is such that they then have the probability `tail`.
double tailOfClaim(double tail, double realized, double freedom) {
    const auto above = [](double z) { return std::erfc(z / std::sqrt(2.0)) / 2; };
    // As many of either: each is then off by the root of q alone.
    if (realized == freedom) return std::erfc(normalQuantile(std::sqrt(tail))) / 2;
    if (!(realized > 0 && freedom > 0)) return tail;
    const double ofError = std::sqrt(freedom / (realized + freedom)),
                 ofEstimate = std::sqrt(1 - ofError * ofError);
    const auto likeliest = [&](double z) {
        double most = 0;
        for (int i = 0; i <= 200; ++i) {
            const double part = z * i / 100 - z / 2;  // of log q that the error is off by
            most = std::max(most, above(part / ofError) * above((z - part) / ofEstimate));
        }
        return most;
    };
    double low = 0, high = normalQuantile(tail);
    for (int i = 0; i < 40; ++i) {
        const double middle = (low + high) / 2;
        (likeliest(middle) > tail ? low : high) = middle;
    }
    return above(high);
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
