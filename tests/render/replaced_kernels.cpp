// With GLINT_TEST_KERNELS=FOLDER all tests here run on the kernels in FOLDER/texel and FOLDER/storage, as far
// as there are any, instead of those of the program, and those of arithmetic on FOLDER/arithmetic_probe.spv
// (tests/mutation/mutation.py). The linker sends calls of
// embeddedKernels here (--wrap in CMakeLists.txt), so that the program itself knows nothing of it.
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
    if (!folder) return realKernels(access);
    const auto of = [](const char* name, gpu::Access a) {
        return mutation::KernelFolder(std::filesystem::path(folder) / name, realKernels(a));
    };
    static const mutation::KernelFolder texel = of("texel", gpu::Access::TexelBuffer);
    static const mutation::KernelFolder storage = of("storage", gpu::Access::StorageBuffer);
    return (access == gpu::Access::TexelBuffer ? texel : storage).code();
}

std::span<const uint32_t> probeOr(const std::string& name, std::span<const uint32_t> own) {
    static const char* const folder = std::getenv("GLINT_TEST_KERNELS");
    static mutation::Replacements replaced;
    if (folder) replaced.replace(std::filesystem::path(folder) / (name + ".spv"), own);
    return own;
}

}  // namespace glint::render::test
