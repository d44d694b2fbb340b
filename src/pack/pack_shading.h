#pragma once

#include "pack/packed_scene.h"

namespace glint {

// Rounds materials, optics, lights and what is the same for all rays. The tree and the planes are packed
// already.
void packShading(const Scene& scene, PackedScene& packed);

// A valid light, rounded, relative to `origin`.
shared::Light packLight(const Light& light, const glm::dvec3& origin);

}  // namespace glint
