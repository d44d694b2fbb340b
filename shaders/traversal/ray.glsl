// Rays, boxes, and the arithmetic of intersection. All of it is `precise`: a contracted product would break
// the watertight triangle test and the error bounds (docs/design/numerics.md).
#ifndef GLINT_RAY_GLSL
#define GLINT_RAY_GLSL

#include "storage.glsl"

// gamma_n = n u / (1 - n u), u = 2^-24, bounds the relative error of n roundings (Higham 2002, sec. 3.1).
const float kUnit = 5.9604645e-8;
float gammaBound(float n) { return quotient(n * kUnit, 1.0 - n * kUnit); }

// max() and min() without their promise about NaN, which costs two more instructions on processors.
float larger(float a, float b) { return a > b ? a : b; }
float smaller(float a, float b) { return a < b ? a : b; }

float greatestComponent(vec3 v) {
    vec3 a = abs(v);
    return larger(a.x, larger(a.y, a.z));
}

// 2^-exponent of the greatest component: a direction times it has components up to 2 and the same digits.
float unitOf(vec3 v) {
    return uintBitsToFloat(0x7f000000u - (floatBitsToUint(greatestComponent(v)) & 0x7f800000u));
}

// The rows of a matrix times a vector.
vec3 timesRows(vec3 x, vec3 y, vec3 z, vec3 v) { return vec3(dot(x, v), dot(y, v), dot(z, v)); }

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
    vec3 nearOrigin;  // the origin for near planes of boxes
    vec3 farOrigin;   // and for far planes: another if boxes are to be wider, see makeFrame
    vec3 inverse;     // 1/d, finite, with the sign of d kept where d is 0
    bvec3 negative;   // 1/d < 0: the far plane of a slab is its lower one
    uint axis;        // of the largest component of d: 0, 1, 2
    vec3 shear;       // dx/dz, dy/dz, 1/dz (Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection",
                      // JCGT 2(1), 2013)
    float slip;       // how far the origin may be off along any unit normal: the way into an instance
};

// (x, y, z) turned so that `axis` comes last; a rotation, so handedness is kept.
vec3 turnToZ(vec3 v, uint axis) { return axis == 0u ? v.yzx : (axis == 1u ? v.zxy : v); }

