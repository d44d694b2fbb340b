// Which surface a ray meets first, where that is beyond doubt: of the scene and the ray as they were given,
// in exact arithmetic, whatever was rounded on the way to the device and here. Each triangle, plane or side
// of a sphere that the ray may meet has a span of t that its hit lies in if there is one. A ray is certain of
// its nearest hit if that surface is hit for sure and no other span begins before this one ends; else the
// host decides (src/reference/certain).
//
// With u = 2^-24, a point x of the space that the ray is in (its axes turned, z along the ray) and the corner
// a = x - o: rounding the corner, the origin and their difference leaves 2 u |o| + 2 u |a| of error on each
// axis; a direction's components err by u of themselves, so the shear, at most 1 in size, by 5 u; the product
// with depth and the difference by a unit each. A corner's place across the ray has two axes' errors, so it
// errs by
//     e = offset + spread depth + kAcross reach,     reach the greatest such coordinate of the three corners
// with 4 u |o|, 10 u and 3 u in them, as |a| <= depth + reach. An edge function, the difference of two
// products of such places, then errs by 4 e reach + 2 e^2 and four units of reach^2, which e reach exceeds.
// What is more in the constants is for the rounding of these bounds.
#ifndef GLINT_CERTAINTY_GLSL
#define GLINT_CERTAINTY_GLSL

#include "primitives/sphere.glsl"
#include "primitives/triangle.glsl"
#include "storage.glsl"

struct Certainty {
    float slack;  // what the host's own rounding adds to places in the world: of the origin and the corners
    float boxSlack;  // how far surfaces without corners may stand out of boxes around their rounded form
    float offset;    // see above, of the space that the ray is in
    float spread;
    float lower;   // where the best hit's span begins; it ends at Ray::tMax
    float threat;  // where the first span of another surface begins
};

const float kAcross = 4.0 * kUnit;
const float kSpread = 12.0 * kUnit;
const float kAlike = 4.0 * kUnit;  // the ends of the interval are rounded too

// Products this small are rounded by more than a unit of themselves.
const float kLeastDoubt = 1e-36;
// Differences too.
const float kLeastOffset = 1e-36;

float offsetInWorld(vec3 origin, float slack) {
    vec3 size = abs(origin);
    return 5.0 * kUnit * larger(size.x, larger(size.y, size.z)) + 4.0 * slack + kLeastOffset;
}

Certainty beginCertainty(Ray ray, float slack, float boxSlack) {
    Certainty c;
    c.slack = slack;
    c.boxSlack = boxSlack;
    c.offset = offsetInWorld(ray.origin, slack);
    c.spread = kSpread;
    c.lower = 0.0;
    c.threat = kInfinity;
    return c;
}

// By how much the world's boxes are wider than what was rounded: all errors of a point but those that go with
// its distance along an axis, for which there is room in kFarPad.
float boxPad(Certainty c) { return c.offset + c.boxSlack; }

float greatestSum(vec3 x, vec3 y, vec3 z) {
    vec3 one = vec3(1.0);
    return larger(dot(abs(x), one), larger(dot(abs(y), one), dot(abs(z), one)));
}

float greatestOfBox(vec3 lo, vec3 hi) {
    vec3 size = mix(vec3(0.0), max(abs(lo), abs(hi)), lessThanEqual(lo, hi));
    return larger(size.x, larger(size.y, size.z));
}

