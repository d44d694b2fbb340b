// SPIR-V without calls and without local variables, whose arithmetic a driver must take as it is written.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace glint::gpu {

// The module with the bodies of functions in place of the calls, and values in place of local variables that
// no index known at run time alone looks into. What it computes stays the same to the bit. Drivers do the
// same, but lavapipe takes five times as long for it (docs/lab/speed.md). Calls of functions that return
// from within a loop or a branch stay. All float arithmetic is decorated NoContraction, so that a driver may
// neither fuse nor reorder it (SPIR-V specification 1.3, section 3.20; Vulkan specification, "Precision and
// Operation of SPIR-V Instructions"); GLSL's `precise` marks only what its variables depend on. `spirv` must
// be valid. Throws std::invalid_argument for what is no SPIR-V, and std::domain_error for an instruction that
// no kernel of glint has.
std::vector<uint32_t> flatten(std::span<const uint32_t> spirv);

}  // namespace glint::gpu
