#include "converge/converge.h"

#include <algorithm>
#include <cmath>

#include "converge/bounds.h"
#include "converge/pixelwise.h"
#include "converge/replicates.h"
#include "core/stopwatch.h"

namespace glint::converge {

namespace {

// Looking at the bound after each round and stopping when it is low enough is looking often: round k spends
// 1 / (k (k + 1)) of what the statement may err, which sums to 1 however many there are.
double tailOf(const Target& target, uint32_t round) {
    return (1 - target.confidence) / (static_cast<double>(round) * (round + 1));
}

// The error falls with the samples' -0.6th power or faster in most scenes (docs/lab/accuracy.md). The guess
// is only how far the next round goes; a guess that is too low costs a further round, one too high samples.
constexpr double kSlope = 0.6;

uint32_t nextCount(uint32_t taken, double sampling, double wanted) {
    const double guess = taken * std::pow(sampling / wanted, 1 / kSlope);
    const double most = 2.0 * taken;  // no further than the estimate can be trusted
    return static_cast<uint32_t>(std::clamp(std::ceil(std::min(guess, most)) - taken, std::ceil(taken / 16.0),
                                            static_cast<double>(taken)));
}

class RmseLoop {
  public:
    RmseLoop(const Draw& draw, const Job& job) : draw_(draw), job_(job) {}

    Result run() {
        const uint32_t least = leastSamples(job_.image.filter);
        for (uint32_t count = least;; count = std::max(least, wanted())) {
            if (const auto stop = limit(count)) return finished(*stop);
            if (!round(count)) return finished(Stop::Interrupted);
            if (state_.rounds == 1) checkReachable(draw_, job_, state_.budget);
            if (job_.report) job_.report(state_);
            if (state_.budget.total() <= job_.target.error) return finished(Stop::Reached);
            if (state_.budget.fixed() >= job_.target.error) return finished(Stop::Fixed);
        }
    }

  private:
    uint32_t wanted() const {
        return nextCount(first_.count(), state_.budget.sampling, job_.target.error - state_.budget.fixed());
    }

    // Why a round of `count` samples more is not to be begun; shortened to what is left of the samples.
    std::optional<Stop> limit(uint32_t& count) const {
        if (state_.rounds == 0) return std::nullopt;
        const uint32_t left = (job_.target.maxSamples - state_.samplesPerPixel) / 2;
        count = std::min(count, left);
        if (count < leastSamples(job_.image.filter)) return Stop::Samples;
        const double each = watch_.seconds() / state_.samplesPerPixel;
        const double time = job_.target.maxSeconds - watch_.seconds();
        if (2 * count * each > time) {
            count = time > 0 ? static_cast<uint32_t>(time / (2 * each)) : 0;
            if (count < leastSamples(job_.image.filter)) return Stop::Seconds;
        }
        return std::nullopt;
    }

    bool round(uint32_t count) {
        const Draw counted = [&](const Request& request) {
            Picture picture = draw_(request);
            if (picture.complete) ledger_.add(picture, count);
            return picture;
        };
        Request request = job_.request;
        if (state_.rounds > 0) request.data = request.cost = false;
        const bool whole = first_.take(counted, request, count);
        request.data = request.cost = false;
        // A replicate that is ahead of the other would weigh more than what is known of its error.
        if (!whole || !second_.take(counted, request, count)) return false;
        ++state_.rounds;
        state_.samplesPerPixel = 2 * first_.count();
        state_.budget.rounding = job_.rounding;
        state_.budget.depthCounts = job_.target.depthCounts;
        ledger_.writeTo(state_.budget, Measure::Rmse);
        state_.budget.sampling = rootMeanSquareBound(meanSquareOf(first_.means(), second_.means()),
                                                     tailOf(job_.target, state_.rounds));
        return true;
    }

    Result finished(Stop stop) const {
        Result result;
        static_cast<State&>(result) = state_;
        result.stop = stop;
        result.unsettled = stop == Stop::Reached ? 0 : 1;
        result.picture = blankPicture(job_.request);
        Picture& picture = result.picture;
        picture.complete = state_.rounds > 0;
        if (state_.rounds == 0) return result;
        std::fill(picture.done.begin(), picture.done.end(), uint8_t{1});
        picture.samplesPerPixel = state_.samplesPerPixel;
        ledger_.writeTo(picture);
        picture.samples.assign(picture.done.size(), state_.samplesPerPixel);
        picture.errors.resize(picture.done.size());
        for (size_t i = 0; i < picture.done.size(); ++i) {
            // Interrupted between the replicates, the second is behind; the first's sums went on.
            const glm::dvec3 a = first_.means()[i], b = second_.means()[i];
            float* pixel = &picture.color.pixels[i * 4];
            for (int c = 0; c < 3; ++c) pixel[c] = static_cast<float>((a[c] + b[c]) / 2);
            pixel[3] = static_cast<float>((first_.alphas()[i] + second_.alphas()[i]) / 2);
            const glm::dvec3 half = glm::abs(a - b) / 2.0;
            picture.errors[i] = static_cast<float>(std::max({half.x, half.y, half.z}));
        }
        return result;
    }

    const Draw& draw_;
    const Job& job_;
    Replicate first_{job_.image, 0}, second_{job_.image, 1};
    Ledger ledger_;
    State state_;
    Stopwatch watch_;
};

}  // namespace

Result converge(const Draw& draw, const Job& job) {
    Job asked = job;
    asked.request.ledger = true;
    return job.target.measure == Measure::Rmse ? RmseLoop(draw, asked).run() : convergePixels(draw, asked);
}

}  // namespace glint::converge
