// Ray against one primitive. The reference's own versions are in src/reference/intersect.cpp.
#ifndef GLINT_INTERSECT_GLSL
#define GLINT_INTERSECT_GLSL

#include "ray.glsl"
#include "storage.glsl"

// Distances along the ray of the two planes of each slab, the far one enlarged. A division good to 2.5 ulp
// (Vulkan's promise), one subtraction and one product leave each plane within gamma_7 of its true distance
// (Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013, with gamma_7 in place of his gamma_3), and what the
// triangle test accepts may lie beside the ray by 11 u t |d| (edgeMargin, src/pack/primitives.h): both twice,
// and a unit for the product itself and for what is of second order, make 1 + 38 u. So a box whose primitive
// is hit is never missed. The same factor on the interval's end keeps one that is hit at exactly that t.
const float kFarPad = 1.00000226497650;
// The other two are for `glint report`: Ize's own, and none.
float farPad() {
    return SLAB_PAD == kSlabPlain ? 1.0 : (SLAB_PAD == kSlabGamma3 ? 1.00000035762791 : kFarPad);
}

// True if the box may hold a hit in the ray's interval that ends at tEnd = tMax * kFarPad. Both planes are
// chosen by the sign of the direction, not by min and max, so that an empty box (lo > hi) is never hit.
bool intersectBox(Ray ray, RayFrame frame, vec3 lo, vec3 hi, float tEnd, out float tNear) {
    vec3 nearPlane = mix(lo, hi, frame.negative);
    vec3 farPlane = mix(hi, lo, frame.negative);
    precise vec3 t0 = (nearPlane - frame.nearOrigin) * frame.inverse;
    precise vec3 t1 = (farPlane - frame.farOrigin) * frame.inverse;
    // Written as comparisons: these compile to one instruction each where min and max take three, for NaN's
    // sake.
    float near = ray.tMin;
    near = t0.x > near ? t0.x : near;
    near = t0.y > near ? t0.y : near;
    near = t0.z > near ? t0.z : near;
    float far = t1.x;
    far = t1.y < far ? t1.y : far;
    far = t1.z < far ? t1.z : far;
    precise float padded = far * farPad();
    far = padded < tEnd ? padded : tEnd;
    tNear = near;
    return near <= far;
}

// Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013. Edges shared by two triangles
// get the same products with the same roundings, so no ray slips between them. The weights are formed before
// t: the paper's sum of products of three lengths overflows at 1e15. PBRT's bound on t's error (4th ed.,
// sec. 6.8.7) is left out: it cost 12 to 15 % of the time, refused true grazing hits, and spared no self-hit
// that the moved origin and the source primitive do not (docs/lab/measurements.md). The corners across the
// ray, and of each edge on which side of it the ray passes.
struct SeenTriangle {
    vec2 a, b, c;
    float ea, eb, ec;
};
// a, b, c: the corners as seen from the origin, turned.
SeenTriangle seenAlong(RayFrame frame, vec3 a, vec3 b, vec3 c) {
    precise vec2 a2 = a.xy - frame.shear.xy * a.z;
    precise vec2 b2 = b.xy - frame.shear.xy * b.z;
    precise vec2 c2 = c.xy - frame.shear.xy * c.z;
    precise float ea = c2.x * b2.y - c2.y * b2.x;
    precise float eb = a2.x * c2.y - a2.y * c2.x;
    precise float ec = b2.x * a2.y - b2.y * a2.x;
    return SeenTriangle(a2, b2, c2, ea, eb, ec);
}

bool intersectTurned(Ray ray, RayFrame frame, vec3 a, vec3 b, vec3 c, out float t, out float u, out float v) {
    SeenTriangle seen = seenAlong(frame, a, b, c);
    float ea = seen.ea;
    float eb = seen.eb;
    float ec = seen.ec;
    precise float det = ea + eb + ec;
    precise float az = frame.shear.z * a.z;
    precise float bz = frame.shear.z * b.z;
    precise float cz = frame.shear.z * c.z;
    precise float inverse = 1.0 / det;
    precise float wHit = ea * inverse;
    precise float uHit = eb * inverse;
    precise float vHit = ec * inverse;
    precise float tHit = wHit * az + uHit * bz + vHit * cz;
    t = tHit;
    u = uHit;
    v = vHit;

    bool inside = (ea >= 0.0 && eb >= 0.0 && ec >= 0.0) || (ea <= 0.0 && eb <= 0.0 && ec <= 0.0);
    return inside && det != 0.0 && tHit > 0.0 && tHit > ray.tMin && tHit <= ray.tMax;
}

bool intersectTriangle(Ray ray, RayFrame frame, Triangle triangle, out float t, out float u, out float v) {
    precise vec3 a = turnToZ(triangle.v0 - ray.origin, frame.axis);
    precise vec3 b = turnToZ(triangle.v1 - ray.origin, frame.axis);
    precise vec3 c = turnToZ(triangle.v2 - ray.origin, frame.axis);
    return intersectTurned(ray, frame, a, b, c, t, u, v);
}

// Of an edge from p to q that the ray meets as exactly as rounding tells: the side on which a ray passes that
// is moved by (e, e^2), e > 0 as small as one likes. (p - m) x (q - m) = p x q + e (p.y - q.y) + e^2 (q.x -
// p.x): the other triangle of the edge, which goes from q to p, gets the other sign (Edelsbrunner, Mucke,
// "Simulation of Simplicity", ACM Trans. Graph. 9(1), 1990).
float sideOfEdge(float product, vec2 p, vec2 q) {
    float moved = p.y != q.y ? p.y - q.y : q.x - p.x;
    return product != 0.0 ? product : moved;
}

