// Planes, discs and polygons. The reference's own version is in src/reference/primitives/flat.cpp.
#ifndef GLINT_PRIMITIVES_FLAT_GLSL
#define GLINT_PRIMITIVES_FLAT_GLSL

#include "traversal/ray.glsl"

// The point at which a ray crosses the plane of a flat primitive. t from an anchor point, not from a stored
// plane constant: a distant constant would cancel.
struct PlaneCrossing {
    vec3 toAnchor;
    float speed;  // along the normal
    float t;
};
PlaneCrossing crossPlane(Ray ray, RayFrame frame, vec3 anchor, vec3 normal) {
    precise vec3 toAnchor = anchor - ray.origin;
    precise float speed = dot(normal, ray.direction);
    precise float height = dot(normal, toAnchor);
    precise float t = quotient(height, speed);
    tSlip = slipOfFlat(frame, normal, anchor, toAnchor, ray.direction, t, speed);
    return PlaneCrossing(toAnchor, speed, t);
}

// ---- Planes ----

bool hitPlane(Ray ray, RayFrame frame, Plane plane, uint primitive, inout uint trips, out Hit hit) {
    PlaneCrossing at = crossPlane(ray, frame, plane.point, plane.normal);
    hit = Hit(at.t, 0.0, 0.0, primitive, kNone, plane.id);
    return at.speed != 0.0 && countsAt(ray, at.t);
}

void surfaceOfPlane(Ray ray, Hit hit, Plane plane, Instance instance, inout Surface surface) {
    setPointOnPlane(ray, hit.t, plane.point, plane.normal, surface);
    setOwner(plane.object, plane.primitive, plane.material, surface);
}

// ---- Discs ----

// The plane's t, then the distance from the centre of the point there. Both parts of it are of the size of
// the ray's way to the disc, not of the coordinates.
bool hitDisc(Ray ray, RayFrame frame, Disc disc, uint primitive, inout uint trips, out Hit hit) {
    PlaneCrossing at = crossPlane(ray, frame, disc.center, disc.normal);
    precise vec3 offset = at.t * ray.direction - at.toAnchor;
    precise float square = dot(offset, offset);
    precise float limit = disc.radius * disc.radius;
    hit = Hit(at.t, 0.0, 0.0, primitive, kNone, disc.id);
    return at.speed != 0.0 && square <= limit && countsAt(ray, at.t);
}

void surfaceOfDisc(Ray ray, Hit hit, Disc disc, Instance instance, inout Surface surface) {
    setPointOnPlane(ray, hit.t, disc.center, disc.normal, surface);
    setOwner(disc.object, disc.primitive, disc.material, surface);
}

// ---- Polygons ----

// A vertex in the ray's frame: sheared like the corners of triangles, z its t.
vec3 shearedVertex(Ray ray, RayFrame frame, uint index) {
    precise vec3 v = turnToZ(loadPolygonVertex(index).position - ray.origin, frame.axis);
    precise vec2 xy = v.xy - frame.shear.xy * v.z;
    precise float t = frame.shear.z * v.z;
    return vec3(xy, t);
}

// True if the edge crosses the half line x > 0, y = 0. Half open: if two edges meet on the line, one edge
// counts if they lie on different sides of it, else both or neither. Exchanging a and b changes nothing, so
// polygons that share an edge never disagree on which side of it a ray passes.
bool crosses(vec3 a, vec3 b) {
    precise float edge = a.x * b.y - a.y * b.x;
    bool up = b.y > 0.0;
    return up != (a.y > 0.0) && (up ? edge > 0.0 : edge < 0.0);
}

// Even-odd rule on the outline in projection along the ray. Each edge contributes a bit that depends on the
// edge and the ray alone, so polygons that share an edge leave no gap (docs/design/numerics.md 2.6). t is the
// plane's, clamped to the range of the vertices' t, from which only rounding moves it.
bool hitPolygon(Ray ray, RayFrame frame, Polygon polygon, uint primitive, inout uint trips, out Hit hit) {
    PlaneCrossing at = crossPlane(ray, frame, polygon.point, polygon.normal);
    bool inside = false;
    uint vertex = polygon.firstVertex;
    uint end = vertex + polygon.trips * kPolygonEdgesPerTrip;
    vec3 a = shearedVertex(ray, frame, vertex);
    float least = a.z;
    float greatest = a.z;
    do {
        if (vertex < end) {
            vec3 b = shearedVertex(ray, frame, vertex + 1u);
            vec3 c = shearedVertex(ray, frame, vertex + 2u);
            vec3 d = shearedVertex(ray, frame, vertex + 3u);
            vec3 e = shearedVertex(ray, frame, vertex + 4u);
            bool odd = (crosses(a, b) != crosses(b, c)) != (crosses(c, d) != crosses(d, e));
            inside = inside != odd;
            least = min(least, min(min(b.z, c.z), min(d.z, e.z)));
            greatest = larger(greatest, larger(larger(b.z, c.z), larger(d.z, e.z)));
            a = e;
            vertex += kPolygonEdgesPerTrip;
        }
    } while (vertex < end);
    trips += polygon.trips;
    float t = at.t < least ? least : (at.t > greatest ? greatest : at.t);
    tSlip = slipOfFlat(frame, polygon.normal, polygon.point, at.toAnchor, ray.direction, t, at.speed);
    hit = Hit(t, 0.0, 0.0, primitive, kNone, polygon.id);
    bool startsHere = ray.source != kNone && at.t <= tSlip;
    return inside && at.speed != 0.0 && !startsHere && countsAt(ray, t);
}

void surfaceOfPolygon(Ray ray, Hit hit, Polygon polygon, Instance instance, inout Surface surface) {
    setPointOnPlane(ray, hit.t, polygon.point, polygon.normal, surface);
    setOwner(polygon.object, polygon.primitive, polygon.material, surface);
}

#endif
