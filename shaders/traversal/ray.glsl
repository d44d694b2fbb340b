// Rays, their bounds, boxes, and the arithmetic helpers of intersection. Everything here is `precise`: a
// contracted product would break the sign argument of the watertight triangle test and the error bounds
// (docs/design/numerics.md).
#ifndef GLINT_RAY_GLSL
#define GLINT_RAY_GLSL

#include "storage.glsl"

// gamma_n = n u / (1 - n u), u = 2^-24: the bound on the relative error of n roundings (Higham, Accuracy and
// Stability, 2002, sec. 3.1).
const float kUnit = 5.9604645e-8;
float gammaBound(float n) { return quotient(n * kUnit, 1.0 - n * kUnit); }

// max() without its promise about NaN, which costs two more instructions on processors.
float larger(float a, float b) { return a > b ? a : b; }

// Points origin + t direction, tMin < t <= tMax.
struct Ray {
    vec3 origin;
    vec3 direction;
    float tMin;
    float tMax;
    uint source;          // primitive that the ray starts on, kElsewhere, or kNone if it leaves no surface
    uint sourceInstance;  // and the instance it is one of, or kNone
};

// Ray::source in the coordinates of an instance that does not contain the primitive which the ray leaves.
const uint kElsewhere = 0xfffffffeu;

struct Hit {
    float t;
    float u;
    float v;
    uint primitive;  // kNone: a miss
    uint instance;   // that the primitive is one of, or kNone
    uint id;         // of the best hit: equal t goes to the lowest
};

uint kindOf(Hit hit) { return hit.primitive >> kPrimitiveKindShift; }

bool isFinite(vec3 v) { return all(lessThanEqual(abs(v), vec3(kInfinity))); }

// Values of a ray that the box and triangle tests need, computed once per ray.
struct RayFrame {
    vec3 nearOrigin;  // the origin as near planes of boxes are measured from it
    vec3 farOrigin;   // the same for far ones: apart where boxes are to be wider, see makeFrame
    vec3 inverse;     // 1/d, finite, with the sign of d kept where d is 0
    bvec3 negative;   // 1/d < 0: the far plane of a slab is its lower one
    uint axis;        // of the largest component of d: 0, 1, 2
    vec3 shear;       // Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013: dx/dz,
                      // dy/dz, 1/dz
    float slip;       // how far the origin may be off along any unit normal: the way into an instance
};

// (x, y, z) turned so that `axis` comes last; a rotation, so handedness is kept.
vec3 turnToZ(vec3 v, uint axis) { return axis == 0u ? v.yzx : (axis == 1u ? v.zxy : v); }

// Boxes are taken for wider by `pad` on all sides.
RayFrame makeFrame(vec3 o, vec3 d, float pad) {
    RayFrame frame;
    // |1/d| stays below 2^125, so that (plane - origin) * inverse is +-inf or finite for any coordinates in
    // range, never 0 * inf = NaN.
    const float kTiny = 2.3509887e-38;  // 2^-125
    vec3 guarded;
    guarded.x = abs(d.x) < kTiny ? ((floatBitsToUint(d.x) >> 31) != 0u ? -kTiny : kTiny) : d.x;
    guarded.y = abs(d.y) < kTiny ? ((floatBitsToUint(d.y) >> 31) != 0u ? -kTiny : kTiny) : d.y;
    guarded.z = abs(d.z) < kTiny ? ((floatBitsToUint(d.z) >> 31) != 0u ? -kTiny : kTiny) : d.z;
    precise vec3 inverse = quotient(1.0, guarded);
    frame.inverse = inverse;
    frame.negative = lessThan(inverse, vec3(0.0));
    frame.nearOrigin = o;
    frame.farOrigin = o;
    if (FEATURE_INSTANCES) {
        vec3 outwards = mix(vec3(pad), vec3(-pad), frame.negative);
        precise vec3 nearOrigin = o + outwards;
        precise vec3 farOrigin = o - outwards;
        frame.nearOrigin = nearOrigin;
        frame.farOrigin = farOrigin;
    }
    vec3 a = abs(d);
    frame.axis = a.x > a.y ? (a.x > a.z ? 0u : 2u) : (a.y > a.z ? 1u : 2u);
    vec3 turned = turnToZ(d, frame.axis);
    precise float sz = quotient(1.0, turned.z);
    precise float sx = turned.x * sz;
    precise float sy = turned.y * sz;
    frame.shear = vec3(sx, sy, sz);
    frame.slip = 0.0;
    return frame;
}

