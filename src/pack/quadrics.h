// Quadrics of every name as the one form that the tracers know (Quadric in shared/layout.h); internal to the
// packing.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "pack/extent.h"
#include "pack/primitives.h"

namespace glint {

// World box of the clipped surface: exact for the named forms, of a general quadric that of its clipping box.
Extent quadricExtent(const Object& object);

// The object's geometry rounded to fp32: everything of shared::Quadric but its ids and material. The surface
// is what the rounded numbers say; it differs from the exact one by 2^-24 of the distance from `point` and of
// the object's size.
shared::Quadric roundQuadric(const Object& object, const Frame& frame);

// Encloses the rounded quadric.
Box quadricBox(const Object& object, const Frame& frame, const shared::Quadric& rounded);

}  // namespace glint
