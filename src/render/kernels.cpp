#include "render/kernels.h"

#include "core/device_layout.h"
#include "kernel_modules.inc"

namespace glint::render {

namespace {

struct Description {
    const char* name;
    const char* module;
    uint32_t raysOfLane;
};

const Description& describe(KernelId id) {
#define GLINT_KERNEL(id, module, shader, defines, name, rays) {name, #module, rays},
    static constexpr Description list[] = {
#include "render/kernels.def"
    };
#undef GLINT_KERNEL
    return list[static_cast<size_t>(id)];
}

}  // namespace

const KernelCode& embeddedKernels() {
    static const KernelCode code = [] {
        KernelCode made;
#define GLINT_KERNEL(id, module, shader, defines, name, rays) made[KernelId::id] = module##_spv;
#include "render/kernels.def"
#undef GLINT_KERNEL
        return made;
    }();
    return code;
}

const char* nameOf(KernelId id) {
    return describe(id).name;
}

const char* moduleOf(KernelId id) {
    return describe(id).module;
}

uint32_t raysOfLane(KernelId id) {
    return describe(id).raysOfLane;
}

KernelId packetKernel(KernelId id) {
    if (id == KernelId::Light) return KernelId::PacketLight;
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
