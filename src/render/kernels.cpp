#include "render/kernels.h"

#include "core/device_layout.h"
#include "kernel_modules.inc"

namespace glint::render {

const KernelCode& embeddedKernels() {
#define GLINT_KERNEL(id, module, shader, defines, name, rays) {KernelId::id, module##_spv},
    static const KernelCode code = {
#include "render/kernels.def"
    };
#undef GLINT_KERNEL
    return code;
}

const KernelInfo& infoOf(KernelId id) {
#define GLINT_KERNEL(id, module, shader, defines, name, rays) {name, #module, rays},
    static constexpr KernelInfo list[] = {
#include "render/kernels.def"
    };
#undef GLINT_KERNEL
    return list[static_cast<size_t>(id)];
}

KernelId packetKernel(KernelId id) {
    if (id == KernelId::Light) return KernelId::PacketLight;
    if (id == KernelId::Count) return KernelId::PacketCount;
    return id == KernelId::IntersectAny ? KernelId::PacketIntersectAny : KernelId::PacketIntersect;
}

TraceModes modesOf(const Request& request) {
    TraceModes modes;
    modes.methods = request.methods;
    modes.cost = request.cost;
    modes.aovs = request.wantsData();
    modes.shadowless = !request.shadows;
    modes.ledger = request.wantsLosses();
    modes.tally = request.tally;
    modes.scattered = request.samples.scattered();
    modes.adaptive = request.samples.threshold.has_value();
    return modes;
}

}  // namespace glint::render
