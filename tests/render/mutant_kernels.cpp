#include "mutant_kernels.h"

#include <stdexcept>

#include "mutant_includes.inc"

namespace glint::render::test {

KernelCode mutantKernels(const std::string& name) {
    KernelCode code = embeddedKernels();
    const auto set = [&](const std::string& module, std::span<const uint32_t> words) {
        for (const KernelId id : kKernels)
            if (module == infoOf(id).module) code[id] = words;
    };
#include "mutant_cases.inc"
    throw std::out_of_range("no mutant \"" + name + "\" in mutants.cmake");
}

}  // namespace glint::render::test
