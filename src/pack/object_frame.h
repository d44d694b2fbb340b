// From local coordinates to an object's own, and to the texture coordinates of flat ones.
#pragma once

#include "pack/packed_scene.h"

namespace glint {

// `origin`: of the local coordinates. The (u, v) of flat shapes is as docs/reference/shading.md has it; that
// of others is left 0.
shared::ObjectFrame objectFrame(const Object& object, const glm::dvec3& origin);

// Two unit vectors across a unit normal, u x v = normal: u horizontal and v upwards on what stands upright or
// leans, u = x where the normal is vertical, to within a sine of 1e-4.
struct SurfaceAxes {
    glm::dvec3 u, v;
};
SurfaceAxes surfaceAxes(const glm::dvec3& normal);

}  // namespace glint