// Of a triangle that intersectTriangle says is hit: whether it is the one of those that share the edge, or
// the corner, that the ray crosses. Where a ray ends an edge may belong to both; where it goes through and
// counts what it crosses, to one.
bool crossesTriangle(Ray ray, RayFrame frame, Triangle triangle) {
    precise vec3 a = turnToZ(triangle.v0 - ray.origin, frame.axis);
    precise vec3 b = turnToZ(triangle.v1 - ray.origin, frame.axis);
    precise vec3 c = turnToZ(triangle.v2 - ray.origin, frame.axis);
    SeenTriangle seen = seenAlong(frame, a, b, c);
    bool left = sideOfEdge(seen.ea, seen.c, seen.b) > 0.0;
    return left == (sideOfEdge(seen.eb, seen.a, seen.c) > 0.0) &&
           left == (sideOfEdge(seen.ec, seen.b, seen.a) > 0.0);
}

// Nearest root of a t^2 + 2 b t + c = 0 in the interval, by the form that cancels nothing (Press et al.,
// Numerical Recipes, sec. 5.6). disc is b^2 - a c, computed by the caller in the way that suits the sphere.
bool nearestRoot(Ray ray, float a, float b, float c, float disc, out float t) {
    precise float root = sqrt(max(disc, 0.0));
    precise float q = -(b + (b < 0.0 ? -root : root));
    precise float r0 = c / q;
    precise float r1 = q / a;
    float lower = r0 < r1 ? r0 : r1;
    float upper = r0 < r1 ? r1 : r0;
    bool lowerIn = lower > ray.tMin && lower <= ray.tMax;
    bool upperIn = upper > ray.tMin && upper <= ray.tMax;
    t = lowerIn ? lower : upper;
    return disc >= 0.0 && q != 0.0 && (lowerIn || upperIn);
}

// Discriminant from the distance of the centre to the ray (Haines, Gunther, Akenine-Moller, "Precision
// Improvements for Ray/Sphere Intersection", Ray Tracing Gems, 2019, ch. 7), not from b^2 - a c, which loses
// everything once the sphere is far away. An anchored sphere measures from a point of its surface, so that a
// radius far greater than all distances cancels nothing.
bool intersectSphere(Ray ray, Sphere sphere, uint primitive, out float t) {
    precise vec3 o = ray.origin - sphere.point;
    precise float a = dot(ray.direction, ray.direction);
    precise float b = dot(o, ray.direction);
    precise vec3 perpendicular = o - (b / a) * ray.direction;
    precise float disc = a * (sphere.radius * sphere.radius - dot(perpendicular, perpendicular));
    precise float c = dot(o, o) - sphere.radius * sphere.radius;
    if (FEATURE_ANCHORED_SPHERES && sphere.anchorNormal != vec3(0.0)) {
        precise float anchoredB = b + sphere.radius * dot(sphere.anchorNormal, ray.direction);
        precise float anchoredC = dot(o, o) + 2.0 * sphere.radius * dot(o, sphere.anchorNormal);
        precise float anchoredDisc = anchoredB * anchoredB - a * anchoredC;
        b = anchoredB;
        c = anchoredC;
        disc = anchoredDisc;
    }
    if (primitive == ray.source) {
        // The ray starts on the surface: c is zero, whatever rounding says.
        precise float square = b * b;
        c = 0.0;
        disc = square;
    }
    return nearestRoot(ray, a, b, c, disc, t);
}

// t from an anchor point, not from a stored plane constant: a distant constant would cancel.
bool intersectPlane(Ray ray, Plane plane, out float t) {
    precise float speed = dot(plane.normal, ray.direction);
    precise float height = dot(plane.normal, plane.point - ray.origin);
    precise float tHit = height / speed;
    t = tHit;
    return speed != 0.0 && tHit > ray.tMin && tHit <= ray.tMax;
}

// The plane's t, then the distance from the centre of the point there. Both parts of it are of the size of
// the ray's way to the disc, not of the coordinates.
bool intersectDisc(Ray ray, Disc disc, out float t) {
    precise vec3 toCenter = disc.center - ray.origin;
    precise float speed = dot(disc.normal, ray.direction);
    precise float height = dot(disc.normal, toCenter);
    precise float tHit = height / speed;
    precise vec3 offset = tHit * ray.direction - toCenter;
    precise float square = dot(offset, offset);
    precise float limit = disc.radius * disc.radius;
    t = tHit;
    return speed != 0.0 && square <= limit && tHit > ray.tMin && tHit <= ray.tMax;
}

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
    precise float height = dot(polygon.normal, polygon.point - ray.origin);
    precise float tPlane = height / speed;
    bool inside = false;
    uint vertex = polygon.firstVertex;
    uint end = vertex + polygon.trips * kPolygonEdgesPerTrip;
    vec3 a = shearedVertex(ray, frame, vertex);
    float least = a.z;
    float greatest = a.z;
    while (vertex < end) {
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
    t = tPlane < least ? least : (tPlane > greatest ? greatest : tPlane);
    return inside && speed != 0.0 && t > ray.tMin && t <= ray.tMax;
}

#endif
