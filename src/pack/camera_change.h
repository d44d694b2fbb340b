// Whether another camera needs other arrays.
#pragma once

#include "pack/packed_scene.h"
#include "scene/scene.h"

namespace glint {

// What packScene makes depends on where the camera stands: the local origin, and from which of its points a
// huge sphere or quadric next to the eye, or a plane, is measured. True if for `camera` it would make the
// same arrays as it did of `scene`, whose camera was another one; `packed` is what it made. `scene` is placed
// (scene/placement.h). At worst false where they are the same.
bool keepsArrays(const PackedScene& packed, const Scene& scene, const Camera& camera);

// Sets what of the arrays follows the eye all the same: the media that it is in.
void setEye(PackedScene& packed, const glm::dvec3& eye);

}  // namespace glint
