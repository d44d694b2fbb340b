// A scene's surroundings as a request wants them, for both tracers.
#pragma once

#include "pack/packed_scene.h"
#include "trace/request.h"

namespace glint {

inline const std::vector<shared::Light>& lightsOf(const PackedScene& scene, const Tracing& tracing) {
    return tracing.lighting ? tracing.lighting->lights : scene.lights;
}

// The scene's environment with what `tracing` says instead. The radiance bound is the scene's: it holds for
// its own lights, background and depth.
shared::Environment environmentOf(const PackedScene& scene, const Tracing& tracing);

// The scene's radiance bound where that holds for `tracing`, or else one that does, which looks at every
// texel.
float radianceBoundOf(const PackedScene& scene, const Tracing& tracing);

}  // namespace glint
