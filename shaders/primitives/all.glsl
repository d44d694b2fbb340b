// Every kind of primitive. A kind that stands in leaves by itself brings, beside what it needs of its own,
//   bool hitKind(Ray, RayFrame, Kind, uint primitive, inout uint trips, out Hit)   where a ray first meets it
//   in its interval; trips: of its loops
// and any that is hit, triangles apart,
//   void surfaceOfKind(Ray, Hit, Kind, inout Surface)                              position, error and
//   normals there, and uv if they are its own
// which the traversals (traversal/stack.glsl, packet/packet.glsl) and surfaceAt (shading/surface.glsl) call
// by the list of shaders/shared/primitives.h.
#ifndef GLINT_PRIMITIVES_ALL_GLSL
#define GLINT_PRIMITIVES_ALL_GLSL

#include "primitives/triangle.glsl"
#include "primitives/sphere.glsl"
#include "primitives/plane.glsl"
#include "primitives/disc.glsl"
#include "primitives/polygon.glsl"
#include "primitives/quadric.glsl"
#include "primitives/cuboid.glsl"

#endif
