// Upper bounds of errors from samples: what `--error` promises rests on these few functions.
// docs/design/error-targets.md derives them.
#pragma once

#include <cstddef>
#include <cstdint>
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

// What independent estimates of the same picture say of the error of their mean.
struct MeanSquare {
    double value = 0;     // unbiased estimate of the mean over pixels and channels of (mean - truth)^2
    double freedom = 0;   // degrees of freedom: as many pixels of equal variance would tell as much
    double realized = 0;  // and those of the mean square itself, which more replicates do not add to
    size_t pixels = 0;    // that were finite
};

// Gathers a MeanSquare of pixels that may have different numbers of replicates. Pixels must be independent of
// each other.
class MeanSquareSum {
  public:
    // `square`: unbiased estimate of the mean over channels of (mean - truth)^2 by so many replicates, 2 or
    // more. One that is not finite is left out.
    void add(double square, uint32_t replicates);
    MeanSquare result() const;

  private:
    size_t pixels_ = 0;
    double sum_ = 0, ofEstimate_ = 0, ofError_ = 0, byTwo_ = 0;
};

// `first` and `second`: means of one replicate each, all pixels in the same order. Pixels must be independent
// of each other; channels need not be. A pixel that is not finite in either is left out.
MeanSquare meanSquareOf(std::span<const glm::dvec3> first, std::span<const glm::dvec3> second);

// The realised root mean square is at most this with probability 1 - tail: realised and estimated mean square
// have the same expectation and are independent, each about chi-square of its degrees of freedom, so that
// their ratio is Fisher's. Infinite if the estimate is of too few pixels for any statement.
double rootMeanSquareBound(const MeanSquare& estimate, double tail);

// What a detail of one pixel, no brighter than full scale, may add to the root mean square over the pixels
// though none of `samples` of that pixel hit it: with probability 1 - tail it covers at most 1 -
// tail^(1 / samples) of the pixel. Details in more pixels that come to as much are missed less often.
double unseenBound(size_t pixels, double samples, double tail);

// One error E is given beforehand, and claimed where E^2 is at least the estimate times Fisher's quantile for
// this tail: such a claim is false with probability `tail` at most, whatever the true mean square. It is a
// weaker statement than a bound that names its own number, and so a cheaper one: most where estimate and
// error have as many degrees of freedom, and nothing where the estimate is sure.
double tailOfClaim(double tail, double realized, double freedom);

// A confidence sequence for the mean of independent observations in [0, 1] with one expectation: with
// probability 1 - tail the mean is inside of the interval after every observation at once, so whoever looks
// may stop whenever they like. The predictable plug-in empirical Bernstein sequence of I. Waudby-Smith,
// A. Ramdas, "Estimating means of bounded random variables by betting", JRSS B 86(1), 2024, theorem 2.
class BoundedMean {
  public:
    void add(double x, double tail);  // the same tail each time
    uint32_t count() const { return count_; }
    double mean() const { return count_ > 0 ? sum_ / count_ : 0.5; }
    // How far the expectation may be from mean(); 1 before the first observation.
    double halfWidth(double tail) const;

  private:
    uint32_t count_ = 0;
    double sum_ = 0;
    double squares_ = 0.25;  // 1/4 + sum of (x - running mean)^2, of the running mean after x
    double bets_ = 0, betSum_ = 0, price_ = 0;
};

}  // namespace glint::converge
