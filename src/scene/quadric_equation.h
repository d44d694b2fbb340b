// Quadrics that have no surface which rays can hit reliably.
#pragma once

#include "scene/scene.h"
#include "scene/validate.h"

namespace glint {

// Throws, at `place`, for a plane counted twice, and for a surface that lies in a face of its bounds.
void checkEquation(const QuadricShape& shape, const Place& place);

}  // namespace glint
