// Local variables of a function turned into values: a part of flatten.h.
#pragma once

#include "gpu/spirv_code.h"
#include "gpu/spirv_ids.h"

namespace glint::gpu::spirv {

// By ids, for turnVariablesIntoValues alone: the same for all functions, as memory of their own costs more
// than what is looked up in it.
struct Tables {
    Table pointers, forward, structured, live, makers;
};

// Whatever the function stores to and loads from its own variables becomes values (M. Braun et al., "Simple
// and Efficient Construction of Static Single Assignment Form", CC 2013), structures part by part. What is
// then not used goes. Variables that are handed to a function, or indexed by what is no constant, stay.
void turnVariablesIntoValues(Function& function, Ids& ids, Tables& tables);

}  // namespace glint::gpu::spirv
