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

// Indices of the points on the Pareto front, ordered by time: no other point is at least as fast and at least
// as exact, and better in one of the two. Of equal points the first stays.
std::vector<size_t> paretoFront(std::span<const WorkPoint> points);

// Least squares through (log x, log y) of the points with x > 0 and y > 0; empty for fewer than two different
// x.
std::optional<double> logSlope(std::span<const double> x, std::span<const double> y);

}  // namespace glint::report
