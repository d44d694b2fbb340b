// Mesa's lavapipe before version 25 ends loops after 65,535 trips.
#pragma once

#include "gpu/device.h"

namespace glint::render::test {

// True if the device ends a loop of 100,000 trips early.
bool endsLoops(const gpu::Device& device);

}  // namespace glint::render::test
