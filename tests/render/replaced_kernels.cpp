// With GLINT_TEST_KERNELS=FOLDER the tests run the kernels in FOLDER/texel in place of the program's kernels
// for texel buffers, and FOLDER/arithmetic_probe.spv for those of arithmetic (tests/mutation/mutation.py).
// The linker sends calls of embeddedKernels here (--wrap in CMakeLists.txt), so that the program does not
// know of it.
#include <cstdlib>
#include <filesystem>

#include "../mutation/kernel_folder.h"
#include "replaced_kernels.h"

#define GLINT_MANGLED "_ZN5glint6render15embeddedKernelsENS_3gpu6AccessE"

namespace glint::render::test {

const KernelCode& realKernels(gpu::Access access) __asm__("__real_" GLINT_MANGLED);
const KernelCode& wrappedKernels(gpu::Access access) __asm__("__wrap_" GLINT_MANGLED);

const KernelCode& wrappedKernels(gpu::Access access) {
    static const char* const folder = std::getenv("GLINT_TEST_KERNELS");
    if (!folder || access != gpu::Access::TexelBuffer) return realKernels(access);
    static const mutation::KernelFolder texel(std::filesystem::path(folder) / "texel", realKernels(access));
    return texel.code();
}

std::span<const uint32_t> probeOr(const std::string& name, std::span<const uint32_t> own) {
    static const char* const folder = std::getenv("GLINT_TEST_KERNELS");
    static mutation::Replacements replaced;
    if (folder) replaced.replace(std::filesystem::path(folder) / (name + ".spv"), own);
    return own;
}

}  // namespace glint::render::test
