#include "library/certify.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/call_terms.h"
#include "library/status.h"

namespace glint::library {

namespace {

namespace certain = reference::certain;

// What the device's bounds are made for: numbers that are rounded by a part of themselves, and an interval
// that rounding does not close.
bool suitsDevice(const render::RayInput& ray) {
    const glm::vec3 &o = ray.origin, &d = ray.direction;
    // 0 but for what is not finite.
    const float nought = (o.x - o.x) + (o.y - o.y) + (o.z - o.z) + (d.x - d.x) + (d.y - d.y) + (d.z - d.z);
    const float x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
    const float least = 0x1p-90f * std::max(std::max(x, y), z);
    const bool balanced = (x == 0 || x >= least) && (y == 0 || y >= least) && (z == 0 || z >= least);
    return nought == 0 && balanced && ray.tMin < ray.tMax && ray.tMax > 1e-30f &&
           !(ray.tMin > 0 && ray.tMin < 1e-30f);
}

class Run {
  public:
    Run(const Snapshot& snapshot, const RayReader& rays, const HitWriter& hits,
        const CertaintyWriter& certainty, const Callbacks& callbacks)
        : snapshot_(snapshot),
          tracer_(snapshot.certain()),
          rays_(rays),
          hits_(hits),
          certainty_(certainty),
          callbacks_(callbacks) {}

    void onDevice() const {
        render::RayTask task;
        task.count = rays_.count();
        task.ask = render::RayTask::Ask::Certain;
        task.slack = static_cast<float>(2 * tracer_.slack());
        task.boxSlack = static_cast<float>(2 * tracer_.boxSlack());
        task.cancelled = callbacks_.cancelled;
        task.progress = callbacks_.progress;
        task.coherent = rays_.coherent();
        std::atomic<bool> suited = true, rescaled = false;
        task.fill = [&](const render::RayNumbers& numbers, std::span<render::RayInput> inputs) {
            if (rays_.rounded(numbers, inputs)) rescaled.store(true, std::memory_order_relaxed);
            if (!std::all_of(inputs.begin(), inputs.end(), suitsDevice))
                suited.store(false, std::memory_order_relaxed);
        };
        task.take = [&](const render::RayNumbers& numbers, const render::FoundHits& found) {
            hits_.write(numbers, found, rays_, rescaled.load(std::memory_order_relaxed));
            const bool all = suited.load(std::memory_order_relaxed);
            for (size_t i = 0; i < found.size(); ++i) {
                const uint64_t ray = numbers[i];
                const render::FoundHit one = found[i];
                const bool certain =
                    one.certain && (all || suitsDevice(render::roundedRay(rays_.local(ray))));
                certain ? takeCertain(ray, one) : decide(ray, one);
            }
        };
        if (!snapshot_.part().queries->run(task)) throw Cancelled();
    }
    void onHost() const {
        forBlocks(rays_.count(), callbacks_, [&](uint64_t first, uint64_t end) {
            for (uint64_t i = first; i < end; ++i) decide(i, {});
        });
    }

  private:
    // Who is hit is written already, and where to fp32.
    void takeCertain(uint64_t i, const render::FoundHit& found) const {
        certain::Answer answer;
        answer.sure = true;
        answer.lower = answer.upper = std::numeric_limits<double>::infinity();
        if (found.primitive != shared::kNone && certainty_.wantsBounds()) {
            answer = tracer_.at(rays_.world(i), found.primitive, found.instance);
            if (!answer.sure) {  // the device knew more than the host's bounds tell
                decide(i, found);
                return;
            }
            hits_.writePlace(i, answer.hit);
        }
        certainty_.write(i, answer);
    }
    // What is not certain has at least the answer of others.
    void decide(uint64_t i, const render::FoundHit& likely) const {
        certain::Answer answer = tracer_.closest(rays_.world(i), likely.primitive, likely.instance);
        certainty_.write(i, answer);
        const LocalRay local = rays_.local(i);
        if (answer.sure) {
            answer.hit.t = std::scalbn(answer.hit.t, local.exponent);
        } else {
            answer.hit = snapshot_.part().tracer().closest(referenceRay(local)).value_or(reference::Hit{});
        }
        hits_.write(i, local, answer.hit);
    }

    const Snapshot& snapshot_;
    const certain::Tracer& tracer_;
    const RayReader& rays_;
    const HitWriter& hits_;
    const CertaintyWriter& certainty_;
    const Callbacks& callbacks_;
};

}  // namespace

CertaintyWriter::CertaintyWriter(const glint_hits& hits, uint64_t count)
    : sure_(hits.sure, Output::Kind::Flag, 1, count, "hits.sure"),
      lower_(hits.t_lower, Output::Kind::Real, 1, count, "hits.t_lower"),
      upper_(hits.t_upper, Output::Kind::Real, 1, count, "hits.t_upper") {}

void certify(const Snapshot& snapshot, const RayReader& rays, const HitWriter& hits,
             const CertaintyWriter& certainty, const Callbacks& callbacks) {
    const Run run(snapshot, rays, hits, certainty, callbacks);
    if (snapshot.part().queries) {
        run.onDevice();
    } else {
        run.onHost();
    }
}

}  // namespace glint::library
