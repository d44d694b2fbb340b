// Shaders of the tests themselves, which include those of the program.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace glint::render::test {

// `own`, or what stands in for it (replaced_kernels.cpp).
std::span<const uint32_t> probeOr(const std::string& name, std::span<const uint32_t> own);

}  // namespace glint::render::test
