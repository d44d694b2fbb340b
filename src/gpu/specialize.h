// Specializes the SPIR-V of a kernel for one scene.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace glint::gpu {

// The module with constants[i] for the specialization constant of id i (ids beyond keep their defaults and
// stay specialization constants), without the branches that are then never taken, with the bodies of
// functions in place of calls, values in place of local variables, and without what is then unused. A driver
// makes these reductions only after it has translated the whole module, which takes many times as long
// (docs/lab/building.md).
//
// All float arithmetic is decorated NoContraction, so that a driver may neither fuse nor reorder it (SPIR-V
// specification 1.3, section 3.20; Vulkan specification, "Precision and Operation of SPIR-V Instructions");
// GLSL's `precise` marks only what its variables depend on. Results keep every bit.
//
// `spirv` must be valid. Throws std::invalid_argument if it is not SPIR-V, and std::domain_error for an
// instruction that no kernel of glint has.
std::vector<uint32_t> specialize(std::span<const uint32_t> spirv, std::span<const uint32_t> constants);

}  // namespace glint::gpu
