#pragma once

#include <functional>
#include <vector>

#include "pack/packed_scene.h"

namespace glint {

// Features of the arrays and of the materials in use. packTextures has added its own; packScene adds those of
// the camera and of shadows.
SceneFeatures featuresOf(const PackedScene& packed, const std::function<bool(size_t)>& used,
                         const Context& context);

// True if a triangle is so narrow that rounding may report a hit behind a ray's origin.
bool haveSlivers(const std::vector<shared::Triangle>& triangles, const Context& context);

}  // namespace glint
