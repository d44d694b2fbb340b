// The code of primitive_probe.comp, sound or with a defect of mutants.cmake.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace glint::stability {

// An empty name, or that of a mutant that leaves the probe alone: the sound one.
std::span<const uint32_t> probeCode(const std::string& mutant);

}  // namespace glint::stability