// Into an instance the difference x - place, the products and sums with the rows of W as rounded err by
// gamma_8 of |W| |x - place|, the direction by as much of |W| |d|, and what was off in the world by |W| times
// that. Returns how much wider boxes are there: the direction's error tells at the distance of what lies in
// the instance's tree, whose root is loaded for that.
float enterWithErrors(inout Certainty c, Ray world, Ray ray, Instance instance, bool toWorld,
                      float worldPad) {
    vec3 origin = abs(world.origin);
    vec3 place = abs(instance.place);
    vec3 away = abs(world.origin - instance.place);
    vec3 direction = abs(world.direction);
    vec3 inside = abs(ray.direction);
    float size = larger(origin.x, larger(origin.y, origin.z));
    float outside = 8.0 * kUnit * size + 4.0 * c.slack + kLeastOffset;
    float rows = greatestSum(instance.toObjectX, instance.toObjectY, instance.toObjectZ);
    float turned = rows * larger(direction.x, larger(direction.y, direction.z));
    float stretch = quotient(turned, larger(inside.x, larger(inside.y, inside.z)));
    float moved = rows * (outside + 4.0 * kUnit * larger(place.x, larger(place.y, place.z)) +
                          16.0 * kUnit * larger(away.x, larger(away.y, away.z)));
    vec3 own = abs(ray.origin);
    float ownSize = larger(own.x, larger(own.y, own.z));
    c.offset = toWorld ? offsetInWorld(world.origin, c.slack) : moved + 8.0 * kUnit * ownSize + kLeastOffset;
    c.spread = toWorld ? kSpread : 2.0 * kSpread + 32.0 * kUnit * stretch;
    Node root = loadNode(instance.root);
    float reach = larger(greatestOfBox(root.lo0, root.hi0), greatestOfBox(root.lo1, root.hi1));
    return toWorld ? worldPad : c.offset + c.spread * (ownSize + reach);
}

// Where a surface may be met. sure: it is met, within the ray's interval, up to the best hit so far.
struct Span {
    float lower, upper;
    float t, u, v;
    bool possible, sure;
};

Span spanBetween(Ray ray, float lower, float upper, float t, bool met, bool missed) {
    float least = larger(ray.tMin, 0.0);
    float from = least * (1.0 - kAlike);
    float until = ray.tMax * (1.0 + kAlike);
    Span span;
    span.lower = lower > from && lower < 1e38 ? lower : from;  // for NaN too
    span.upper = upper;
    span.t = t;
    span.u = 0.0;
    span.v = 0.0;
    span.possible = !missed && !(upper < from) && !(span.lower > until);
    span.sure = met && lower > least * (1.0 + kAlike) && upper <= ray.tMax * (1.0 - kAlike) && span.possible;
    return span;
}

// Of a triangle whose corners are a, b and d as seen from the origin, turned.
Span spanOfTurned(Certainty c, Ray ray, RayFrame frame, vec3 a, vec3 b, vec3 d) {
    SeenTriangle seen = seenAlong(frame, a, b, d);
    float depth = larger(abs(a.z), larger(abs(b.z), abs(d.z)));
    vec2 across = abs(seen.a);
    across = mix(across, abs(seen.b), greaterThan(abs(seen.b), across));
    across = mix(across, abs(seen.c), greaterThan(abs(seen.c), across));
    float reach = larger(across.x, across.y);
    precise float e = c.offset + c.spread * depth + kAcross * reach;
    precise float doubt = e * (5.5 * reach + 2.0 * e) + kLeastDoubt;

    float least = seen.ea < seen.eb ? seen.ea : seen.eb;
    least = seen.ec < least ? seen.ec : least;
    float most = larger(seen.ea, larger(seen.eb, seen.ec));
    bool met = least > doubt || most < -doubt;
    bool missed = least < -doubt && most > doubt;

    precise float az = frame.shear.z * a.z;
    precise float bz = frame.shear.z * b.z;
    precise float cz = frame.shear.z * d.z;
    float nearest = az < bz ? az : bz;
    nearest = cz < nearest ? cz : nearest;
    float farthest = larger(az, larger(bz, cz));
    // Of each corner's t; and, where the triangle is met, of the hit's: the weights, quotients of edge
    // functions by their sum, err by twice three doubts of that sum together.
    precise float along = abs(frame.shear.z) * (c.offset + c.spread * depth);
    precise float det = seen.ea + seen.eb + seen.ec;
    precise float inverse = quotient(1.0, det);
    precise float u = seen.eb * inverse;
    precise float v = seen.ec * inverse;
    precise float t = seen.ea * inverse * az + u * bz + v * cz;
    precise float off = 7.0 * doubt * abs(inverse) * (farthest - nearest) + along +
                        16.0 * kUnit * larger(abs(nearest), abs(farthest));
    precise float below = (met ? t - off : nearest - along);
    precise float above = (met ? t + off : farthest + along);
    Span span = spanBetween(ray, below, above, t, met, missed);
    span.u = u;
    span.v = v;
    return span;
}

