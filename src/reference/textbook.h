// The textbooks' intersection tests, in double: those that the shader may be told to use instead of the sound
// ones.
#pragma once

#include "reference/intersect.h"
#include "trace/methods.h"

namespace glint::reference {

// method: not Watertight.
bool textbookTriangle(TriangleMethod method, const rows::Triangle& triangle, const PreparedRay& ray,
                      double tMax, Root& root);

// method: not Robust.
bool textbookSphere(SphereMethod method, const rows::Sphere& sphere, const PreparedRay& ray, bool fromSurface,
                    double tMax, Root& root);

}  // namespace glint::reference
