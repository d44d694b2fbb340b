#include "mutant_probes.h"

#include "mutant_probe_includes.inc"
#include "primitive_probe_storage.spv.h"
#include "primitive_probe_texel.spv.h"

namespace glint::stability {

std::span<const uint32_t> probeCode(const std::string& name, gpu::Access access) {
    if (name.empty() && access == gpu::Access::StorageBuffer) return primitive_probe_storage_spv;
#include "mutant_probe_cases.inc"
    return primitive_probe_texel_spv;
}

}  // namespace glint::stability
