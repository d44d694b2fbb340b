// SPIR-V whose arithmetic a driver must take as it is written.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace glint::gpu {

// The module with every sum, difference, product and quotient of floats, of vectors too, decorated
// NoContraction: then a driver may neither fuse nor reorder them (SPIR-V specification 1.3, section 3.20;
// Vulkan specification, "Precision and Operation of SPIR-V Instructions"). GLSL's `precise` marks those that
// its variables depend on, and forgets nothing but what nobody thought of.
std::vector<uint32_t> strictArithmetic(std::span<const uint32_t> spirv);

}  // namespace glint::gpu
