#include "library/certify.h"

#include <cmath>

namespace glint::library {

CertaintyWriter::CertaintyWriter(const glint_hits& hits, uint64_t count)
    : sure_(hits.sure, Output::Kind::Flag, 1, count, "hits.sure"),
      lower_(hits.t_lower, Output::Kind::Real, 1, count, "hits.t_lower"),
      upper_(hits.t_upper, Output::Kind::Real, 1, count, "hits.t_upper") {}

void certify(const Snapshot& snapshot, const RayReader& rays, const HitWriter& hits,
             const CertaintyWriter& certainty, const Context& context) {
    const reference::certain::Tracer& tracer = snapshot.certain();
    forBlocks(context, rays.count(), [&](uint64_t first, uint64_t end) {
        for (uint64_t i = first; i < end; ++i) {
            reference::certain::Answer answer = tracer.closest(rays.world(i));
            certainty.write(i, answer);
            const LocalRay local = rays.local(i);
            if (answer.sure) {
                answer.hit.t = std::scalbn(answer.hit.t, local.exponent);
            } else {
                answer.hit = snapshot.part().tracer().closest(referenceRay(local)).value_or(reference::Hit{});
            }
            hits.write(i, local, answer.hit);
        }
    });
}

}  // namespace glint::library
