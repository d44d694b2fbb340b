#include "pack/request_environment.h"

namespace glint {

shared::Environment environmentOf(const PackedScene& scene, const Tracing& tracing) {
    shared::Environment environment = scene.environment;
    if (tracing.maxDepth) environment.maxDepth = *tracing.maxDepth;
    environment.minContribution = static_cast<float>(tracing.minContribution);
    if (tracing.lighting) {
        environment.lightCount = static_cast<uint32_t>(tracing.lighting->lights.size());
        environment.background = tracing.lighting->background;
    }
    return environment;
}

float radianceBoundOf(const PackedScene& scene, const Tracing& tracing) {
    const bool deeper = tracing.maxDepth && *tracing.maxDepth > scene.environment.maxDepth;
    if (!tracing.lighting && !deeper) return scene.environment.radianceBound;
    const shared::Environment environment = environmentOf(scene, tracing);
    return radianceBound(scene, environment, lightsOf(scene, tracing));
}

}  // namespace glint
