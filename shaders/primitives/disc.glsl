// Discs. The reference's own version is in src/reference/intersect.cpp.
#ifndef GLINT_PRIMITIVES_DISC_GLSL
#define GLINT_PRIMITIVES_DISC_GLSL

#include "primitives/surface.glsl"

// The plane's t, then the distance from the centre of the point there. Both parts of it are of the size of
// the ray's way to the disc, not of the coordinates.
bool intersectDisc(Ray ray, RayFrame frame, Disc disc, out float t) {
    precise vec3 toCenter = disc.center - ray.origin;
    precise float speed = dot(disc.normal, ray.direction);
    precise float height = dot(disc.normal, toCenter);
    precise float tHit = quotient(height, speed);
    precise vec3 offset = tHit * ray.direction - toCenter;
    precise float square = dot(offset, offset);
    precise float limit = disc.radius * disc.radius;
    t = tHit;
    tSlip = slipOfFlat(frame, disc.normal, disc.center, toCenter, ray.direction, tHit, speed);
    return speed != 0.0 && square <= limit && countsAt(ray, tHit);
}

bool hitDisc(Ray ray, RayFrame frame, Disc disc, uint primitive, inout uint trips, out Hit hit) {
    float t;
    bool isHit = intersectDisc(ray, frame, disc, t);
    hit = Hit(t, 0.0, 0.0, primitive, kNone, disc.id);
    return isHit;
}

void surfaceOfDisc(Ray ray, Hit hit, Disc disc, inout Surface surface) {
    flatSurface(ray, hit, disc.center, disc.normal, surface);
}

#endif
