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
// `spirv` must be valid; what it computes stays the same to the bit. Throws std::invalid_argument for what is
// no SPIR-V.
std::vector<uint32_t> specialize(std::span<const uint32_t> spirv, std::span<const uint32_t> constants);

}  // namespace glint::gpu
