// Kernels with a known defect, see mutants.cmake.
#pragma once

#include <string>

#include "render/kernels.h"

namespace glint::render::test {

// The renderer's kernels with the defect. Throws std::out_of_range for an unknown name.
KernelCode mutantKernels(const std::string& name);

}  // namespace glint::render::test
