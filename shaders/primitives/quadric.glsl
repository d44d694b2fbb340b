// Quadrics: the ray's hit with the side or a cap, and the surface there. The reference's own versions are in
// src/reference/primitives/quadric.cpp.
#ifndef GLINT_PRIMITIVES_QUADRIC_GLSL
#define GLINT_PRIMITIVES_QUADRIC_GLSL

#include "primitives/cuboid.glsl"

const float kNowhere = 1e37;  // farther along a ray than any box: no crossing

vec3 toLocal(Quadric q, vec3 v) { return timesRows(q.toLocal0, q.toLocal1, q.toLocal2, v); }

// Q y
vec3 bilinear(vec3 squares, vec3 products, vec3 y) {
    return squares * y + vec3(products.z * y.y + products.y * y.z, products.z * y.x + products.x * y.z,
                              products.y * y.x + products.x * y.y);
}
vec3 magnitudesBilinear(Quadric q, vec3 y) { return bilinear(abs(q.squares), abs(q.products), y); }

// A point and the equation that loses least there: y.Qy + 2 linear.y + constant = 0.
struct QuadricPlace {
    vec3 y, linear;
    float constant;
};

// A cone with a tip is measured from near the eye, where sums err by 2 sqrt(n(y) n(a)) of their rounding,
// n(y) the sum of the magnitudes of y.Qy, or from its apex, where they err by n(y + a).
QuadricPlace placeOf(Quadric q, vec3 y) {
    QuadricPlace place = QuadricPlace(y, q.linear, q.constant);
    if ((q.caps & kFromApex) != 0u) {
        precise vec3 fromApex = y + q.linear;
        precise float near = dot(abs(y), magnitudesBilinear(q, abs(y)));
        precise float far = dot(abs(fromApex), magnitudesBilinear(q, abs(fromApex)));
        bool isNear = 16.0 * near < far;
        vec3 slope = bilinear(q.squares, q.products, q.linear);
        place = QuadricPlace(isNear ? y : fromApex, isNear ? slope : vec3(0.0), isNear ? q.constant : 0.0);
    }
    return place;
}

// The coefficients B and C of a line's equation A t^2 + 2 B t + C = 0, t counted from y. image: Q d.
struct QuadricEquation {
    QuadricPlace at;
    vec3 form;
    float B, C;
};

QuadricEquation equationAt(Quadric q, vec3 y, vec3 d, vec3 image) {
    precise QuadricEquation e;
    e.at = placeOf(q, y);
    e.B = dot(e.at.y, image) + dot(e.at.linear, d);
    e.form = bilinear(q.squares, q.products, e.at.y) + 2.0 * e.at.linear;
    e.C = dot(e.at.y, e.form) + e.at.constant;
    return e;
}

// Interval in which a line crosses a box, and which of the two planes that may be capped bound it.
struct QuadricSpan {
    float enter, leave;
    bool byCap, toCap;         // it enters, or leaves, through a plane y.z that is capped
    uint firstCap, secondCap;  // the part of the plane y.z that comes first, and last
};

QuadricSpan passThrough(Quadric q, vec3 o, vec3 d) {
    // Below 2^-100 of its length a component of d moves the ray by nothing that counts, and 1/d would
    // overflow.
    Slabs slabs = slabsOf(q.lo, q.hi, o, d, 7.9e-31, kNowhere);
    bool upwards = !slabs.backwards.z;
    QuadricSpan p;
    p.firstCap = upwards ? kPartLowerCap : kPartUpperCap;
    p.secondCap = upwards ? kPartUpperCap : kPartLowerCap;
    float nearSides = larger(slabs.near.x, slabs.near.y);
    float farSides = slabs.far.x < slabs.far.y ? slabs.far.x : slabs.far.y;
    bool capFirst = slabs.near.z >= nearSides;
    bool capLast = slabs.far.z <= farSides;
    p.enter = capFirst ? slabs.near.z : nearSides;
    p.leave = capLast ? slabs.far.z : farSides;
    p.byCap = capFirst && !slabs.parallel.z && (q.caps & (upwards ? kCapLower : kCapUpper)) != 0u;
    p.toCap = capLast && !slabs.parallel.z && (q.caps & (upwards ? kCapUpper : kCapLower)) != 0u;
    return p;
}

// Along the line the inside is the interval [lower, upper], or all but what lies between them.
struct Crossings {
    float lower, upper;
    bool between;
};

