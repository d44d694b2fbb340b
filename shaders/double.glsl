// Triangles, spheres and planes in double precision, of the rays and primitives that are stored in single:
// what fp32's arithmetic costs, for `glint report` (docs/lab/accuracy.md). t, u and v are rounded once, at
// the end. In kernels of their own (GLINT_FP64), as a module that holds a double needs the device's
// shaderFloat64, used or not.
#ifndef GLINT_DOUBLE_GLSL
#define GLINT_DOUBLE_GLSL

#include "ray.glsl"
#include "storage.glsl"

dvec3 turnedInDouble(vec3 vertex, Ray ray, uint axis) {
    precise dvec3 v = dvec3(vertex) - dvec3(ray.origin);
    return axis == 0u ? v.yzx : (axis == 1u ? v.zxy : v);
}

// SeenTriangle (intersect.glsl), with another number type and the shear worked out anew, and the edges'
// products.
struct DoubleTriangle {
    dvec2 a, b, c;
    dvec3 z;
    double ea, eb, ec;
    double shear;
};
DoubleTriangle seenInDouble(Ray ray, Triangle triangle) {
    vec3 size = abs(ray.direction);
    uint axis = size.x > size.y ? (size.x > size.z ? 0u : 2u) : (size.y > size.z ? 1u : 2u);
    dvec3 direction = dvec3(ray.direction);
    dvec3 d = axis == 0u ? direction.yzx : (axis == 1u ? direction.zxy : direction);
    precise dvec3 shear = dvec3(d.x / d.z, d.y / d.z, 1.0lf / d.z);
    dvec3 a = turnedInDouble(triangle.v0, ray, axis);
    dvec3 b = turnedInDouble(triangle.v1, ray, axis);
    dvec3 c = turnedInDouble(triangle.v2, ray, axis);
    precise dvec2 a2 = a.xy - shear.xy * a.z;
    precise dvec2 b2 = b.xy - shear.xy * b.z;
    precise dvec2 c2 = c.xy - shear.xy * c.z;
    precise double ea = c2.x * b2.y - c2.y * b2.x;
    precise double eb = a2.x * c2.y - a2.y * c2.x;
    precise double ec = b2.x * a2.y - b2.y * a2.x;
    return DoubleTriangle(a2, b2, c2, dvec3(a.z, b.z, c.z), ea, eb, ec, shear.z);
}

bool triangleInDouble(Ray ray, Triangle triangle, out float t, out float u, out float v) {
    DoubleTriangle s = seenInDouble(ray, triangle);
    precise double det = s.ea + s.eb + s.ec;
    precise double height = s.ea * s.z.x + s.eb * s.z.y + s.ec * s.z.z;
    precise double tHit = height * s.shear / det;
    precise double uHit = s.eb / det;
    precise double vHit = s.ec / det;
    t = float(tHit);
    u = float(uHit);
    v = float(vHit);
    bool inside = (s.ea >= 0.0lf && s.eb >= 0.0lf && s.ec >= 0.0lf) ||
                  (s.ea <= 0.0lf && s.eb <= 0.0lf && s.ec <= 0.0lf);
    return inside && det != 0.0lf && t > 0.0 && t > ray.tMin && t <= ray.tMax;
}

// sideOfEdge and crossesTriangle (intersect.glsl).
bool isLeft(double product, dvec2 p, dvec2 q) {
    double moved = p.y != q.y ? p.y - q.y : q.x - p.x;
    return (product != 0.0lf ? product : moved) > 0.0lf;
}
bool crossesInDouble(Ray ray, Triangle triangle) {
    DoubleTriangle s = seenInDouble(ray, triangle);
    bool left = isLeft(s.ea, s.c, s.b);
    return left == isLeft(s.eb, s.a, s.c) && left == isLeft(s.ec, s.b, s.a);
}

// intersectSphere and nearestRoot.
bool sphereInDouble(Ray ray, Sphere sphere, bool own, out float t) {
    dvec3 d = dvec3(ray.direction);
    precise dvec3 o = dvec3(ray.origin) - dvec3(sphere.point);
    double radius = double(sphere.radius);
    precise double a = dot(d, d);
    precise double b = dot(o, d);
    precise dvec3 perpendicular = o - (b / a) * d;
    precise double disc = a * (radius * radius - dot(perpendicular, perpendicular));
    precise double c = dot(o, o) - radius * radius;
    if (FEATURE_ANCHORED_SPHERES && sphere.anchorNormal != vec3(0.0)) {
        dvec3 n = dvec3(sphere.anchorNormal);
        precise double anchoredB = b + radius * dot(n, d);
        precise double anchoredC = dot(o, o) + 2.0lf * radius * dot(o, n);
        precise double anchoredDisc = anchoredB * anchoredB - a * anchoredC;
        b = anchoredB;
        c = anchoredC;
        disc = anchoredDisc;
    }
    if (own) {
        precise double square = b * b;
        c = 0.0lf;
        disc = square;
    }
    precise double root = sqrt(disc > 0.0lf ? disc : 0.0lf);
    precise double q = -(b + (b < 0.0lf ? -root : root));
    precise double r0 = c / q;
    precise double r1 = q / a;
    float lower = float(r0 < r1 ? r0 : r1);
    float upper = float(r0 < r1 ? r1 : r0);
    bool lowerIn = lower > ray.tMin && lower <= ray.tMax;
    bool upperIn = upper > ray.tMin && upper <= ray.tMax;
    t = lowerIn ? lower : upper;
    return disc >= 0.0lf && q != 0.0lf && (lowerIn || upperIn);
}

bool planeInDouble(Ray ray, Plane plane, out float t) {
    dvec3 n = dvec3(plane.normal);
    precise double speed = dot(n, dvec3(ray.direction));
    precise double tHit = dot(n, dvec3(plane.point) - dvec3(ray.origin)) / speed;
    t = float(tHit);
    return speed != 0.0lf && t > ray.tMin && t <= ray.tMax;
}

#endif
