// How many pixels may hang on rounding: limits from counts, with a stated confidence.
#pragma once

#include <cstdint>

namespace glint::verify {

inline constexpr double kConfidence = 0.999;  // of each limit

// The greatest mean of a Poisson variable that gives `count` or less with a chance of 1 - kConfidence: an
// upper limit on the mean that was counted (F. Garwood, "Fiducial Limits for the Poisson Distribution",
// Biometrika 28, 1936). A binomial count scatters less.
double greatestMean(uint64_t count);

// The least number that a Poisson variable of this mean exceeds with a chance of no more than 1 -
// kConfidence.
uint64_t greatestCount(double mean);

}  // namespace glint::verify