// Solves A t^2 + 2 B t + C <= 0, with t measured from `start`. The form of the roots avoids cancellation
// (Press et al., Numerical Recipes, sec. 5.6). slack: error bound of B^2 - A C; a line that is tangent within
// it touches the surface.
Crossings crossingsOf(float A, float B, float C, float slack, float start) {
    precise float disc = B * B - A * C;
    bool real = disc >= -slack;
    precise float root = squareRoot(larger(disc, 0.0));
    precise float q = -(B + (B < 0.0 ? -root : root));
    precise float r1 = start + quotient(q, A == 0.0 ? 1.0 : A);
    // If the line is tangent within rounding, both roots are -B / A: C and q hold only rounding error.
    precise float r0 = disc < 0.0 ? r1 : start + (q == 0.0 ? 0.0 : quotient(C, q));
    Crossings c;
    c.between = A > 0.0;
    c.lower = r0 < r1 ? r0 : r1;
    c.upper = r0 < r1 ? r1 : r0;
    if (A == 0.0) {
        // One crossing, out of the inside or into it; without it, all or nothing.
        c.between = B == 0.0 && C >= 0.0;
        c.lower = B > 0.0 ? r0 : (B < 0.0 ? -kNowhere : kNowhere);
        c.upper = B < 0.0 ? r0 : kNowhere;
    } else if (!real) {
        c.lower = kNowhere;
        c.upper = c.between ? -kNowhere : kNowhere;
    }
    return c;
}

struct Candidate {
    float t;
    uint part;
    bool found;
    float side;
    float before;   // t of the surface before, found or not
    float slip;     // of a cap; of a side, the last roundings of t
    float capSlip;  // of the caps, before that of t itself
};

void offer(inout Candidate best, Ray ray, float unit, float t, bool valid, uint part, float side) {
    precise float scaled = t * unit;
    float counted = afterT(best.before, scaled);
    precise float slip = slipOfRounding(counted) + (part == kPartSide ? 0.0 : best.capSlip);
    precise float near = counted - slip;
    bool ahead = counted > 0.0 && (ray.source == kNone || near > 0.0);
    if (valid && !best.found && ahead && counted > ray.tMin)
        best = Candidate(counted, part, true, side, counted, slip, best.capSlip);
    if (kCountsSurfaces && valid) best.before = counted;
}

// The roots and the ends of the box cut the solid out of the line. Surfaces are the ends of what remains: at
// a rim the cap begins exactly where the side ends.
Candidate firstSurface(Ray ray, float unit, QuadricSpan p, Crossings c, float capSlip, bool inwards) {
    Candidate best = Candidate(0.0, kPartSide, false, 0.0, 0.0, 0.0, capSlip);
    // The first stretch inside runs from a to b, the second from e to p.leave.
    float a = c.between ? larger(c.lower, p.enter) : p.enter;
    float end = c.between ? c.upper : c.lower;
    float b = end <= p.leave ? end : p.leave;
    bool sideFirst = c.between && c.lower >= p.enter;
    bool sideLast = end <= p.leave;
    bool any = a <= b;
    offer(best, ray, unit, a, any && !inwards && (sideFirst || p.byCap), sideFirst ? kPartSide : p.firstCap,
          kComesIn);
    offer(best, ray, unit, b, any && (sideLast || p.toCap), sideLast ? kPartSide : p.secondCap, kLeaves);
    bool sideAgain = c.upper >= p.enter;
    float e = sideAgain ? c.upper : p.enter;
    bool second = !c.between && e <= p.leave;
    offer(best, ray, unit, e, second && (sideAgain || p.byCap), sideAgain ? kPartSide : p.firstCap, kComesIn);
    offer(best, ray, unit, p.leave, second && p.toCap, p.secondCap, kLeaves);
    best.found = best.found && p.enter <= p.leave;
    // A ray that starts inwards, but at a rim beyond the way out, leaves at once.
    bool bySide = sideLast && (c.between || c.upper > 0.0);
    if (inwards && !best.found && ray.tMin == 0.0 && (bySide || p.toCap))
        best = Candidate(1e-30, bySide ? kPartSide : p.secondCap, true, kLeaves, 0.0, 0.0, capSlip);
    return best;
}

// tSlip of the caps, as slipOfFlat; their normal is the third row. offset: of the origin from the quadric's
// point; along: the direction in local coordinates.
float slipOfCaps(RayFrame frame, Quadric q, vec3 offset, vec3 along) {
    if (!kSlips) return 0.0;
    vec3 terms = 2.0 * abs(q.point) + 6.0 * abs(offset);
    precise float height = kUnit * (dot(abs(q.toLocal2), terms) + 2.0 * larger(abs(q.lo.z), abs(q.hi.z)));
    return abs(quotient(height + length(q.toLocal2) * frame.slip, along.z == 0.0 ? 1.0 : along.z));
}

