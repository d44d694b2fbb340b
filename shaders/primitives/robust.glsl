// Rays hit triangles and spheres by the robust tests: for kernels that do not offer primitives/textbook.glsl.
#ifndef GLINT_ROBUST_GLSL
#define GLINT_ROBUST_GLSL

#include "primitives/sphere.glsl"
#include "primitives/triangle.glsl"

bool meetTriangle(Ray ray, RayFrame frame, Triangle triangle, vec3 normal, out float t, out float u,
                  out float v) {
    return intersectTriangle(ray, frame, triangle, normal, t, u, v);
}

bool crossesOnce(Ray ray, RayFrame frame, Triangle triangle) { return crossesTriangle(ray, frame, triangle); }

bool hitSphere(Ray ray, RayFrame frame, Sphere sphere, uint primitive, inout uint trips, out Hit hit) {
    return intersectSphere(ray, frame, sphere, primitive, hit);
}

#endif
