// Boxes: axis-aligned ones and, with a frame of their own, what a transform makes of them. The reference's
// own version is in src/reference/primitives/cuboid.cpp.
#ifndef GLINT_PRIMITIVES_CUBOID_GLSL
#define GLINT_PRIMITIVES_CUBOID_GLSL

#include "traversal/ray.glsl"

// The t at which a line enters and leaves each pair of planes of a closed box (Kay, Kajiya, "Ray Tracing
// Complex Scenes", SIGGRAPH 1986).
struct Slabs {
    vec3 near, far;   // t
    vec3 inverse;     // 1/d, 1 if the line is parallel to the planes
    bvec3 backwards;  // d < 0: the line enters through the upper plane
    bvec3 parallel;
};

// A component of d below `least` counts as 0: the line is then between the planes for all t, or for none,
// with `nowhere` in place of infinity.
Slabs slabsOf(vec3 lo, vec3 hi, vec3 o, vec3 d, float least, float nowhere) {
    Slabs s;
    s.parallel = lessThan(abs(d), vec3(least));
    s.inverse = quotient(1.0, mix(d, vec3(1.0), s.parallel));
    precise vec3 toLo = (lo - o) * s.inverse;
    precise vec3 toHi = (hi - o) * s.inverse;
    s.backwards = lessThan(d, vec3(0.0));
    bvec3 outside = greaterThan(max(lo - o, o - hi), vec3(0.0));
    s.near = mix(mix(toLo, toHi, s.backwards), mix(vec3(-nowhere), vec3(nowhere), outside), s.parallel);
    s.far = mix(mix(toHi, toLo, s.backwards), mix(vec3(nowhere), vec3(-nowhere), outside), s.parallel);
    return s;
}

vec3 cuboidLocal(Cuboid cuboid, vec3 v) {
    return timesRows(cuboid.toLocal0, cuboid.toLocal1, cuboid.toLocal2, v);
}

// tSlip of a face. reach: what the origin's coordinates here are off by, in units.
float slipOfFace(Cuboid cuboid, RayFrame frame, vec3 reach, vec3 inverse, uint axis, bool upper, float t) {
    float plane = abs(upper ? cuboid.hi[axis] : cuboid.lo[axis]);
    precise float height = kUnit * (2.0 * plane + reach[axis]) + frame.slip;
    return kSlips ? height * abs(inverse[axis]) + slipOfRounding(t) : 0.0;
}

// The line is inside from the last plane through which it enters to the first through which it leaves. The
// neighbour of a face computes both ends with the same roundings. So no ray slips through an edge or between
// axis-aligned boxes that share a face's plane.
bool hitCuboid(Ray ray, RayFrame frame, Cuboid cuboid, uint primitive, inout uint trips, out Hit hit) {
    precise vec3 offset = ray.origin - cuboid.point;
    vec3 o = cuboidLocal(cuboid, offset);
    vec3 d = cuboidLocal(cuboid, ray.direction);
    Slabs slabs = slabsOf(cuboid.lo, cuboid.hi, o, d, 2.3509887e-38, kInfinity);  // 2^-125: 1/d stays finite
    vec3 near = slabs.near;
    vec3 far = slabs.far;
    uint nearAxis = near.x >= near.y ? (near.x >= near.z ? 0u : 2u) : (near.y >= near.z ? 1u : 2u);
    uint farAxis = far.x <= far.y ? (far.x <= far.z ? 0u : 2u) : (far.y <= far.z ? 1u : 2u);
    float enter = near[nearAxis];
    float leave = far[farAxis];
    bool meets = enter <= leave;
    // A line that touches the box in one point enters and leaves there: the media count both surfaces.
    if (enter > 0.0 && leave == enter) leave = uintBitsToFloat(floatBitsToUint(enter) + 1u);
    // Same bound as slipOfFlat; the rows are the faces' normals.
    precise vec3 terms = 2.0 * abs(cuboid.point) + 6.0 * abs(offset);
    vec3 reach = timesRows(abs(cuboid.toLocal0), abs(cuboid.toLocal1), abs(cuboid.toLocal2), terms);
    bool nearUpper = slabs.backwards[nearAxis];
    bool farUpper = !slabs.backwards[farAxis];
    float enterSlip = slipOfFace(cuboid, frame, reach, slabs.inverse, nearAxis, nearUpper, enter);
    float leaveSlip = slipOfFace(cuboid, frame, reach, slabs.inverse, farAxis, farUpper, leave);
    bool leaves = ray.source != kNone;
    bool first = enter > (leaves ? enterSlip : 0.0) && enter > ray.tMin;
    float t = first ? enter : leave;
    tSlip = first ? enterSlip : leaveSlip;
    uint part = first ? 2u * nearAxis + uint(nearUpper) : 2u * farAxis + uint(farUpper);
    hit = Hit(t, 0.0, 0.0, primitive | (part << kPartShift), kNone, cuboid.id);
    precise float lower = t - tSlip;
    bool ahead = t > (leaves ? tSlip : 0.0) && t > ray.tMin;
    return meets && ahead && lower <= ray.tMax;
}

// o + t d, moved back onto the face as a disc's point is onto its plane. u and v go from 0 to 1 over a face,
// u to the right and v upwards on the sides as seen from outside; on top and bottom u goes along x
// (docs/reference/shading.md).
void surfaceOfCuboid(Ray ray, Hit hit, Cuboid cuboid, Instance instance, inout Surface surface) {
    uint part = (hit.primitive >> kPartShift) & kPartMask;
    uint axis = part >> 1;
    bool upper = (part & 1u) != 0u;
    vec3 row = axis == 0u ? cuboid.toLocal0 : (axis == 1u ? cuboid.toLocal1 : cuboid.toLocal2);
    float plane = upper ? cuboid.hi[axis] : cuboid.lo[axis];
    precise vec3 offset = (ray.origin - cuboid.point) + hit.t * ray.direction;
    precise vec3 projected = offset - (dot(row, offset) - plane) * row;
    setPoint(cuboid.point, projected, upper ? row : -row, surface);
    precise vec3 share = quotient(cuboidLocal(cuboid, projected) - cuboid.lo, cuboid.hi - cuboid.lo);
    precise vec3 rest = 1.0 - share;
    surface.uv = axis == 0u ? vec2(upper ? rest.z : share.z, share.y)
                            : (axis == 1u ? vec2(share.x, upper ? rest.z : share.z)
                                          : vec2(upper ? share.x : rest.x, share.y));
    setOwner(cuboid.object, cuboid.primitive, cuboid.material, surface);
}

#endif
