#pragma once

#include <functional>
#include <vector>

#include "pack/packed_scene.h"

namespace glint {

// What the arrays and the materials that are used say of the features; those of packTextures are there
// already, those of the camera and of shadows come later (packScene).
SceneFeatures featuresOf(const PackedScene& packed, const std::function<bool(size_t)>& used);

// Whether some triangle is so narrow that rounding may find a ray to meet it that has left the plane.
bool haveSlivers(const std::vector<shared::Triangle>& triangles);

}  // namespace glint
