#include "converge/converge.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/format.h"
#include "core/stopwatch.h"
#include "pack/pack_samples.h"
#include "pack/request_environment.h"
#include "scene/limits.h"

namespace glint::converge {

namespace {

// The greatest depth that is tried for advice; deeper paths carry light only between lossless mirrors.
constexpr uint32_t kDeepestAdvice = 127;
static_assert(kDeepestAdvice <= kMaxBounces);

constexpr double kAdviceSeconds = 2;

std::string number(double value) {
    return format("%.2g", value);
}

// Finds a depth that leaves out less than `allowed`, by one sample of each pixel.
std::string depthAdvice(const Draw& draw, const Job& job, double allowed) {
    const Stopwatch watch;
    Request request = job.request;
    const uint32_t count = leastSamples(request.filter);
    request.samples = SampleSequence(request).next(count);
    request.data = request.cost = false;
    request.cancelled = [&] {
        return watch.seconds() > kAdviceSeconds || (job.request.cancelled && job.request.cancelled());
    };
    uint32_t depth = job.request.limits.depth.value();
    while (depth < kDeepestAdvice) {
        depth = std::min<uint32_t>(2 * depth + 1, kDeepestAdvice);
        request.limits.depth = depth;
        const Picture picture = draw(request);
        if (!picture.complete) return "maxDepth " + std::to_string(depth) + " takes too long to try";
        Ledger ledger;
        ledger.add(picture, picture.done.size(), count);
        if (ledger.depth() < allowed) return "--max-depth " + std::to_string(depth) + " would do";
    }
    return "no maxDepth up to " + std::to_string(kDeepestAdvice) + " would do";
}

// Half an ulp at 1 of the fp32 that images store.
constexpr double kStored = 0x1p-24;

std::string roundingAdvice(const Job& job, double rounding) {
    if (job.inDouble) return " though computed in double, as pixels are stored as floats";
    const double inDouble = kStored + (rounding - kStored) * 0x1p-29;  // 2^-53 instead of 2^-24
    if (inDouble < job.target.error) return " on this device; --backend cpu computes in double";
    return " on this device, and " + number(inDouble) + " in double precision";
}

// Throws if the fixed parts leave nothing of the target; tries greater depths by `draw` for the advice.
void checkReachable(const Draw& draw, const Job& job, const ErrorBudget& budget) {
    const double wanted = job.target.error;
    if (budget.fixed() < wanted) return;
    const std::string start = "an error of " + number(wanted) + " is out of reach: ";
    if (budget.rounding >= wanted)
        throw Error(ErrorKind::Argument, start + "rounding alone may take " + number(budget.rounding) +
                                             roundingAdvice(job, budget.rounding));
    if (budget.rounding + budget.cut >= wanted)
        throw Error(ErrorKind::Argument, start + "branches that were cut may have added " +
                                             number(budget.cut) + "; use a lower --min-contribution");
    throw Error(ErrorKind::Argument, start + "reflections and refractions beyond maxDepth may add " +
                                         number(budget.depth) + "; " +
                                         depthAdvice(draw, job, wanted / 2 - budget.rounding - budget.cut) +
                                         "; --within-depth counts nothing beyond maxDepth");
}

class Loop {
  public:
    Loop(const Draw& draw, const Job& job) : draw_(draw), job_(job) {
        job_.request.ledger = true;
        progress_ = std::exchange(job_.request.progress, {});  // each batch would count from 0 to 1
    }

    Result run() {
        while (!state_.stop) {
            const uint32_t count = nextCount();
            if (count == 0)
                state_.stop = Stop::Seconds;
            else if (!take(count))
                state_.stop = Stop::Interrupted;
            else
                look();
        }
        return result();
    }

  private:
    // Samples of each replicate in the next round; 0 if no time is left for a round.
    uint32_t nextCount() const {
        const uint32_t least = leastSamples(job_.request.filter);
        uint32_t count = std::max(least, both_.looks.next() - both_.first.count);
        if (state_.rounds == 0) return count;
        count = std::min(count, (job_.target.maxSamples - state_.samplesPerPixel) / 2);
        const double each = watch_.seconds() / both_.first.count;
        const double time = job_.target.maxSeconds - watch_.seconds();
        if (count * each > time) count = time > 0 ? static_cast<uint32_t>(time / each) : 0;
        return count < least ? 0 : count;
    }

    // Takes `count` more samples of both replicates, so that both weigh the same. AOVs come from the first
    // image.
    bool take(uint32_t count) {
        for (int replicate = 0; replicate < 2; ++replicate) {
            Request request = job_.request;
            request.samples = both_.begin(count);
            if (state_.rounds > 0 || replicate > 0) request.data = request.cost = false;
            Picture picture = draw_(request);
            if (!picture.complete) return false;
            both_.add(picture, picture.region);
            both_.end();
            if (data_.empty()) data_ = std::move(picture.data);
        }
        return true;
    }

    void look() {
        both_.look(job_.rounding);
        state_.unseen = job_.radianceBound * unseenBound(both_.first.means.size(), 2.0 * both_.first.count,
                                                         1 - job_.target.confidence);
        report();
        if (state_.rounds == 1) checkReachable(draw_, job_, state_.budget);
    }

    // Work grows with about the error's -5/3rd power. The bound is far from the error at first.
    void report() {
        const double error = state_.estimate > 0 ? state_.estimate : state_.budget.sampling;
        const double left = std::max(error / job_.target.error, 1.0);
        done_ = std::max(done_, std::min(std::pow(left, -5.0 / 3), 0.99));
        if (progress_) progress_(done_);
    }

    Result result() const {
        Result result;
        static_cast<State&>(result) = state_;
        result.picture = blankPicture(job_.request);
        Picture& picture = result.picture;
        picture.complete = state_.rounds > 0;
        if (state_.rounds == 0) return result;
        std::fill(picture.done.begin(), picture.done.end(), uint8_t{1});
        picture.samplesPerPixel = state_.samplesPerPixel;
        picture.data = data_;
        both_.writeTo(picture);
        return result;
    }

    const Draw& draw_;
    Job job_;
    std::function<void(double)> progress_;
    double done_ = 0;
    Replicates both_{job_.request, job_.target};
    State& state_ = both_.state;
    std::vector<PixelData> data_;
    Stopwatch watch_;
};

}  // namespace

Result converge(const Draw& draw, const Job& job) {
    return Loop(draw, job).run();
}

Job jobFor(const PackedScene& packed, const Request& wanted, const Target& target) {
    const uint32_t least = 2 * leastSamples(wanted.filter);
    if (target.maxSamples < least)
        throw Error(ErrorKind::Argument, "an error with this filter needs at least " + std::to_string(least) +
                                             " samples per pixel, and at most " +
                                             std::to_string(target.maxSamples) + " are allowed");
    Job job;
    job.target = target;
    Request& request = job.request = wanted;
    request.adaptive.reset();
    if (request.sampler == Sampler::Grid) request.sampler = Sampler::LowDiscrepancy;
    request.limits.depth = depthOf(packed, request);
    request.ledger = true;
    request.samples = SampleSequence(request).next(leastSamples(request.filter));
    return job;
}

bool missesReflections(const Scene& scene, uint32_t depth) {
    return depth == 0 && std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& m) {
               return m.mirror != Color(0) || m.transmission != Color(0);
           });
}

}  // namespace glint::converge
