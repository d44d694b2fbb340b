#include "mutant_probes.h"

#include "mutant_probe_includes.inc"
#include "primitive_probe_sound.spv.h"

namespace glint::stability {

std::span<const uint32_t> probeCode(const std::string& name) {
#include "mutant_probe_cases.inc"
    return primitive_probe_sound_spv;
}

}  // namespace glint::stability
