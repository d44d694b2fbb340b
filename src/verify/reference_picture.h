// Pictures from the CPU reference in the form that the renderer gives them.
#pragma once

#include "pack/packed_scene.h"
#include "render/renderer.h"
#include "trace/picture.h"

namespace glint::verify {

// Renders a band of rows after the other: the reference keeps some hundred bytes for each pixel, the picture
// needs 17. A cancelled render holds the rows that were finished.
Picture renderReference(const PackedScene& scene, const shared::Camera& camera,
                        const render::RenderSettings& settings);

}  // namespace glint::verify
