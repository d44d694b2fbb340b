#include "verify/ceiling.h"

#include <cmath>

namespace glint::verify {

namespace {

// The chance of `count` or less, by its terms; above a mean of a thousand by Wilson's and Hilferty's cube
// root ("The Distribution of Chi-Square", PNAS 17, 1931), good to 1e-3 of the tail there.
double chanceUpTo(uint64_t count, double mean) {
    if (mean <= 0) return 1;
    if (mean > 1000) {
        const double n = static_cast<double>(count) + 1;
        const double z = 3 * std::sqrt(n) * (1 - 1 / (9 * n) - std::cbrt(mean / n));
        return 0.5 * std::erfc(-z / std::sqrt(2.0));
    }
    double term = std::exp(-mean), sum = term;
    for (uint64_t i = 1; i <= count; ++i) {
        term *= mean / static_cast<double>(i);
        sum += term;
    }
    return sum;
}

}  // namespace

double greatestMean(uint64_t count) {
    double low = static_cast<double>(count), high = 2 * low + 20;
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (chanceUpTo(count, middle) > 1 - kConfidence ? low : high) = middle;
    }
    return high;
}

uint64_t greatestCount(double mean) {
    uint64_t low = 0, high = static_cast<uint64_t>(2 * mean) + 40;
    while (low < high) {
        const uint64_t middle = (low + high) / 2;
        if (chanceUpTo(middle, mean) >= kConfidence)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

}  // namespace glint::verify
