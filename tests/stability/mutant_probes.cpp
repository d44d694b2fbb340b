#include "mutant_probes.h"

#include "mutant_probe_includes.inc"
#include "primitive_probe.spv.h"

namespace glint::stability {

std::span<const uint32_t> probeCode(const std::string& name) {
#include "mutant_probe_cases.inc"
    return primitive_probe_spv;
}

}  // namespace glint::stability
