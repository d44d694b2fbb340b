// The textbooks' intersection tests, and the choice between them and the robust ones. Each follows its book,
// faults included (docs/guide/numbers-to-trust.md shows where they fail). The choice is a specialization
// constant, so that a pipeline holds only the chosen test. Only intersect.comp and light.comp offer it: a
// request for a textbook's test excludes packets and whole.comp. The reference has its own tests, from which
// these in double would differ by rounding alone.
#ifndef GLINT_TEXTBOOK_GLSL
#define GLINT_TEXTBOOK_GLSL

#include "primitives/sphere.glsl"
#include "primitives/triangle.glsl"

bool inInterval(Ray ray, float t) { return t > 0.0 && t > ray.tMin && t <= ray.tMax; }

// Cramer's rule with a way out after each unknown (Shirley & Marschner, Fundamentals of Computer Graphics,
// sec. 4.4.2; the same numbers as Moller and Trumbore's, 1997). Each triangle weighs an edge by products of
// its own, so neighbours may both let a ray through.
bool triangleByCramer(Ray ray, Triangle triangle, precise out float t, precise out float u,
                      precise out float v) {
    t = u = v = 0.0;
    precise vec3 p = triangle.v0 - triangle.v1;
    precise vec3 q = triangle.v0 - triangle.v2;
    precise vec3 w = triangle.v0 - ray.origin;
    vec3 d = ray.direction;
    precise float eiHf = q.y * d.z - d.y * q.z;
    precise float gfDi = d.x * q.z - q.x * d.z;
    precise float dhEg = q.x * d.y - q.y * d.x;
    precise float m = p.x * eiHf + p.y * gfDi + p.z * dhEg;
    if (m == 0.0) return false;
    precise float akJb = p.x * w.y - w.x * p.y;
    precise float jcAl = w.x * p.z - p.x * w.z;
    precise float blKc = p.y * w.z - w.y * p.z;
    t = quotient(-(q.z * akJb + q.y * jcAl + q.x * blKc), m);
    if (!inInterval(ray, t)) return false;
    v = quotient(d.z * akJb + d.y * jcAl + d.x * blKc, m);
    if (v < 0.0 || v > 1.0) return false;
    u = quotient(w.x * eiHf + w.y * gfDi + w.z * dhEg, m);
    precise float rest = 1.0 - v;
    return u >= 0.0 && u <= rest;
}

// The plane's point, then inside or not in the coordinate plane that the normal leans to most (Badouel, "An
// Efficient Ray-Polygon Intersection", Graphics Gems, 1990).
bool triangleByProjection(Ray ray, Triangle triangle, precise out float t, precise out float u,
                          precise out float v) {
    precise vec3 e1 = triangle.v1 - triangle.v0;
    precise vec3 e2 = triangle.v2 - triangle.v0;
    precise vec3 n = cross(e1, e2);
    precise float speed = dot(n, ray.direction);
    precise vec3 w = triangle.v0 - ray.origin;
    t = quotient(dot(n, w), speed);
    precise vec3 point = t * ray.direction - w;
    vec3 size = abs(n);
    uint axis = size.x > size.y ? (size.x > size.z ? 0u : 2u) : (size.y > size.z ? 1u : 2u);
    vec2 a = turnToZ(e1, axis).xy;
    vec2 b = turnToZ(e2, axis).xy;
    vec2 p = turnToZ(point, axis).xy;
    precise float area = a.x * b.y - a.y * b.x;
    u = quotient(p.x * b.y - p.y * b.x, area);
    v = quotient(a.x * p.y - a.y * p.x, area);
    precise float sum = u + v;
    return speed != 0.0 && inInterval(ray, t) && u >= 0.0 && v >= 0.0 && sum <= 1.0;
}

// The plane's point, then on which side of each edge it lies, all in space (Shirley & Marschner, sec. 2.9).
bool triangleInSpace(Ray ray, Triangle triangle, precise out float t, out float u, out float v) {
    precise vec3 e0 = triangle.v2 - triangle.v1;
    precise vec3 e1 = triangle.v0 - triangle.v2;
    precise vec3 e2 = triangle.v1 - triangle.v0;
    precise vec3 n = cross(e2, -e1);
    precise float speed = dot(n, ray.direction);
    t = quotient(dot(n, triangle.v0 - ray.origin), speed);
    precise vec3 point = ray.origin + t * ray.direction;
    precise float w0 = dot(n, cross(e0, point - triangle.v1));
    precise float w1 = dot(n, cross(e1, point - triangle.v2));
    precise float w2 = dot(n, cross(e2, point - triangle.v0));
    precise float sum = w0 + w1 + w2;
    u = quotient(w1, sum);
    v = quotient(w2, sum);
    return speed != 0.0 && inInterval(ray, t) && w0 >= 0.0 && w1 >= 0.0 && w2 >= 0.0 && sum > 0.0;
}

