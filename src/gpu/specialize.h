// SPIR-V with the values of its specialization constants put in.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace glint::gpu {

// The module with constants[i] for the specialization constant of id i (ids beyond keep their defaults and
// stay specialization constants), without the branches that are then never taken, the functions that are then
// never called, variables that are then never used, and debug names. A driver
// would find the same, but after it has translated all of it (docs/lab/building.md).
// SPIRV-Tools' optimizer (2023.1) takes 0.85 s of processor time for this on light.comp and 1.05 s on
// whole.comp, 1.4 s and 2.1 s with inlining and SSA; a whole warm `glint render scenes/spheres.json --size
// 96x72` takes 0.1 s (2 cores, lavapipe 22.3). `spirv` must be valid; what it computes stays the same to the
// bit. Throws std::invalid_argument for what is no SPIR-V.
std::vector<uint32_t> specialize(std::span<const uint32_t> spirv, std::span<const uint32_t> constants);

}  // namespace glint::gpu
