// The statistics of `glint report`.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace glint::app {

struct Quartiles {
    double low = 0, median = 0, high = 0;
};

// By linear interpolation between order statistics (Hyndman, Fan, "Sample Quantiles in Statistical Packages",
// The American Statistician 50(4), 1996, definition 7). All 0 of nothing.
Quartiles quartilesOf(std::vector<double> values);

struct WorkPoint {
    double seconds = 0, error = 0;
};

// Indices of the points that no other point beats: none is at least as quick and at least as exact, and
// better in one of the two. Of equal points the first stays. Ordered by time.
std::vector<size_t> paretoFront(std::span<const WorkPoint> points);

// Least squares through (log x, log y) of the points with x > 0 and y > 0; empty for fewer than two different
// x.
std::optional<double> logSlope(std::span<const double> x, std::span<const double> y);

}  // namespace glint::app
