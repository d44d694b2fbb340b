// Local variables of a function turned into values: a part of specialize.h.
#pragma once

#include "gpu/spirv_code.h"
#include "gpu/spirv_ids.h"

namespace glint::gpu::spirv {

// Whatever the function stores to and loads from its own variables becomes values (M. Braun et al., "Simple
// and Efficient Construction of Static Single Assignment Form", CC 2013), structures member by member.
// Instructions whose results are then unused are removed. Variables that are passed to a function or have an
// index that is not constant remain.
void turnVariablesIntoValues(Function& function, Ids& ids);

}  // namespace glint::gpu::spirv
