// Rays hit triangles and spheres by the robust tests: for kernels that do not offer primitives/textbook.glsl.
#ifndef GLINT_ROBUST_GLSL
#define GLINT_ROBUST_GLSL

#include "primitives/sphere.glsl"
#include "primitives/triangle.glsl"

bool hitTriangle(Ray ray, RayFrame frame, Triangle triangle, uint primitive, inout uint trips, out Hit hit) {
    float t, u, v;
    vec3 normal = loadTriangleSurface(primitive & kPrimitiveIndexMask).normal;
    bool isHit = intersectTriangle(ray, frame, triangle, normal, t, u, v);
    if (FEATURE_COLORED_SHADOWS) crossesHere = crossesTriangle(ray, frame, triangle);
    hit = Hit(t, u, v, primitive, kNone, triangle.id);
    return isHit;
}

bool hitSphere(Ray ray, RayFrame frame, Sphere sphere, uint primitive, inout uint trips, out Hit hit) {
    return intersectSphere(ray, frame, sphere, primitive, hit);
}

#endif
