#include "library/certify.h"

#include <cmath>

#include "core/call_terms.h"
#include "library/status.h"

namespace glint::library {

namespace {

namespace certain = reference::certain;

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

    void all() const {
        forBlocks(rays_.count(), callbacks_, [&](uint64_t first, uint64_t end) {
            for (uint64_t i = first; i < end; ++i) decide(i);
        });
    }

  private:
    // If the hit cannot be certified, the ordinary query answers.
    void decide(uint64_t i) const {
        certain::Answer answer = tracer_.closest(rays_.world(i));
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
    Run(snapshot, rays, hits, certainty, callbacks).all();
}

}  // namespace glint::library
