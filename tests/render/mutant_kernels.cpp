#include "mutant_kernels.h"

#include <stdexcept>

#include "mutant_includes.inc"

namespace glint::render::test {

KernelCode mutantKernels(const std::string& name) {
    KernelCode code = embeddedKernels(gpu::Access::TexelBuffer);
#include "mutant_cases.inc"
    throw std::out_of_range("no mutant \"" + name + "\" in mutants.cmake");
}

}  // namespace glint::render::test
