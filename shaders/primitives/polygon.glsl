// Polygons. The reference's own version is in src/reference/intersect.cpp.
#ifndef GLINT_PRIMITIVES_POLYGON_GLSL
#define GLINT_PRIMITIVES_POLYGON_GLSL

#include "primitives/surface.glsl"

// A vertex as the ray sees it: sheared as the corners of triangles are, z its t.
vec3 shearedVertex(Ray ray, RayFrame frame, uint index) {
    precise vec3 v = turnToZ(loadPolygonVertex(index).position - ray.origin, frame.axis);
    precise vec2 xy = v.xy - frame.shear.xy * v.z;
    precise float t = frame.shear.z * v.z;
    return vec3(xy, t);
}

// True if the edge crosses the half line x > 0, y = 0. Half open: of two edges that meet on the line, one
// above and one below it, a single one counts, and both or neither if they are on the same side. Exchanging a
// and b exchanges nothing: the two products are the same, so polygons that share an edge never disagree on
// which side of it a ray passes.
bool crosses(vec3 a, vec3 b) {
    precise float edge = a.x * b.y - a.y * b.x;
    bool up = b.y > 0.0;
    return up != (a.y > 0.0) && (up ? edge > 0.0 : edge < 0.0);
}

// Even-odd rule on the outline as seen along the ray, projected along the direction's largest component, not
// the normal's: every edge contributes a bit of its own and the ray's alone, so the parities of polygons that
// meet add up to that of their common outline, without gaps, whatever rounding does. t is the plane's, kept
// among those of the vertices, which it leaves by rounding only.
bool intersectPolygon(Ray ray, RayFrame frame, Polygon polygon, out float t) {
    precise float speed = dot(polygon.normal, ray.direction);
    precise vec3 toPoint = polygon.point - ray.origin;
    precise float height = dot(polygon.normal, toPoint);
    precise float tPlane = quotient(height, speed);
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
    t = tPlane < least ? least : (tPlane > greatest ? greatest : tPlane);
    tSlip = slipOfFlat(frame, polygon.normal, polygon.point, toPoint, ray.direction, t, speed);
    bool startsHere = ray.source != kNone && tPlane <= tSlip;
    return inside && speed != 0.0 && !startsHere && countsAt(ray, t);
}

bool hitPolygon(Ray ray, RayFrame frame, Polygon polygon, uint primitive, inout uint trips, out Hit hit) {
    float t;
    bool isHit = intersectPolygon(ray, frame, polygon, t);
    trips += polygon.trips;
    hit = Hit(t, 0.0, 0.0, primitive, kNone, polygon.id);
    return isHit;
}

void surfaceOfPolygon(Ray ray, Hit hit, Polygon polygon, inout Surface surface) {
    flatSurface(ray, hit, polygon.point, polygon.normal, surface);
}

#endif
