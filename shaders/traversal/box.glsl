// Ray against a box of the tree; primitives are in primitives/.
#ifndef GLINT_INTERSECT_GLSL
#define GLINT_INTERSECT_GLSL

#include "traversal/ray.glsl"
#include "storage.glsl"

// Distances along the ray of the two planes of each slab, the far one enlarged. A division good to 2.5 ulp
// (Vulkan's promise), one subtraction and one product leave each plane within gamma_7 of its true distance
// (Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013, with gamma_7 in place of his gamma_3), and what the
// triangle test accepts may lie beside the ray by 11 u t |d| (edgeMargin, src/pack/primitives.h): both twice,
// and a unit for the product itself and for what is of second order, make 1 + 38 u. So a box whose primitive
// is hit is never missed. The same factor on the interval's end keeps one that is hit at exactly that t.
const float kFarPad = 1.00000226497650;
// The other two are for `glint report`: Ize's own, and none.
float farPad() {
    return SLAB_PAD == kSlabPlain ? 1.0 : (SLAB_PAD == kSlabGamma3 ? 1.00000035762791 : kFarPad);
}

// True if the box may hold a hit in the ray's interval that ends at tEnd = tMax * kFarPad. Both planes are
// chosen by the sign of the direction, not by min and max, so that an empty box (lo > hi) is never hit.
bool intersectBox(Ray ray, RayFrame frame, vec3 lo, vec3 hi, float tEnd, out float tNear) {
    vec3 nearPlane = mix(lo, hi, frame.negative);
    vec3 farPlane = mix(hi, lo, frame.negative);
    precise vec3 t0 = (nearPlane - frame.nearOrigin) * frame.inverse;
    precise vec3 t1 = (farPlane - frame.farOrigin) * frame.inverse;
    // Written as comparisons: these compile to one instruction each where min and max take three, for NaN's
    // sake.
    float near = ray.tMin;
    near = t0.x > near ? t0.x : near;
    near = t0.y > near ? t0.y : near;
    near = t0.z > near ? t0.z : near;
    float far = t1.x;
    far = t1.y < far ? t1.y : far;
    far = t1.z < far ? t1.z : far;
    precise float padded = far * farPad();
    far = padded < tEnd ? padded : tEnd;
    tNear = near;
    return near <= far;
}

#endif
