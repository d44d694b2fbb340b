#include "mutant_probes.h"

#include <cstdlib>

#include "../mutation/kernel_folder.h"
#include "mutant_probe_includes.inc"
#include "primitive_probe.spv.h"

namespace glint::stability {

namespace {

// Or, with GLINT_TEST_KERNELS=FOLDER, FOLDER/primitive_probe.spv if there is one
// (tests/mutation/mutation.py).
std::span<const uint32_t> soundProbe() {
    static const char* const folder = std::getenv("GLINT_TEST_KERNELS");
    static mutation::Replacements replaced;
    std::span<const uint32_t> probe = primitive_probe_spv;
    if (folder) replaced.replace(std::filesystem::path(folder) / "primitive_probe.spv", probe);
    return probe;
}

}  // namespace

std::span<const uint32_t> probeCode(const std::string& name) {
#include "mutant_probe_cases.inc"
    static const std::span<const uint32_t> sound = soundProbe();
    return sound;
}

}  // namespace glint::stability
