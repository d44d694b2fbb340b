#include "render/kernel_choice.h"

#include "pack/request_environment.h"

namespace glint::render {

std::vector<KernelId> kernelsOf(const PackedScene& scene, const Request& request, bool packets) {
    std::vector<KernelId> kernels = {KernelId::Generate, KernelId::Shade};
    // Packets trace camera rays alone. Whether there are others is the scene's to say, not the code's that
    // the pipeline happens to hold: kernels for later bounces that never come would double a cold start.
    const bool goesOn =
        (scene.features.mirrors || scene.features.transmission) && environmentOf(scene, request).maxDepth > 0;
    const bool hasLights = !lightsOf(scene, request).empty();
    for (const KernelId id : {KernelId::Intersect, KernelId::Light}) {
        if (id == KernelId::Light && !hasLights) continue;
        if (packets) kernels.push_back(packetKernel(id));
        if (!packets || goesOn) kernels.push_back(id);
    }
    if (request.samples.threshold) kernels.push_back(KernelId::Adapt);
    return kernels;
}

std::vector<KernelId> wholeKernelsOf(const Request& request) {
    std::vector<KernelId> kernels = {KernelId::Whole};
    if (request.samples.threshold) kernels.push_back(KernelId::Adapt);
    return kernels;
}

}  // namespace glint::render