// tSlip of the side, from half the equation.
float slipOfSide(Ray ray, RayFrame frame, Quadric q, vec3 offset, vec3 o, vec3 along, float t) {
    precise vec3 y = o + t * along;
    QuadricPlace at = placeOf(q, y);
    vec3 image = bilinear(q.squares, q.products, at.y);
    vec3 slope = image + at.linear;
    vec3 spread = abs(slope.x * q.toLocal0) + abs(slope.y * q.toLocal1) + abs(slope.z * q.toLocal2);
    float sums = dot(abs(at.y), 0.5 * abs(image) + abs(at.linear)) + 0.5 * abs(at.constant);
    return slipOfRound(frame, spread, dot(slope, along), q.point, offset, ray.direction, t, sums);
}

// t is the same in local coordinates. The equation is set up where the ray enters the box. If A C exceeds
// half of B^2 there, it is set up again half way between the roots (-B / A), so that B^2 - A C does not
// cancel. If not, nothing cancels, and the middle may be a million times farther than the nearer root.
bool hitQuadric(Ray ray, RayFrame frame, Quadric q, uint primitive, inout uint trips, out Hit hit) {
    precise vec3 offset = ray.origin - q.point;
    vec3 o = toLocal(q, offset);
    vec3 along = toLocal(q, ray.direction);
    float unit = unitOf(along);
    precise vec3 d = along * unit;
    QuadricSpan p = passThrough(q, o, d);

    vec3 image = bilinear(q.squares, q.products, d);
    precise float A = dot(d, image);
    float begin = larger(p.enter, 0.0);
    QuadricEquation e = equationAt(q, o + begin * d, d, image);
    precise float middle = A * e.C <= 0.5 * e.B * e.B ? 0.0 : quotient(-e.B, A);
    float reach = larger(p.leave - begin, 0.0);
    middle = middle < reach ? larger(middle, 0.0) : reach;
    bool own = (ray.source & ~(kPartMask << kPartShift)) == primitive;
    bool inwards = own && (ray.source & kStartsInwards) != 0u;
    bool fromSide = (ray.source & ~kStartsInwards) == (primitive | (kPartSide << kPartShift));
    precise float start = fromSide ? 0.0 : begin + middle;
    e = equationAt(q, o + start * d, d, image);
    // Sums of magnitudes: B errs by gamma_8 of its own, C by gamma_9.
    precise float magnitudeB = dot(abs(e.at.y), abs(image)) + dot(abs(e.at.linear), abs(d));
    precise float magnitudeC = dot(abs(e.at.y), abs(e.form)) + abs(e.at.constant);
    precise float errorB = gammaBound(8.0) * magnitudeB;
    precise float slack = errorB * errorB + abs(A) * (gammaBound(9.0) * magnitudeC);
    if (fromSide) {
        // The ray starts on the side: C is 0, and the ray decides the sign of B. Its origin, which is moved
        // out of the error box, may lie beyond the far side of a thin body.
        float sense = inwards ? -1.0 : 1.0;
        precise float least = larger(kUnit * errorB, 1e-30);
        e.B = sense * larger(sense * e.B, least);
        e.C = 0.0;
    }
    Crossings c = crossingsOf(A, e.B, e.C, slack, start);
    Candidate best = firstSurface(ray, unit, p, c, slipOfCaps(frame, q, offset, along), inwards);
    tSlip = best.slip;
    if (kSlips && best.found && best.part == kPartSide)
        tSlip = slipOfSide(ray, frame, q, offset, o, along, best.t);
    hit = Hit(best.t, best.side, 0.0, primitive | (best.part << kPartShift), kNone, q.id);
    precise float near = best.t - tSlip;
    return best.found && near <= ray.tMax;
}

// The normal, T^T slope, in steps that do not overflow.
struct QuadricNormal {
    vec3 unit;
    float steepest;  // the greatest component of T^T slope; 1e-30 or less: the surface has no normal there
    float size;      // the length of T^T slope over that
};

QuadricNormal normalOf(Quadric q, vec3 slope) {
    vec3 gradient = slope.x * q.toLocal0 + slope.y * q.toLocal1 + slope.z * q.toLocal2;
    float steepest = greatestComponent(gradient);
    vec3 scaled = quotient(gradient, steepest);
    float size = length(scaled);
    return QuadricNormal(quotient(scaled, size), steepest, size);
}

