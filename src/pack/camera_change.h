// Tests if another camera needs other arrays.
#pragma once

#include "pack/packed_scene.h"
#include "scene/scene.h"

namespace glint {

// The camera determines the local origin and the anchors of planes and of huge spheres and quadrics next to
// the eye. True if packScene would make the same arrays for `camera` as it made in `packed` for `scene`,
// which is placed (scene/placement.h). May be false for equal arrays.
bool keepsArrays(const PackedScene& packed, const Scene& scene, const Camera& camera);

// Sets what of the arrays follows the eye all the same: the media that it is in.
void setEye(PackedScene& packed, const glm::dvec3& eye);

}  // namespace glint
