// The quartiles of repeated measurements.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace glint {

struct Quartiles {
    double low = 0, median = 0, high = 0;
};

// By linear interpolation between order statistics (Hyndman, Fan, "Sample Quantiles in Statistical Packages",
// The American Statistician 50(4), 1996, definition 7). All 0 without values.
inline Quartiles quartilesOf(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const auto quantile = [&](double share) {
        const double place = share * static_cast<double>(values.size() - 1);
        const auto below = static_cast<size_t>(place);
        const size_t above = std::min(below + 1, values.size() - 1);
        return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
    };
    return {quantile(0.25), quantile(0.5), quantile(0.75)};
}

}  // namespace glint
