// Spheres. The reference's own version is in src/reference/primitives/sphere.cpp.
#ifndef GLINT_PRIMITIVES_SPHERE_GLSL
#define GLINT_PRIMITIVES_SPHERE_GLSL

#include "traversal/ray.glsl"

vec3 sphereCenter(Sphere sphere) {
    return FEATURE_ANCHORED_SPHERES ? sphere.point - sphere.radius * sphere.anchorNormal : sphere.point;
}

// The first root of a (t / unit)^2 + 2 b t / unit + c = 0 after tMin, by the form that cancels nothing (Press
// et al., Numerical Recipes, sec. 5.6). disc is b^2 - a c, computed in the way that suits the sphere.
bool nearestRoot(Ray ray, float unit, float a, float b, float c, float disc, out float t, out float side) {
    precise float root = squareRoot(max(disc, 0.0));
    precise float q = -(b + (b < 0.0 ? -root : root));
    precise float r0 = unit * quotient(c, q);
    precise float r1 = unit * quotient(q, a);
    float lower = r0 < r1 ? r0 : r1;
    float upper = afterT(lower, r0 < r1 ? r1 : r0);
    bool lowerIn = lower > ray.tMin;
    t = lowerIn ? lower : upper;
    side = lowerIn ? kComesIn : kLeaves;
    return disc >= 0.0 && q != 0.0 && t > ray.tMin;
}

// tSlip: half the equation sums (|y|^2 + r^2) / 2, or (|y|^2 + 2 r n.y) / 2 from an anchor; its gradient has
// the length r. o: from sphere.point to the origin.
float slipOfSphere(Ray ray, RayFrame frame, Sphere sphere, vec3 o, float t) {
    precise vec3 y = o + t * ray.direction;
    float constant = sphere.radius * sphere.radius;
    precise vec3 gradient = y;
    if (FEATURE_ANCHORED_SPHERES && sphere.anchorNormal != vec3(0.0)) {
        constant = 2.0 * sphere.radius * dot(abs(sphere.anchorNormal), abs(y));
        gradient += sphere.radius * sphere.anchorNormal;
    }
    return slipOfRound(frame, abs(gradient), dot(gradient, ray.direction), sphere.point, o, ray.direction, t,
                       0.5 * (dot(y, y) + constant));
}

// Discriminant from the distance of the centre to the ray, as b^2 - a c cancels if the sphere is far away. An
// anchored sphere measures from a point of its surface, as its radius may exceed all distances
// (docs/design/numerics.md 2.4). a times the square of the radius may overflow unless the ray is scaled.
bool intersectSphere(Ray ray, RayFrame frame, Sphere sphere, uint primitive, out Hit hit) {
    precise vec3 o = ray.origin - sphere.point;
    float unit = unitOf(ray.direction);
    precise vec3 d = unit * ray.direction;
    precise float a = dot(d, d);
    precise float b = dot(o, d);
    precise vec3 perpendicular = o - quotient(b, a) * d;
    precise float disc = a * (sphere.radius * sphere.radius - dot(perpendicular, perpendicular));
    precise float c = dot(o, o) - sphere.radius * sphere.radius;
    if (FEATURE_ANCHORED_SPHERES && sphere.anchorNormal != vec3(0.0)) {
        b += sphere.radius * dot(sphere.anchorNormal, d);
        c = dot(o, o) + 2.0 * sphere.radius * dot(o, sphere.anchorNormal);
        disc = b * b - a * c;
    }
    if (primitive == ray.source) {
        // The ray starts on the surface: c is 0, and the start's side decides the sign of b if rounding does:
        // only from inside (c < 0) does the ray hit the sphere again.
        precise vec3 reach = abs(ray.origin) + abs(sphere.point) + sphere.radius * abs(sphere.anchorNormal);
        precise float errorB = gammaBound(8.0) * dot(reach, abs(d));
        if (abs(b) <= errorB) b = c < 0.0 ? -larger(abs(b), kUnit * errorB) : 0.0;
        c = 0.0;
        disc = b * b;
    }
    float t, side;
    bool isHit = nearestRoot(ray, unit, a, b, c, disc, t, side);
    hit = Hit(t, kTellsSides ? side : 0.0, 0.0, primitive, kNone, sphere.id);
    tSlip = isHit ? slipOfSphere(ray, frame, sphere, o, t) : 0.0;
    precise float near = t - tSlip;
    return isHit && near <= ray.tMax;
}

// The test of a leaf's spheres: primitives/robust.glsl, primitives/textbook.glsl or traversal/count.glsl.
bool hitSphere(Ray ray, RayFrame frame, Sphere sphere, uint primitive, inout uint trips, out Hit hit);

// Outward normal of a hit, turned towards the ray at the limb, where the rounding of t alone decides whether
// the normal faces the ray, as from outside it must. t errs by gamma_8 |w| / |d| in any form, so n.d errs by
// gamma_8 |w| / r. A ray that starts on the sphere may leave through it.
vec3 towardsRayAtLimb(Ray ray, Hit hit, Sphere sphere, vec3 outward) {
    vec3 w = ray.origin - sphereCenter(sphere);
    precise vec3 d = unitOf(ray.direction) * ray.direction;
    precise float away = dot(outward, d);
    precise float awaySquare = away * away;
    precise float radiusSquare = sphere.radius * sphere.radius;
    precise float square = dot(w, w);
    precise float size = dot(d, d);
    bool own = ray.source == hit.primitive && ray.sourceInstance == hit.instance;
    precise float sine = quotient(gammaBound(8.0) * gammaBound(8.0) * size * square, radiusSquare);
    bool isLimb = away > 0.0 && awaySquare <= sine && !(own && SPHERE_FORM == kSphereRobust);
    return isLimb && square > radiusSquare ? outward - quotient(2.0 * away, size) * d : outward;
}

// The point o + t d is moved back to the sphere.
void surfaceOfSphere(Ray ray, Hit hit, Sphere sphere, Instance instance, inout Surface surface) {
    precise vec3 offset = (ray.origin - sphere.point) + hit.t * ray.direction;
    precise vec3 outward = quotient(offset, length(offset));
    precise vec3 scaled = outward * sphere.radius;
    if (FEATURE_ANCHORED_SPHERES && sphere.anchorNormal != vec3(0.0)) {
        // One Newton step along the normal on |x|^2 + 2 r n.x = 0, x measured from the anchor.
        precise vec3 away = quotient(offset, sphere.radius) + sphere.anchorNormal;
        precise float height =
            quotient(dot(offset, offset), 2.0 * sphere.radius) + dot(offset, sphere.anchorNormal);
        outward = quotient(away, length(away));
        scaled = offset - height * outward;
    }
    setPoint(sphere.point, scaled, towardsRayAtLimb(ray, hit, sphere, outward), surface);
    setOwner(sphere.object, sphere.primitive, sphere.material, surface);
}

#endif