// Boxes are taken for wider by `pad` on all sides.
RayFrame makeFrame(vec3 o, vec3 d, float pad) {
    precise RayFrame frame;
    // |1/d| stays below 2^125, so that (plane - origin) * inverse is never 0 * inf = NaN.
    const float kTiny = 2.3509887e-38;  // 2^-125
    bvec3 isNegative = notEqual(floatBitsToUint(d) >> 31, uvec3(0u));
    vec3 tiny = mix(vec3(kTiny), vec3(-kTiny), isNegative);
    vec3 guarded = mix(d, tiny, lessThan(abs(d), vec3(kTiny)));
    frame.inverse = quotient(1.0, guarded);
    frame.negative = lessThan(frame.inverse, vec3(0.0));
    frame.nearOrigin = o;
    frame.farOrigin = o;
    if (FEATURE_INSTANCES) {
        vec3 outwards = mix(vec3(pad), vec3(-pad), frame.negative);
        frame.nearOrigin = o + outwards;
        frame.farOrigin = o - outwards;
    }
    vec3 a = abs(d);
    frame.axis = a.x > a.y ? (a.x > a.z ? 0u : 2u) : (a.y > a.z ? 1u : 2u);
    vec3 turned = turnToZ(d, frame.axis);
    float inverseZ = quotient(1.0, turned.z);
    frame.shear = vec3(turned.xy * inverseZ, inverseZ);
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

// Factor of far planes and of the interval's end: a box whose primitive is hit is never missed. 1 + 38 u:
// twice gamma_7 for the distance of a plane (docs/design/numerics.md 2.2), and twice 11 u for what the
// triangle test accepts beside the ray (edgeMargin, src/pack/primitives.h), and 2 u.
const float kFarPad = 1.00000226497650;
// For `glint report` also Ize's own, and none.
float farPad() {
    return SLAB_PAD == kSlabPlain ? 1.0 : (SLAB_PAD == kSlabGamma3 ? 1.00000035762791 : kFarPad);
}

// True if the box may hold a hit up to tEnd = tMax * kFarPad. The sign of the direction chooses the planes,
// so that an empty box (lo > hi) is never hit.
bool intersectBox(Ray ray, RayFrame frame, vec3 lo, vec3 hi, float tEnd, out float tNear) {
    vec3 nearPlane = mix(lo, hi, frame.negative);
    vec3 farPlane = mix(hi, lo, frame.negative);
    precise vec3 t0 = (nearPlane - frame.nearOrigin) * frame.inverse;
    precise vec3 t1 = (farPlane - frame.farOrigin) * frame.inverse;
    tNear = larger(larger(t0.z, larger(t0.y, t0.x)), ray.tMin);
    precise float padded = smaller(t1.z, smaller(t1.y, t1.x)) * farPad();
    return tNear <= smaller(padded, tEnd);
}

// ---- The rule for rays that meet and leave surfaces (docs/design/numerics.md) ----

// Each intersection test sets tSlip with its t. The interval t +- tSlip holds the t of every coincident
// surface, despite the rounding of coordinates.
float tSlip;

// False for callers' rays that do not leave surfaces and for rays that count crossings: they use t without
// slip.
const bool kSlips = !MODE_GIVEN || MODE_LEAVES;

// True if a surface at t +- tSlip is within the ray's interval, and wholly in front of a ray that leaves a
// surface.
bool countsAt(Ray ray, float t) {
    precise float near = t - tSlip;
    bool ahead = ray.source == kNone || near > 0.0;
    return ahead && t > ray.tMin && near <= ray.tMax;
}

// Error bound of the origin's height above a flat surface, with the difference of surfaces in the same place.
// w: anchor - origin; way: t d.
float slipOfHeight(RayFrame frame, vec3 n, vec3 anchor, vec3 w, vec3 way) {
    precise vec3 terms = 2.0 * abs(anchor) + 6.0 * (abs(w) + abs(way));
    precise float height = kUnit * dot(abs(n), terms) + frame.slip;
    return kSlips ? height : 0.0;
}

// tSlip of a flat surface through `anchor` with the unit normal n; speed = n.d.
float slipOfFlat(RayFrame frame, vec3 n, vec3 anchor, vec3 w, vec3 d, float t, float speed) {
    return kSlips ? abs(quotient(slipOfHeight(frame, n, anchor, w, t * d), speed)) : 0.0;
}

// The last roundings of t.
float slipOfRounding(float t) { return kSlips ? 8.0 * kUnit * abs(t) : 0.0; }

// tSlip of a round surface, from the gradient of its equation: `spread` has the magnitudes that the gradient
// sums, speed is gradient.d, and `sums` the magnitudes that the equation sums. Near a tangent the curvature
// bounds the slip, and so does the least speed here.
float slipOfRound(RayFrame frame, vec3 spread, float speed, vec3 anchor, vec3 w, vec3 d, float t,
                  float sums) {
    precise float error = slipOfHeight(frame, spread, anchor, w, t * d) + 12.0 * kUnit * sums;
    float least = 4.8828125e-4 * greatestComponent(spread) * greatestComponent(d);  // 2^-11
    return kSlips ? quotient(error, larger(larger(abs(speed), least), 1e-37)) : 0.0;
}

// How far a point moves along the unit normal of its surface to come out of the box of its error.
float clearance(vec3 error, vec3 n) { return dot(abs(n), error); }

// A point on the side of the surface that `n` points to: `p` is off the true surface by at most `error` on
// each axis (Pharr, Jakob, Humphreys, PBRT 4th ed., sec. 6.8.6). For `glint report` also a fixed distance,
// and none.
vec3 offsetOrigin(vec3 p, vec3 error, vec3 n) {
    if (ORIGIN_OFFSET == kOffsetNone) return p;
    if (ORIGIN_OFFSET == kOffsetFixed) return p + 1e-4 * n;
    precise vec3 offset = clearance(error, n) * n;
    precise vec3 moved = p + offset;
    return vec3(nextTowards(moved.x, offset.x), nextTowards(moved.y, offset.y),
                nextTowards(moved.z, offset.z));
}

// ---- Points of surfaces ----

struct Surface {
    vec3 position;
    vec3 error;            // the true point is within position +- error on each axis
    vec3 geometricNormal;  // outward, unit
    vec3 shadingNormal;    // outward, in the hemisphere of geometricNormal, unit
    uint object;
    uint primitive;
    uint material;
    vec2 uv;     // texture coordinates; of triangles without their own, the barycentrics
    vec3 color;  // of the vertices, interpolated; white without
};

// False if all shading normals are the geometric ones.
const bool kHasShadingNormals = FEATURE_VERTEX_NORMALS;

// The point anchor + offset with the outward unit normal. `offset` errs by gamma_5, and the sum rounds once
// more (PBRT 4th ed., sec. 6.8.5).
void setPoint(vec3 anchor, vec3 offset, vec3 normal, inout Surface surface) {
    surface.position = anchor + offset;
    surface.error = gammaBound(7.0) * (abs(offset) + abs(anchor));
    surface.geometricNormal = normal;
    surface.shadingNormal = normal;
}

// The same of o + t d moved back onto the plane through `anchor`: an offset from a far one would lose digits
// along the plane. The product with the normal errs by gamma_4 of the distance, the subtractions by a unit.
void setPointOnPlane(Ray ray, float t, vec3 anchor, vec3 normal, inout Surface surface) {
    precise vec3 position = ray.origin + t * ray.direction;
    precise vec3 projected = position - dot(normal, position - anchor) * normal;
    setPoint(anchor, projected, normal, surface);
    surface.position = projected;
}

void setOwner(uint object, uint primitive, uint material, inout Surface surface) {
    surface.object = object;
    surface.primitive = primitive;
    surface.material = material;
}

// If a line hits two surfaces at one t, kernels that count surfaces must keep both. The same holds for
// kernels that decide per surface whether light enters or leaves a medium. The normal does not distinguish
// them if rounding decides its sign. Hit.u is the side: of spheres in these kernels, of quadrics in all.
#ifndef GLINT_CROSSINGS
#define GLINT_CROSSINGS false
#endif
#ifndef GLINT_SHADOW_RAYS
#define GLINT_SHADOW_RAYS false
#endif
const bool kTellsSides = GLINT_SHADOW_RAYS && FEATURE_COLORED_SHADOWS;
const bool kCountsSurfaces = GLINT_CROSSINGS || kTellsSides;
const float kComesIn = 1.0, kLeaves = 2.0;

// The t of a surface that a line hits after one at `before`, counted from 0: a line that touches a surface in
// one point enters and leaves it there.
float afterT(float before, float t) {
    bool same = kCountsSurfaces && before > 0.0 && t <= before;
    return same ? uintBitsToFloat(floatBitsToUint(before) + 1u) : t;
}

// ---- Into the coordinates of an instance and back (docs/design/numerics.md 2.8) ----

// From the ray in the world. The direction keeps its length, so that t is the world's. The difference comes
// first, so that errors grow with the distance to the instance, not with coordinates.
void enterInstance(Instance instance, inout vec3 origin, inout vec3 direction) {
    precise vec3 away = origin - instance.place;
    origin = timesRows(instance.toObjectX, instance.toObjectY, instance.toObjectZ, away);
    direction = timesRows(instance.toObjectX, instance.toObjectY, instance.toObjectZ, direction);
}

// RayFrame::slip: each coordinate of the origin errs by gamma_5 of the magnitudes that it sums, in any
// direction by at most sqrt(3) of the greatest.
float slipOfWayIn(Instance instance, vec3 origin) {
    precise vec3 away = abs(origin - instance.place);
    precise vec3 sums =
        timesRows(abs(instance.toObjectX), abs(instance.toObjectY), abs(instance.toObjectZ), away);
    return 9.0 * kUnit * greatestComponent(sums);
}

// Normals go by the inverse transpose: by W^T.
vec3 turnNormal(Instance instance, vec3 normal) {
    precise vec3 n =
        normal.x * instance.toObjectX + normal.y * instance.toObjectY + normal.z * instance.toObjectZ;
    return n;
}

// Unit, or zero for zero; scaled first, as squares of a scale could overflow.
vec3 normalInWorld(Instance instance, vec3 normal) {
    vec3 n = turnNormal(instance, normal);
    float size = greatestComponent(n);
    vec3 scaled = size > 0.0 ? quotient(n, size) : n;
    return quotient(scaled, size > 0.0 ? length(scaled) : 1.0);
}

// The length that a unit normal comes to have, up to a factor that is the same for all.
float stretchOfNormal(Instance instance, vec3 normal) {
    float unit = larger(greatestComponent(instance.toObjectX),
                        larger(greatestComponent(instance.toObjectY), greatestComponent(instance.toObjectZ)));
    return max(length(quotient(turnNormal(instance, normal), unit)), 1e-30);
}

// A point with its error box. Rounding of the matrix, of products, sums and of adding the place: gamma_5 of
// the sum of magnitudes (PBRT 4th ed., sec. 6.8). A ray that starts there must be on the same side of the
// surface in the instance's coordinates, too, and is rounded into them by gamma_4 of |W| |x - place|.
void leaveInstance(Instance instance, inout vec3 position, inout vec3 error) {
    vec3 away = timesRows(instance.toWorldX, instance.toWorldY, instance.toWorldZ, position);
    vec3 entered =
        timesRows(abs(instance.toObjectX), abs(instance.toObjectY), abs(instance.toObjectZ), abs(away));
    vec3 inObject = error + gammaBound(5.0) * abs(position) + gammaBound(5.0) * entered;
    vec3 inWorld =
        timesRows(abs(instance.toWorldX), abs(instance.toWorldY), abs(instance.toWorldZ), inObject);
    position = away + instance.place;
    error = (1.0 + gammaBound(5.0)) * inWorld + gammaBound(2.0) * abs(instance.place);
}

#endif
