// Cameras that see nothing but limbs.
#pragma once

#include <cstdint>

#include "gpu/device.h"

namespace glint::stability {

// Verifies pictures of limbs until `rays` have been cast: of spheres, an anchored one, quadrics, a disc and a
// box, straight, by a lens and in a mirror, from 0.2 degrees wide to where neighbouring rays are one rounding
// apart. Each pixel must be predicted or explained.
void expectLimbsExplained(const gpu::Device& device, uint64_t rays);

}  // namespace glint::stability
