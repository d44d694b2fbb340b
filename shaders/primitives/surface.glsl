// A point of a surface.
#ifndef GLINT_PRIMITIVES_SURFACE_GLSL
#define GLINT_PRIMITIVES_SURFACE_GLSL

#include "traversal/ray.glsl"

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

// The point anchor + offset with the outward unit normal. `offset` errs by gamma_5, and the sum rounds once
// more (PBRT 4th ed., sec. 6.8.5).
void setPoint(vec3 anchor, vec3 offset, vec3 normal, inout Surface surface) {
    surface.position = anchor + offset;
    surface.error = gammaBound(7.0) * (abs(offset) + abs(anchor));
    surface.geometricNormal = normal;
    surface.shadingNormal = normal;
}

void setOwner(uint object, uint primitive, uint material, inout Surface surface) {
    surface.object = object;
    surface.primitive = primitive;
    surface.material = material;
}

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

#endif
