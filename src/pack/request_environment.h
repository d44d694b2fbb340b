// A scene's environment and camera with a request's settings, for both tracers.
#pragma once

#include "pack/packed_scene.h"
#include "trace/request.h"

namespace glint {

inline shared::Camera cameraOf(const PackedScene& scene, const Request& request) {
    return packCamera(request.camera, request.width, request.height, scene.origin);
}

inline const std::vector<shared::Light>& lightsOf(const PackedScene& scene, const Tracing& tracing) {
    return tracing.lighting ? tracing.lighting->lights : scene.lights;
}

// The greatest radiance, in any channel, that a ray of the tree can bring with the environment's depth of
// rays after it: the greatest of the background and, for each material, of ambient light, all `lights`
// unshadowed and head on, and the branches. kInfinity if there is none: a light that falls off touches a box
// of the BVH, or the sum overflows.
float radianceBound(const PackedScene& scene, const shared::Environment& environment,
                    const std::vector<shared::Light>& lights);

// Reflections and refractions in a row that are followed.
uint32_t depthOf(const PackedScene& scene, const Tracing& tracing);

// The scene's environment with the settings of `tracing`. The radiance bound is the scene's: it holds for its
// own lights, background and depth.
shared::Environment environmentOf(const PackedScene& scene, const Tracing& tracing);

// The same for the request's camera rays: with the media around its eye.
shared::Environment cameraEnvironment(const PackedScene& scene, const Request& request);

// The scene's radiance bound where that holds for `tracing`, or else one that does, which looks at every
// texel.
float radianceBoundOf(const PackedScene& scene, const Tracing& tracing);

}  // namespace glint