// Normal at a point where a line touches the side, like towardsRayAtLimb for spheres. hit.u, the side of the
// hit's root, decides whether the line enters or leaves, with respect to the normal at `offset`, where a line
// that passes by within rounding is moved to.
vec3 asTheLineTouches(Ray ray, Hit hit, Quadric q, vec3 y, vec3 offset, vec3 normal) {
    vec3 along = toLocal(q, ray.direction);
    vec3 terms = abs(ray.origin - q.point) + abs(hit.t * ray.direction);
    QuadricPlace at = placeOf(q, y);
    vec3 reach = timesRows(abs(q.toLocal0), abs(q.toLocal1), abs(q.toLocal2), terms);
    vec3 image = magnitudesBilinear(q, reach + abs(at.y - y)) + abs(at.linear);
    float slip = gammaBound(16.0) * dot(image, abs(along));
    if (abs(dot(bilinear(q.squares, q.products, at.y) + at.linear, along)) > slip) return normal;
    QuadricPlace moved = placeOf(q, toLocal(q, offset));
    QuadricNormal there = normalOf(q, bilinear(q.squares, q.products, moved.y) + moved.linear);
    if (there.steepest <= 1e-30) return normal;
    float away = dot(there.unit, ray.direction);
    // A dot product errs by gamma_3: the result exceeds that, so that its sign is certain.
    float square = dot(ray.direction, ray.direction);
    float clear = larger(abs(away), gammaBound(8.0) * squareRoot(square));
    float wanted = hit.u == kLeaves ? clear : -clear;
    return there.unit + quotient(wanted - away, square) * ray.direction;
}

// One Newton step along the gradient from o + t d. The error left along the normal: gamma_12 of the
// magnitudes that the equation sums, and gamma_5 of those of y, over the gradient's length. At a cone's apex
// and on a double plane the gradient vanishes: there the surface faces the ray, and an error e of the
// equation moves it by at most sqrt(e). o + t d itself errs by gamma_8 of its terms along the normal.
void surfaceOfQuadric(Ray ray, Hit hit, Quadric q, Instance instance, inout Surface surface) {
    uint part = (hit.primitive >> kPartShift) & kPartMask;
    precise vec3 offset = (ray.origin - q.point) + hit.t * ray.direction;
    vec3 y = toLocal(q, offset);
    QuadricPlace at = placeOf(q, y);
    vec3 image = bilinear(q.squares, q.products, at.y);
    precise vec3 slope = 2.0 * (image + at.linear);
    precise float value = dot(at.y, image + 2.0 * at.linear) + at.constant;
    float magnitude = dot(abs(at.y), abs(image)) + 2.0 * dot(abs(at.y), abs(at.linear)) + abs(at.constant);
    if (part != kPartSide) {
        bool upper = part == kPartUpperCap;
        slope = vec3(0.0, 0.0, upper ? 1.0 : -1.0);
        value = upper ? y.z - q.hi.z : q.lo.z - y.z;
        magnitude = abs(y.z);
    }
    QuadricNormal there = normalOf(q, slope);
    vec3 normal = quotient(-ray.direction, length(ray.direction));
    float left = 0.0;
    if (there.steepest > 1e-30) {
        float gradient = there.steepest * there.size;
        float perRoot = quotient(length(slope), gradient);
        float error = gammaBound(12.0) * magnitude;
        precise float newton = quotient(quotient(value, there.steepest), there.size);
        vec3 far = abs(ray.origin - q.point) + abs(hit.t * ray.direction);
        float most = squareRoot(error) * perRoot + gammaBound(8.0) * dot(abs(there.unit), far);
        precise float step = part == kPartSide ? clamp(newton, -most, most) : newton;
        normal = there.unit;
        offset -= step * normal;
        vec3 spread = abs(slope.x * q.toLocal0) + abs(slope.y * q.toLocal1) + abs(slope.z * q.toLocal2);
        error += gammaBound(5.0) * dot(spread, abs(offset));
        left = min(quotient(error, gradient), squareRoot(error) * perRoot);
    }
    vec3 facing = part == kPartSide ? asTheLineTouches(ray, hit, q, y, offset, normal) : normal;
    setPoint(q.point, offset, facing, surface);
    surface.error += left * abs(normal);
    setOwner(q.object, q.primitive, q.material, surface);
}

#endif
