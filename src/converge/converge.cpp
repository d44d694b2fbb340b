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
            if (job_.report) job_.report(state_);
            if (reached_) return finished(Stop::Reached);
            if (state_.budget.fixed() >= job_.target.error) return finished(Stop::Fixed);
        }
    }

  private:
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
            if (picture.complete) both_.ledger.add(picture, count);
            return picture;
        };
        Request request = job_.request;
        if (state_.rounds > 0) request.data = request.cost = false;
        const bool whole = both_.first.take(counted, request, count);
        request.data = request.cost = false;
        // A replicate that is ahead of the other would weigh more than what is known of its error.
        if (!whole || !both_.second.take(counted, request, count)) return false;
        reached_ = both_.look(job_.target, job_.rounding, state_);
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
        picture.samples.assign(picture.done.size(), state_.samplesPerPixel);
        picture.errors.resize(picture.done.size());
        for (size_t i = 0; i < picture.done.size(); ++i) {
            // Interrupted between the replicates, the second is behind; the first's sums went on.
            const glm::dvec3 a = both_.first.means()[i], b = both_.second.means()[i];
            float* pixel = &picture.color.pixels[i * 4];
            for (int c = 0; c < 3; ++c) pixel[c] = static_cast<float>((a[c] + b[c]) / 2);
            pixel[3] = static_cast<float>((both_.first.alphas()[i] + both_.second.alphas()[i]) / 2);
            const glm::dvec3 half = glm::abs(a - b) / 2.0;
            picture.errors[i] = static_cast<float>(std::max({half.x, half.y, half.z}));
        }
        return result;
    }

    const Draw& draw_;
    const Job& job_;
    Replicates both_{job_.image, job_.target};
    bool reached_ = false;
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
