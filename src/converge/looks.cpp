#include "converge/looks.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace glint::converge {

namespace {

constexpr double kShownShare = 0.1;  // of the risk, by bounds that end nothing

// Look number k: 1 / (k (k + 1)), which sums to 1 however many there are.
double shownTail(double risk, uint32_t look) {
    return kShownShare * risk / (static_cast<double>(look) * (look + 1));
}

// The chance of paid look k, from 1, is a geometric series of sum 1. The first looks get most, as one of them
// usually ends the image.
constexpr double kFall = 0.4;
double claimTail(double risk, uint32_t paid) {
    return (1 - kShownShare) * risk * (1 - kFall) * std::pow(kFall, std::max(paid, 1u) - 1);
}

// Looks at an estimated mean square above kNear times the allowed one are free, because they cannot claim.
// Looks before the samples have grown by kApart since the last paid one are free too, because most of their
// samples are the same.
constexpr double kNear = 2, kApart = 1.5;

// The error falls by this power of the number of samples, until two looks far enough apart measure the power.
// Box filters measure 0.73 to 0.88, a lens 0.65 (docs/lab/accuracy.md): a little less is a cautious start.
constexpr double kSlope = 0.6, kLeastSlope = 0.5, kMostSlope = 1;
constexpr double kTelling = 1.4;  // growth of the samples between such looks

// 2^k samples of a low-discrepancy sequence have the error of kPowerOfTwo times as many samples of another
// count (docs/lab/error-targets.md). A count within kDetour below a power of two is raised to it.
constexpr double kPowerOfTwo = 1.15, kDetour = 1.06;

double worthOf(uint32_t count) {
    return std::has_single_bit(count) ? kPowerOfTwo * count : count;
}

// The least count after `count` that is worth so much: at least a sixteenth more, and only as far as the
// estimate can be trusted.
uint32_t countWorth(uint32_t count, double worth) {
    const double most = 2.0 * count;
    const double plain = std::clamp(std::ceil(worth), count + std::ceil(count / 16.0), most);
    const auto power = static_cast<double>(std::bit_floor(2 * uint64_t{count}));  // the only one there is
    return static_cast<uint32_t>(worth <= kPowerOfTwo * power && power <= kDetour * plain ? power : plain);
}

}  // namespace

void Looks::learnSlope(uint32_t count, double error) {
    if (lastCount_ == 0) {
        slope_ = kSlope;
    } else if (count >= kTelling * lastCount_ && error > 0 && estimate_ > 0) {
        const double seen = std::log(estimate_ / error) / std::log(worthOf(count) / worthOf(lastCount_));
        slope_ = std::clamp(seen, kLeastSlope, kMostSlope);
    }
    lastCount_ = count;
    estimate_ = error;
}

bool Looks::look(const MeanSquare& estimate, uint32_t count, double allowed) {
    ++looks_;
    learnSlope(count, std::sqrt(estimate.value));
    bound_ = rootMeanSquareBound(estimate, shownTail(risk_, looks_));
    if (estimate.value <= kNear * allowed * allowed && count >= kApart * paidCount_) {
        ++paid_;
        paidCount_ = count;
    }
    const double tail = tailOfClaim(claimTail(risk_, paid_));
    const double claimed = rootMeanSquareBound(estimate, tail);
    // Replicates that agree may both have missed something.
    const double unseen = unseenBound(estimate.pixels, 2.0 * count, risk_);
    const bool holds = allowed > 0 && claimed <= allowed && unseen <= allowed;
    bound_ = std::max(bound_, unseen);
    if (holds) bound_ = std::min(bound_, allowed);
    // A guess that is too low costs a further look, one too high samples.
    const double ratio = allowed > 0 ? claimed / allowed : std::numeric_limits<double>::infinity();
    // The bound on unseen details is about proportional to 1 / samples.
    const double worth = std::max(worthOf(count) * std::pow(ratio, 1 / slope_), count * unseen / allowed);
    next_ = countWorth(count, worth);
    return holds;
}

}  // namespace glint::converge
