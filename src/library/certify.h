// Certified closest hits: glint_hits::sure, t_lower and t_upper.
#pragma once

#include "library/ray_reader.h"

namespace glint::library {

// Writes `sure`, `t_lower` and `t_upper`.
class CertaintyWriter {
  public:
    CertaintyWriter(const glint_hits& hits, uint64_t count);

    bool wantsAny() const { return sure_.wanted() || wantsBounds(); }
    bool wantsBounds() const { return lower_.wanted() || upper_.wanted(); }
    void write(uint64_t i, const reference::certain::Answer& answer) const {
        sure_.putFlag(i, answer.sure ? 1 : 0);
        lower_.putBelow(i, answer.lower);
        upper_.putAbove(i, answer.upper);
    }

  private:
    Output sure_, lower_, upper_;
};

// Answers all rays; if a hit cannot be certified, the ordinary query does. Throws Cancelled.
void certify(const Snapshot& snapshot, const RayReader& rays, const HitWriter& hits,
             const CertaintyWriter& certainty, const Context& context);

}  // namespace glint::library
