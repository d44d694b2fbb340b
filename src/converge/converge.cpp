#include "converge/converge.h"

#include <algorithm>
#include <cmath>

#include "converge/looks.h"
#include "converge/pixelwise.h"
#include "converge/replicates.h"
#include "core/stopwatch.h"

namespace glint::converge {

namespace {

class RmseLoop {
  public:
    RmseLoop(const Draw& draw, const Job& job) : draw_(draw), job_(job) {}

    Result run() {
        const uint32_t least = leastSamples(job_.image.filter);
        for (uint32_t count = least;; count = std::max(least, both_.looks.next() - both_.first.count())) {
            if (const auto stop = limit(count)) return finished(*stop);
            if (!round(count)) return finished(Stop::Interrupted);
            if (state_.rounds == 1) checkReachable(draw_, job_, state_.budget);
            while (!over() && startedAnew()) {
            }
            if (interrupted_) return finished(Stop::Interrupted);
            if (reached_) return finished(Stop::Reached);
            if (state_.budget.fixed() >= job_.target.error) return finished(Stop::Fixed);
        }
    }

  private:
    bool over() const { return interrupted_ || reached_ || state_.budget.fixed() >= job_.target.error; }

    // Why a round of `count` samples more is not to be begun; shortened to what is left of the samples.
    std::optional<Stop> limit(uint32_t& count) const {
        if (state_.rounds == 0) return std::nullopt;
        const uint32_t left = (job_.target.maxSamples - state_.samplesPerPixel) / both_.mostEach();
        count = std::min(count, left);
        if (count < leastSamples(job_.image.filter)) return Stop::Samples;
        const double each = secondsEach();
        const double time = job_.target.maxSeconds - watch_.seconds();
        if (count * each > time) {
            count = time > 0 ? static_cast<uint32_t>(time / each) : 0;
            if (count < leastSamples(job_.image.filter)) return Stop::Seconds;
        }
        return std::nullopt;
    }

    // For a sample more of either replicate, and of the spots what goes with it.
    double secondsEach() const { return (watch_.seconds() - begun_) / both_.first.count(); }

    // `count` samples more of each replicate, by which a spot's take as many times as planned.
    bool take(Sums& sums, uint32_t count) {
        const Draw counted = [&](const Request& request) {
            Picture picture = draw_(request);
            if (picture.complete) both_.ledger.add(picture, count);
            return picture;
        };
        Request request = job_.request;
        if (state_.rounds > 0) request.data = request.cost = false;
        if (!sums.first.take(counted, request, count)) return false;
        request.data = request.cost = false;
        // A replicate that is ahead of the other would weigh more than what is known of its error.
        if (!sums.second.take(counted, request, count)) return false;
        const Draw apart = [&](const Request& part) {
            Picture picture = draw_(part);
            both_.ledger.addFaults(picture);
            return picture;
        };
        for (Spot& spot : sums.spots) {
            request.region = spot.region;
            for (Replicate& replicate : spot.replicates)
                if (!replicate.take(apart, request, count * sums.plan.times)) return false;
        }
        return true;
    }

    bool round(uint32_t count) {
        if (!take(both_, count)) return false;
        look();
        return true;
    }

    void look() {
        const Region whole = regionOf(job_.request);
        reached_ = both_.look(job_.target, job_.rounding, whole, state_);
        const size_t pixels = static_cast<size_t>(whole.width()) * static_cast<size_t>(whole.height());
        state_.unseen =
            job_.radianceBound * unseenBound(pixels, 2.0 * both_.first.count(), 1 - job_.target.confidence);
        if (job_.report) job_.report(state_);
    }

    // If few pixels have nearly all of the error: draws everything anew, and these by themselves. False if
    // there is nothing to be gained by that, or no time.
    bool startedAnew() {
        const uint32_t count = both_.first.count();
        if (starts_ == kMostStarts || count < kTelling) return false;
        const Region whole = regionOf(job_.request);
        const std::vector<double> squares = both_.squares(whole);
        const double allowed = job_.target.error - state_.budget.fixed();
        // As many samples as what is not seen takes, at least.
        const double samples = std::max<double>(count, both_.looks.next());
        const double most = job_.target.maxSamples / samples;
        const auto plan = spotsFor({whole, squares, allowed, most, both_.plan});
        if (!plan) return false;
        // Spots take about as long again as all the rest.
        if (2 * count * secondsEach() > job_.target.maxSeconds - watch_.seconds()) return false;
        ++starts_;
        const double begun = watch_.seconds();
        Sums sums(job_.image, numbers_, *plan);
        numbers_ += 2 + kMostSpotReplicates;
        if (!take(sums, count)) {
            interrupted_ = true;
            return false;
        }
        begun_ = begun;
        both_.goOnWith(std::move(sums));
        look();
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
        both_.ledger.writeTo(picture);
        both_.writeTo(picture);
        return result;
    }

    // So many samples of a pixel tell where the error is, and so often it is asked.
    static constexpr uint32_t kTelling = 4, kMostStarts = 3;

    const Draw& draw_;
    const Job& job_;
    Replicates both_{job_.image, job_.target};
    bool reached_ = false, interrupted_ = false;
    uint32_t starts_ = 0, numbers_ = 2;
    State state_;
    Stopwatch watch_;
    double begun_ = 0;  // the drawing of these sums, in seconds of watch_
};

}  // namespace

Result converge(const Draw& draw, const Job& job) {
    Job asked = job;
    asked.request.ledger = true;
    return job.target.measure == Measure::Rmse ? RmseLoop(draw, asked).run() : convergePixels(draw, asked);
}

}  // namespace glint::converge
