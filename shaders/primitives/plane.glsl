// Planes. The reference's own version is in src/reference/intersect.cpp.
#ifndef GLINT_PRIMITIVES_PLANE_GLSL
#define GLINT_PRIMITIVES_PLANE_GLSL

#include "primitives/surface.glsl"
#include "primitives/textbook.glsl"

// t from an anchor point, not from a stored plane constant: a distant constant would cancel.
bool intersectPlane(Ray ray, RayFrame frame, Plane plane, out float t) {
    precise vec3 toPoint = plane.point - ray.origin;
    precise float speed = dot(plane.normal, ray.direction);
    precise float height = dot(plane.normal, toPoint);
    precise float tHit = quotient(height, speed);
    t = tHit;
    tSlip = slipOfFlat(frame, plane.normal, plane.point, toPoint, ray.direction, tHit, speed);
    return speed != 0.0 && countsAt(ray, tHit);
}

bool hitPlane(Ray ray, RayFrame frame, Plane plane, uint primitive, inout uint trips, out Hit hit) {
    float t;
    bool isHit = intersectPlane(ray, frame, plane, t);
    hit = Hit(t, 0.0, 0.0, primitive, kNone, plane.id);
    return isHit;
}

void surfaceOfPlane(Ray ray, Hit hit, Plane plane, inout Surface surface) {
    precise vec3 position = ray.origin + hit.t * ray.direction;
    precise vec3 projected = position - dot(plane.normal, position - plane.point) * plane.normal;
    surface.position = projected;
    surface.error = gammaBound(7.0) * (abs(projected) + abs(plane.point));
    surface.geometricNormal = plane.normal;
    surface.shadingNormal = plane.normal;
}

#endif
