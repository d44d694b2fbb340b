// What a SPIR-V module leaves to the driver.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace glint::stability {

// Instructions that a driver might fuse or reorder: OpFAdd, OpFSub, OpFMul, OpFDiv, OpVectorTimesScalar and
// OpDot that do not carry the decoration NoContraction.
size_t withoutNoContraction(std::span<const uint32_t> module);

}  // namespace glint::stability
