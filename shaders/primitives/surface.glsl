// A point of a surface, and what several kinds of primitives find it by.
#ifndef GLINT_PRIMITIVES_SURFACE_GLSL
#define GLINT_PRIMITIVES_SURFACE_GLSL

#include "traversal/ray.glsl"
#include "storage.glsl"
#include "shading/texcoord.glsl"

struct Surface {
    vec3 position;
    vec3 error;            // the true point is within position +- error on each axis
    vec3 geometricNormal;  // outward, unit
    vec3 shadingNormal;    // outward, in the hemisphere of geometricNormal, unit
    uint object;
    uint primitive;
    uint material;
    // Texture coordinates; of triangles without their own, the barycentrics. Every kind of primitive sets
    // them here.
    vec2 uv;
    vec3 color;  // of the vertices, interpolated; white without
};

// If a line hits two surfaces at one t, kernels that count surfaces must keep both. The same holds for
// kernels that decide per surface whether light enters or leaves a medium. The normal does not distinguish
// them if rounding decides its sign. In these kernels round primitives therefore return the side in Hit.u.
#if defined(GLINT_CROSSINGS)
const bool kCountsSurfaces = true;
const bool kTellsSides = false;
#elif defined(GLINT_SHADOW_RAYS)
const bool kCountsSurfaces = FEATURE_COLORED_SHADOWS;
const bool kTellsSides = FEATURE_COLORED_SHADOWS;
#else
const bool kCountsSurfaces = false;
const bool kTellsSides = false;
#endif
const float kComesIn = 1.0, kLeaves = 2.0;

// The t of a surface that a line meets after one at `before`, counted from 0: what it touches in one point it
// enters and leaves.
float afterT(float before, float t) {
    bool same = kCountsSurfaces && before > 0.0 && t <= before;
    return same ? uintBitsToFloat(floatBitsToUint(before) + 1u) : t;
}

// Surface of a flat primitive with this point and unit normal. The hit point is moved back to the plane as an
// offset from `anchor`. The product with the normal errs by gamma_4 of the offset; the subtraction and the
// addition of the anchor err by a unit each.
void flatSurface(Ray ray, Hit hit, vec3 anchor, vec3 normal, inout Surface surface) {
    precise vec3 offset = (ray.origin - anchor) + hit.t * ray.direction;
    precise vec3 projected = offset - dot(normal, offset) * normal;
    precise vec3 position = anchor + projected;
    surface.position = position;
    surface.error = gammaBound(7.0) * (abs(projected) + abs(anchor));
    surface.geometricNormal = normal;
    surface.shadingNormal = normal;
}

#endif
