#include "pack/filter_table.h"

#include <algorithm>
#include <cmath>

#include "shared/layout.h"

namespace glint {

namespace {

// Steps of the sums below: a multiple of 4, so that the zeros of Mitchell's filter lie between two steps.
constexpr int kSteps = 1 << 16;

double mitchell(double x) {
    const double b = 1.0 / 3, c = 1.0 / 3;
    x = std::abs(x);
    if (x >= 2) return 0;
    if (x < 1) return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) / 6;
    return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x + (8 * b + 24 * c)) /
           6;
}

uint32_t fixed(double distance) {
    return static_cast<uint32_t>(
        static_cast<int32_t>(std::lround(std::ldexp(distance, shared::kFilterBits))));
}

// The inverse of the sums of `density`, whose steps fill [-radius, radius]. Where the density is 0 between
// two parts, the sum is the same all along: a cell that ends there ends before the gap, one that begins there
// begins behind it.
std::vector<uint32_t> invert(const std::vector<double>& density, double radius) {
    std::vector<double> sums(density.size() + 1, 0.0);
    for (size_t i = 0; i < density.size(); ++i) sums[i + 1] = sums[i] + density[i];
    const double mass = sums.back(), rounding = 1e-12 * mass;
    const auto place = [&](std::vector<double>::const_iterator end, double wanted) {
        const size_t step =
            std::clamp<size_t>(static_cast<size_t>(end - sums.begin()), 1, density.size()) - 1;
        const double within = std::clamp((wanted - sums[step]) / std::max(density[step], 1e-300), 0.0, 1.0);
        return fixed(radius * (2 * (static_cast<double>(step) + within) / kSteps - 1));
    };
    std::vector<uint32_t> cells;
    cells.reserve(2 * shared::kFilterCells);
    for (uint32_t i = 0; i < shared::kFilterCells; ++i) {
        const double first = mass * i / shared::kFilterCells, last = mass * (i + 1) / shared::kFilterCells;
        cells.push_back(place(std::upper_bound(sums.begin(), sums.end(), first + rounding), first));
        cells.push_back(place(std::lower_bound(sums.begin(), sums.end(), last - rounding), last));
    }
    return cells;
}

}  // namespace

double filterValue(Filter filter, double x, double radius) {
    if (std::abs(x) > radius) return 0;
    const double relative = x / radius;
    switch (filter) {
        case Filter::Box:
            return 1;
        case Filter::Tent:
            return 1 - std::abs(relative);
        case Filter::Gaussian:
            return std::exp(-4.5 * relative * relative) - std::exp(-4.5);
        case Filter::Mitchell:
            return mitchell(2 * relative);
    }
    return 0;
}

FilterParts filterParts(Filter filter, double radius) {
    std::vector<double> positive(kSteps), negative(kSteps);
    double positiveMass = 0, negativeMass = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double value = filterValue(filter, radius * (2 * (i + 0.5) / kSteps - 1), radius);
        positive[i] = std::max(value, 0.0);
        negative[i] = std::max(-value, 0.0);
        positiveMass += positive[i];
        negativeMass += negative[i];
    }
    FilterParts parts;
    const double whole = positiveMass - negativeMass;
    parts.positive = {positiveMass / whole, invert(positive, radius)};
    parts.negative.mass = negativeMass / whole;
    parts.negative.cells.assign(2 * shared::kFilterCells, 0u);
    if (negativeMass > 0) parts.negative.cells = invert(negative, radius);
    return parts;
}

}  // namespace glint