bool nearer(Ray ray, float t0, float t1, out float t) {
    t = inInterval(ray, t0) ? t0 : t1;
    return inInterval(ray, t);
}

// (-B +- sqrt(B^2 - 4 A C)) / 2 A. own: the ray starts on this sphere.
bool sphereByEquation(Ray ray, Sphere sphere, bool own, out float t) {
    precise vec3 o = ray.origin - sphereCenter(sphere);
    precise float a = dot(ray.direction, ray.direction);
    precise float b = 2.0 * dot(o, ray.direction);
    precise float c = dot(o, o) - sphere.radius * sphere.radius;
    if (own) c = 0.0;
    precise float disc = b * b - 4.0 * a * c;
    precise float root = own ? abs(b) : squareRoot(larger(disc, 0.0));
    precise float t0 = quotient(-b - root, 2.0 * a);
    precise float t1 = quotient(-b + root, 2.0 * a);
    return nearer(ray, t0, t1, t) && (own || disc >= 0.0);
}

// The closest approach to the centre by Pythagoras, then half the chord (Haines in Glassner, An Introduction
// to Ray Tracing, 1989, ch. 2).
bool sphereByDistance(Ray ray, Sphere sphere, bool own, out float t) {
    precise vec3 w = sphereCenter(sphere) - ray.origin;
    precise float a = dot(ray.direction, ray.direction);
    precise float closest = quotient(dot(w, ray.direction), a);
    precise float square = dot(w, w) - closest * closest * a;
    precise float half2 = quotient(sphere.radius * sphere.radius - square, a);
    precise float chord = own ? abs(closest) : squareRoot(larger(half2, 0.0));
    precise float t0 = closest - chord;
    precise float t1 = closest + chord;
    return nearer(ray, t0, t1, t) && (own || half2 >= 0.0);
}

// ---- The choice ----

bool hitTriangle(Ray ray, RayFrame frame, Triangle triangle, uint primitive, inout uint trips, out Hit hit) {
    float t, u, v;
    vec3 normal = loadTriangleSurface(primitive & kPrimitiveIndexMask).normal;
    bool isHit = INTERSECTOR == kTriangleWatertight ? intersectTriangle(ray, frame, triangle, normal, t, u, v)
                 : INTERSECTOR == kTriangleBarycentric ? triangleByCramer(ray, triangle, t, u, v)
                 : INTERSECTOR == kTriangleProjection  ? triangleByProjection(ray, triangle, t, u, v)
                                                       : triangleInSpace(ray, triangle, t, u, v);
    if (FEATURE_COLORED_SHADOWS) crossesHere = crossesTriangle(ray, frame, triangle);
    if (INTERSECTOR != kTriangleWatertight) {
        crossesHere = true;  // these tests do not agree about an edge, so each triangle counts
        precise vec3 toCorner = triangle.v0 - ray.origin;
        precise float speed = dot(normal, ray.direction);
        tSlip = slipOfFlat(frame, normal, triangle.v0, toCorner, ray.direction, t, speed);
        isHit = isHit && countsAt(ray, t);
    }
    hit = Hit(t, u, v, primitive, kNone, triangle.id);
    return isHit;
}

bool hitSphere(Ray ray, RayFrame frame, Sphere sphere, uint primitive, inout uint trips, out Hit hit) {
    if (SPHERE_FORM == kSphereRobust) return intersectSphere(ray, frame, sphere, primitive, hit);
    bool own = primitive == ray.source;
    float t;
    bool isHit = SPHERE_FORM == kSphereAlgebraic ? sphereByEquation(ray, sphere, own, t)
                                                 : sphereByDistance(ray, sphere, own, t);
    hit = Hit(t, 0.0, 0.0, primitive, kNone, sphere.id);
    tSlip = isHit ? slipOfSphere(ray, frame, sphere, ray.origin - sphere.point, t) : 0.0;
    return isHit;
}

#endif
