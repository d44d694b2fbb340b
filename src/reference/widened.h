// Arrays that were rounded for the device, widened for the reference.
#pragma once

#include "pack/packed_scene.h"
#include "reference/model.h"

namespace glint::reference {

// The same numbers. The texels are not copied: the scene must outlive the model.
Model widened(const PackedScene& scene);

}  // namespace glint::reference
