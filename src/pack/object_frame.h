// From local coordinates to an object's own, and to the texture coordinates of flat ones.
#pragma once

#include "pack/packed_scene.h"

namespace glint {

// Origin of the cubes of a scene's solid checkers, in the space of every object: a corner of the first
// checker, so that only differences are rounded. `period`: period of the cubes along each axis if all solid
// checkers have one cube size; else 0.
struct CubeOrigin {
    glm::dvec3 corner{0};
    double period = 0;
};
CubeOrigin cubeOrigin(const Scene& scene);

// A coordinate counted from that corner: as it is, or, where fp32 tells no cubes apart, in the period around
// the corner. Which period is seen by none, so an object's place may be moved by some, and a texture's corner
// by others. period 0: as it is.
double inCubes(double fromCorner, double period);

// `origin`: of the local coordinates. An object's own are given from cubes.corner on, and in the period
// around it if all solid checkers that it shows have cubes of one size. The (u, v) of flat shapes is as
// docs/reference/shading.md has it; that of others is left 0.
shared::ObjectFrame objectFrame(const Scene& scene, const Object& object, const glm::dvec3& origin,
                                const CubeOrigin& cubes);

// Two unit vectors across a unit normal, u x v = normal: u horizontal and v upwards on what stands upright or
// leans, u = x where the normal is vertical, to within a sine of 1e-4.
struct SurfaceAxes {
    glm::dvec3 u, v;
};
SurfaceAxes surfaceAxes(const glm::dvec3& normal);

}  // namespace glint
