// Decides when an image of two replicates has reached its error target, and when to look next.
#pragma once

#include <cstdint>
#include <limits>

#include "converge/bounds.h"

namespace glint::converge {

// The target's chance of error is spent in two ways: nine tenths for claims that the error is at most the
// target, which end the image, and one tenth for the bounds that are shown meanwhile. A false claim needs a
// mean square close to the target's, so only looks near it are paid for. docs/design/error-targets.md gives
// the reasons and what trials decide.
class Looks {
  public:
    explicit Looks(double confidence) : risk_(1 - confidence) {}

    // Examines the replicates, each with `count` samples. `allowed`: part of the target that is left for
    // sampling. True if the claim may be made that the sampling error is at most `allowed`.
    bool look(const MeanSquare& estimate, uint32_t count, double allowed);

    // An upper bound of the sampling error at the last look; with the confidence for all looks together.
    double bound() const { return bound_; }
    // The sampling error as the last look estimates it: no bound.
    double estimate() const { return estimate_; }
    uint32_t looks() const { return looks_; }
    // How many samples of each replicate the next look is worth.
    uint32_t next() const { return next_; }

  private:
    void learnSlope(uint32_t count, double error);

    double risk_;
    uint32_t looks_ = 0, paid_ = 0;
    uint32_t paidCount_ = 0, lastCount_ = 0, next_ = 1;
    double bound_ = std::numeric_limits<double>::infinity(), estimate_ = bound_, slope_ = 0;
};

}  // namespace glint::converge
