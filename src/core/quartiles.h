// The quartiles of what was measured several times.
#pragma once

#include <vector>

namespace glint {

struct Quartiles {
    double low = 0, median = 0, high = 0;
};

// By linear interpolation between order statistics (Hyndman, Fan, "Sample Quantiles in Statistical Packages",
// The American Statistician 50(4), 1996, definition 7). All 0 of nothing.
Quartiles quartilesOf(std::vector<double> values);

}  // namespace glint
