// Shading data of a scene; internal to truth.
#pragma once

#include "reference/model.h"
#include "scene/scene.h"

namespace glint::reference::truth {

// Materials, media, lights, background, textures and the coordinates of objects. `used`: by material, whether
// a surface has it.
void addShading(const Scene& scene, const std::vector<bool>& used, Model& model);

// Media around the eye, once all primitives are there (docs/reference/shading.md).
void addMediaAtEye(const glm::dvec3& eye, Model& model);

}  // namespace glint::reference::truth
