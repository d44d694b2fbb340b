// The statistics of `glint report`.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace glint::report {

struct WorkPoint {
    double seconds = 0, error = 0;
};

// Indices of the points that no other point beats: none is at least as quick and at least as exact, and
// better in one of the two. Of equal points the first stays. Ordered by time.
std::vector<size_t> paretoFront(std::span<const WorkPoint> points);

// Least squares through (log x, log y) of the points with x > 0 and y > 0; empty for fewer than two different
// x.
std::optional<double> logSlope(std::span<const double> x, std::span<const double> y);

// t with P(|T| > t) = `tail` for Student's T of `freedom` degrees, 1 and more; tail in (0, 1). G. W. Hill,
// "Algorithm 396: Student's t-quantiles", CACM 13(10), 1970: six digits.
double studentQuantile(double tail, double freedom);

struct Interval {
    double low = 0, high = 0;
};

// Of the ratio a / b of what was measured in pairs, one of each in every turn: the interval about the
// geometric mean of the ratios that holds the expectation with probability 1 - tail, by Student's t on their
// logarithms. From 0 to infinity for fewer than two pairs, or for values that are not positive.
Interval ratioInterval(std::span<const double> a, std::span<const double> b, double tail);

}  // namespace glint::report