Span spanOf(Certainty c, Ray ray, RayFrame frame, Triangle triangle) {
    precise vec3 a = turnToZ(triangle.v0 - ray.origin, frame.axis);
    precise vec3 b = turnToZ(triangle.v1 - ray.origin, frame.axis);
    precise vec3 d = turnToZ(triangle.v2 - ray.origin, frame.axis);
    return spanOfTurned(c, ray, frame, a, b, d);
}

// n (x - p) = 0: n, of unit length, errs by u in each component, p as corners do.
Span spanOf(Certainty c, Ray ray, Plane plane) {
    precise vec3 away = plane.point - ray.origin;
    precise float height = dot(plane.normal, away);
    precise float speed = dot(plane.normal, ray.direction);
    vec3 normal = abs(plane.normal);
    vec3 size = abs(away);
    precise float heightOff = 8.0 * kUnit * dot(normal, size) + 2.0 * c.offset +
                              4.0 * kUnit * larger(size.x, larger(size.y, size.z));
    precise float speedOff = 8.0 * kUnit * dot(normal, abs(ray.direction));
    bool met = abs(speed) > 2.0 * speedOff;
    precise float t = quotient(height, speed);
    precise float off = quotient(heightOff + abs(t) * speedOff, abs(speed) - speedOff) + 4.0 * kUnit * abs(t);
    return spanBetween(ray, met ? t - off : 0.0, met ? t + off : kInfinity, t, met, false);
}

// Where the ray comes into a sphere and where it leaves it. The way f to the centre errs as corners do, by
// offset + 2 u |f| on each axis, which is less than twice that in all, and the radius r by u r. Of b, how far
// along the ray the centre is, and of p, the way from there to the centre, the direction's roundings, the
// quotient's, the products' and the sums' take 22 u |f|. So b, |p| and r err by less than
//     e = 2 offset + 32 u (|f| + r),
// D = r^2 - |p|^2 by e (2 s + e) and eight units of s^2, s the greater of |p| and r; its root and the
// quotients by the direction's length by units of themselves.
struct SphereSpans {
    Span near, far;
};
SphereSpans spansOf(Certainty c, Ray ray, Sphere sphere) {
    precise vec3 f = sphere.point - ray.origin;
    precise float square = dot(ray.direction, ray.direction);
    precise float middle = quotient(dot(f, ray.direction), square);
    precise vec3 beside = f - middle * ray.direction;
    precise float besideSquare = dot(beside, beside);
    precise float inverse = quotient(1.0, squareRoot(square));
    precise float e = 2.0 * c.offset + 32.0 * kUnit * (squareRoot(dot(f, f)) + sphere.radius);
    precise float s = larger(squareRoot(besideSquare), sphere.radius);
    precise float rest = sphere.radius * sphere.radius - besideSquare;
    precise float restOff = e * (3.0 * s + 2.0 * e) + 8.0 * kUnit * s * s + kLeastDoubt;
    bool met = rest > restOff;
    bool missed = rest < -restOff;
    precise float least = squareRoot(larger(rest - restOff, 0.0)) * inverse;
    precise float most = squareRoot(larger(rest + restOff, 0.0)) * inverse;
    precise float off = e * inverse + 16.0 * kUnit * (abs(middle) + most);
    SphereSpans spans;
    spans.near = spanBetween(ray, middle - most - off, middle - least + off, middle - 0.5 * (least + most),
                             met, missed);
    spans.far = spanBetween(ray, middle + least - off, middle + most + off, middle + 0.5 * (least + most),
                            met, missed);
    return spans;
}

void doubtAll(inout Certainty c) { c.threat = 0.0; }

// Whether the span is that of a new best hit, whose span ends at `end` so far. Of two surfaces the other one
// is a threat; a triangle in a further place (id: the best hit's) is not.
bool weigh(inout Certainty c, Hit best, float end, Span span, uint id) {
    bool found = best.primitive != kNone;
    bool same = found && id == best.id;
    bool better = span.sure && !FEATURE_ALPHA_MASK && span.upper < end;
    float other = better ? (found ? c.lower : kInfinity) : span.lower;
    bool counts = span.possible && !same && other < c.threat;
    if (counts) c.threat = other;
    if (better) c.lower = span.lower;
    return better;
}

bool isCertain(Certainty c, Hit best, float end) {
    return best.primitive == kNone ? c.threat >= kInfinity : c.threat > end;
}

#endif
