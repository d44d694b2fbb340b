// With GLINT_TEST_KERNELS=FOLDER the tests run the kernels in FOLDER in place of the program's, and
// FOLDER/arithmetic_probe.spv for those of arithmetic (tests/mutation/mutation.py). The linker sends calls of
// embeddedKernels here (--wrap in CMakeLists.txt), so that the program does not know of it.
#include <cstdlib>
#include <filesystem>

#include "../mutation/kernel_folder.h"
#include "replaced_kernels.h"

#define GLINT_MANGLED "_ZN5glint6render15embeddedKernelsEv"

namespace glint::render::test {

const KernelCode& realKernels() __asm__("__real_" GLINT_MANGLED);
const KernelCode& wrappedKernels() __asm__("__wrap_" GLINT_MANGLED);

const KernelCode& wrappedKernels() {
    static const char* const folder = std::getenv("GLINT_TEST_KERNELS");
    if (!folder) return realKernels();
    static const mutation::KernelFolder kernels(folder, realKernels());
    return kernels.code();
}

std::span<const uint32_t> probeOr(const std::string& name, std::span<const uint32_t> own) {
    static const char* const folder = std::getenv("GLINT_TEST_KERNELS");
    static mutation::Replacements replaced;
    if (folder) replaced.replace(std::filesystem::path(folder) / (name + ".spv"), own);
    return own;
}

}  // namespace glint::render::test
