// Calls in SPIR-V replaced by the bodies of the functions: a part of specialize.h.
#pragma once

#include "gpu/spirv_values.h"

namespace glint::gpu::spirv {

// Puts bodies of functions in place of their calls, and values in place of the variables of each function.
// Calls of functions that return from within a loop or a branch remain.
void inlineCalls(Code& code, Ids& ids);

}  // namespace glint::gpu::spirv
