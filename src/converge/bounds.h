// Upper bounds of errors from samples: what `--error` promises rests on these few functions.
// docs/design/error-targets.md derives them.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>

namespace glint::converge {

// z with P(Z > z) = `tail` for a standard normal Z; tail in (0, 1).
double normalQuantile(double tail);

// x with P(X > x) = `tail` for Fisher's F with (freedom1, freedom2) degrees of freedom, each positive and not
// necessarily whole: E. Paulson, "An approximate normalization of the analysis of variance distribution",
// Annals of Mathematical Statistics 13, 1942, after Wilson and Hilferty 1931. Infinite where the
// approximation has no quantile (freedom2 below 2, or so small a tail that it leaves its range).
double fisherQuantile(double tail, double freedom1, double freedom2);

// The error of an image that is the mean of two replicates.
struct MeanSquare {
    double value = 0;    // unbiased estimate of the mean over pixels and channels of (image - truth)^2
    double freedom = 0;  // degrees of freedom of that estimate, and of the realised mean square
    size_t pixels = 0;   // that were finite
};

// `first` and `second`: one replicate's means each, with the pixels in the same order. Pixels must be
// independent of each other; channels need not be. Pixels that are not finite are left out.
MeanSquare meanSquareOf(std::span<const glm::dvec3> first, std::span<const glm::dvec3> second);

// The realised root mean square is at most this with probability 1 - tail: realised and estimated mean square
// have the same expectation and are independent, each about chi-square of its degrees of freedom, so that
// their ratio is Fisher's. Infinite if the estimate is of too few pixels for any statement.
double rootMeanSquareBound(const MeanSquare& estimate, double tail);

// Largest contribution of an unseen detail to the root mean square over the pixels. The detail lies in one
// pixel, is at most full scale bright, and is missed by all `samples` of that pixel. With probability 1 -
// tail it covers at most 1 - tail^(1 / samples) of the pixel. Details in more pixels with the same
// contribution are missed less often.
double unseenBound(size_t pixels, double samples, double tail);

// The tail for Fisher's quantile in the claim "the error is at most E". The claim is made if E^2 is at least
// the estimate times the quantile; it is false with probability at most `tail` for any true mean square. E is
// given beforehand, so the claim costs less than a bound that chooses its own number.
double tailOfClaim(double tail);

}  // namespace glint::converge