// The next float away from zero by one unit in the last place in the direction of `sense`.
float nextTowards(float x, float sense) {
    if (sense == 0.0) return x;
    if (x == 0.0) return sense > 0.0 ? 1e-37 : -1e-37;
    int step = (x > 0.0) == (sense > 0.0) ? 1 : -1;
    return intBitsToFloat(floatBitsToInt(x) + step);
}

// ---- Boxes of the BVH ----

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

// ---- The rule for rays that meet and leave surfaces (docs/design/numerics.md) ----
//
// The computed t of a surface stands for the interval t +- slip, which holds the t of every surface that lies
// in the same place but for the rounding of coordinates. Each intersection test sets tSlip with its t.
//
// 1. A ray that leaves a surface starts outside the error box of its point (offsetOrigin), and counts a hit
//    if the interval lies in front of its origin: t - slip > 0.
// 2. Surfaces whose intervals overlap that of the closest hit are at one place. The lowest id is hit; ids of
//    opaque surfaces are lower than those of dielectrics (kDielectricRank).

float tSlip;

// Rays of callers, unless they leave surfaces, and those that count crossings take each t as it is.
const bool kSlips = !MODE_GIVEN || MODE_LEAVES;

// True if a surface at t +- tSlip is within the ray's interval.
bool countsAt(Ray ray, float t) {
    precise float near = t - tSlip;
    bool ahead = ray.source == kNone || near > 0.0;
    return ahead && t > ray.tMin && near <= ray.tMax;
}

// How far the height of the origin above a flat surface may be off, with what surfaces in the same place may
// differ by. n.w, w = anchor - o, errs by gamma_4 of the magnitudes that it sums and n by a unit; n.d, and
// with it the way t d, by as much; the corners of another surface in this place are rounded, each by half a
// unit of its coordinates.
float slipOfHeight(RayFrame frame, vec3 n, vec3 anchor, vec3 w, vec3 way) {
    precise vec3 terms = 2.0 * abs(anchor) + 6.0 * (abs(w) + abs(way));
    precise float height = kUnit * dot(abs(n), terms) + frame.slip;
    return kSlips ? height : 0.0;
}

// tSlip of a flat surface through `anchor` with the unit normal n; speed = n.d.
float slipOfFlat(RayFrame frame, vec3 n, vec3 anchor, vec3 w, vec3 d, float t, float speed) {
    precise float slip = abs(quotient(slipOfHeight(frame, n, anchor, w, t * d), speed));
    return kSlips ? slip : 0.0;
}

// tSlip of a round surface: the last roundings of t. Two of them coincide if they are stored with the same
// numbers, and then have the same t.
float slipOfRound(float t) {
    precise float slip = 8.0 * kUnit * abs(t);
    return kSlips ? slip : 0.0;
}

// How far a point moves along the unit normal of its surface to come out of the box of its error.
float clearance(vec3 error, vec3 n) {
    precise float d = dot(abs(n), error);
    return d;
}

// A point safely on the side of the surface that `n` points to: `p` is off the true surface by at most
// `error` on each axis (Pharr, Jakob, Humphreys, Physically Based Rendering, 4th ed., sec. 6.8.6). The other
// two are for `glint report`: a distance that knows nothing of the scene's size, and none.
vec3 offsetOrigin(vec3 p, vec3 error, vec3 n) {
    if (ORIGIN_OFFSET == kOffsetNone) return p;
    if (ORIGIN_OFFSET == kOffsetFixed) {
        precise vec3 shifted = p + 1e-4 * n;
        return shifted;
    }
    precise vec3 offset = clearance(error, n) * n;
    precise vec3 moved = p + offset;
    return vec3(nextTowards(moved.x, offset.x), nextTowards(moved.y, offset.y),
                nextTowards(moved.z, offset.z));
}

#endif
