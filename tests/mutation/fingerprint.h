// Do two SPIR-V modules hold the same code?
#pragma once

#include <cstdint>
#include <span>

namespace glint::mutation {

// Depends on what the module's functions do, and neither on the numbers of ids nor on globals that no
// function uses. Equal for equal code; other code has another one but for one chance in 2^64.
uint64_t fingerprintOf(std::span<const uint32_t> spirv);

}  // namespace glint::mutation
