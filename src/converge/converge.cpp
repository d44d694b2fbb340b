#include "converge/converge.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "converge/replicates.h"
#include "core/stopwatch.h"
#include "pack/pack_samples.h"
#include "pack/request_environment.h"

namespace glint::converge {

namespace {

class Loop {
  public:
    Loop(const Draw& draw, const Job& job) : draw_(draw), job_(job) {
        job_.request.ledger = true;
        progress_ = std::exchange(job_.request.progress, {});  // each batch would count from 0 to 1
    }

    Result run() {
        const uint32_t least = leastSamples(job_.request.image.filter);
        for (uint32_t count = least;; count = std::max(least, both_.looks.next() - both_.first.count())) {
            if (const auto stop = limit(count)) return finished(*stop);
            if (!take(count)) return finished(Stop::Interrupted);
            const bool reached = look();
            if (state_.rounds == 1) checkReachable(draw_, job_, state_.budget);
            if (reached) return finished(Stop::Reached);
            if (state_.budget.fixed() >= job_.target.error) return finished(Stop::Fixed);
        }
    }

  private:
    // The reason not to begin a round of `count` more samples; reduces `count` to the samples that are left.
    std::optional<Stop> limit(uint32_t& count) const {
        if (state_.rounds == 0) return std::nullopt;
        const uint32_t least = leastSamples(job_.request.image.filter);
        count = std::min(count, (job_.target.maxSamples - state_.samplesPerPixel) / 2);
        if (count < least) return Stop::Samples;
        const double each = watch_.seconds() / both_.first.count();
        const double time = job_.target.maxSeconds - watch_.seconds();
        if (count * each > time) {
            count = time > 0 ? static_cast<uint32_t>(time / each) : 0;
            if (count < least) return Stop::Seconds;
        }
        return std::nullopt;
    }

    // Takes `count` more samples of both replicates, so that both weigh the same. AOVs come from the first
    // image.
    bool take(uint32_t count) {
        const Draw counted = [&](const Request& request) {
            Picture picture = draw_(request);
            if (picture.complete) both_.ledger.add(picture, count);
            return picture;
        };
        Request request = job_.request;
        if (state_.rounds > 0) request.data = request.cost = false;
        if (!both_.first.take(counted, request, count)) return false;
        request.data = request.cost = false;
        return both_.second.take(counted, request, count);
    }

    bool look() {
        const bool reached = both_.look(job_.target, job_.rounding, state_);
        state_.unseen =
            job_.radianceBound *
            unseenBound(both_.first.means().size(), 2.0 * both_.first.count(), 1 - job_.target.confidence);
        report();
        return reached;
    }

    // Work grows with about the error's -5/3rd power. The bound is far from the error at first.
    void report() {
        const double error = state_.estimate > 0 ? state_.estimate : state_.budget.sampling;
        const double left = std::max(error / job_.target.error, 1.0);
        done_ = std::max(done_, std::min(std::pow(left, -5.0 / 3), 0.99));
        if (progress_) progress_(done_);
    }

    Result finished(Stop stop) const {
        Result result;
        static_cast<State&>(result) = state_;
        result.stop = stop;
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

    const Draw& draw_;
    Job job_;
    std::function<void(double)> progress_;
    double done_ = 0;
    Replicates both_{job_.request.image, job_.target};
    State state_;
    Stopwatch watch_;
};

}  // namespace

Result converge(const Draw& draw, const Job& job) {
    return Loop(draw, job).run();
}

Job jobFor(const PackedScene& packed, const Request& wanted, const Target& target) {
    Job job;
    job.target = target;
    Request& request = job.request = wanted;
    request.image.adaptive.reset();
    if (request.image.sampler == Sampler::Grid) request.image.sampler = Sampler::LowDiscrepancy;
    request.limits.depth = depthOf(packed, request);
    request.ledger = true;
    request.samples = SampleSequence(request.image).next(leastSamples(request.image.filter));
    return job;
}

bool missesReflections(const Scene& scene, uint32_t depth) {
    return depth == 0 && std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& m) {
               return m.mirror != Color(0) || m.transmission != Color(0);
           });
}

}  // namespace glint::converge
