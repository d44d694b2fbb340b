// What a SPIR-V module leaves to the driver.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace glint::stability {

// Instructions that a driver might fuse or reorder, OpFAdd, OpFSub, OpFMul, OpFDiv and OpVectorTimesScalar,
// that do not carry the decoration NoContraction, in the functions that decide hits: those of intersect.glsl
// and the crossings of quadrics. Surfaces, textures (of holes) and bounds of errors may round as they like.
struct Contractible {
    size_t functions = 0;  // of those named above, found in the module
    size_t instructions = 0;
};
Contractible withoutNoContraction(std::span<const uint32_t> module);

}  // namespace glint::stability
