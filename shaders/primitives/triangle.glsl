// Triangles. The reference's own version is in src/reference/primitives/flat.cpp.
#ifndef GLINT_PRIMITIVES_TRIANGLE_GLSL
#define GLINT_PRIMITIVES_TRIANGLE_GLSL

#include "traversal/ray.glsl"

// Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013. Triangles that share an edge
// compute the same products with the same roundings, so no ray slips between them. t is that of the plane, as
// for every flat surface: the paper's weighted sum errs by the ratio of a sliver's sides.

// The corners across the ray, on which side of each edge the ray passes, and the t of the corners.
struct SeenTriangle {
    vec2 a, b, c;
    float ea, eb, ec;
    vec3 ts;
};
// a, b, c: the corners as seen from the origin, turned.
SeenTriangle seenAlong(RayFrame frame, vec3 a, vec3 b, vec3 c) {
    precise vec2 a2 = a.xy - frame.shear.xy * a.z;
    precise vec2 b2 = b.xy - frame.shear.xy * b.z;
    precise vec2 c2 = c.xy - frame.shear.xy * c.z;
    precise float ea = c2.x * b2.y - c2.y * b2.x;
    precise float eb = a2.x * c2.y - a2.y * c2.x;
    precise float ec = b2.x * a2.y - b2.y * a2.x;
    return SeenTriangle(a2, b2, c2, ea, eb, ec, frame.shear.z * vec3(a.z, b.z, c.z));
}
SeenTriangle seenFrom(Ray ray, RayFrame frame, Triangle triangle) {
    return seenAlong(frame, turnToZ(triangle.v0 - ray.origin, frame.axis),
                     turnToZ(triangle.v1 - ray.origin, frame.axis),
                     turnToZ(triangle.v2 - ray.origin, frame.axis));
}

bool hasOneSign(SeenTriangle seen) {
    return (seen.ea >= 0.0 && seen.eb >= 0.0 && seen.ec >= 0.0) ||
           (seen.ea <= 0.0 && seen.eb <= 0.0 && seen.ec <= 0.0);
}

// True if the projected triangle's bounds contain the ray. Rejects false hits in line with a sliver, where
// products round to the same number and edge functions to 0.
bool isAround(SeenTriangle seen) {
    vec2 lo = min(min(seen.a, seen.b), seen.c);
    vec2 hi = max(max(seen.a, seen.b), seen.c);
    return lo.x <= 0.0 && lo.y <= 0.0 && hi.x >= 0.0 && hi.y >= 0.0;
}

// anchor, normal: v0 and the unit normal, turned.
bool intersectTurned(Ray ray, RayFrame frame, vec3 a, vec3 b, vec3 c, vec3 anchor, vec3 normal, out float t,
                     precise out float u, precise out float v) {
    SeenTriangle seen = seenAlong(frame, a, b, c);
    precise float det = seen.ea + seen.eb + seen.ec;
    precise float inverse = quotient(1.0, det);
    u = seen.eb * inverse;
    v = seen.ec * inverse;

    // Clamp t to the range of the corners; for a ray nearly in the plane, tPlane may lie outside.
    vec3 along = vec3(frame.shear.xy, 1.0);
    precise float speed = dot(normal, along);
    precise float inverseSpeed = quotient(1.0, speed);
    precise float depth = dot(normal, a) * inverseSpeed;
    precise float tPlane = frame.shear.z * depth;
    float least = seen.ts.x < seen.ts.y ? seen.ts.x : seen.ts.y;
    least = seen.ts.z < least ? seen.ts.z : least;
    float greatest = larger(larger(seen.ts.x, seen.ts.y), seen.ts.z);
    t = tPlane < least ? least : (tPlane > greatest ? greatest : tPlane);
    precise float slip =
        slipOfHeight(frame, normal, anchor, a, depth * along) * abs(frame.shear.z * inverseSpeed);
    tSlip = kSlips ? slip : 0.0;

    bool inside = hasOneSign(seen) && (!FEATURE_SLIVERS || isAround(seen));
    return inside && det != 0.0 && speed != 0.0 && t > 0.0 && countsAt(ray, t);
}

bool intersectTriangle(Ray ray, RayFrame frame, Triangle triangle, vec3 normal, out float t, out float u,
                       out float v) {
    vec3 anchor = turnToZ(triangle.v0, frame.axis);
    precise vec3 a = turnToZ(triangle.v0 - ray.origin, frame.axis);
    precise vec3 b = turnToZ(triangle.v1 - ray.origin, frame.axis);
    precise vec3 c = turnToZ(triangle.v2 - ray.origin, frame.axis);
    return intersectTurned(ray, frame, a, b, c, anchor, turnToZ(normal, frame.axis), t, u, v);
}

// Side of the edge from p to q on which the ray passes. If the ray is exactly on the edge (product 0), the
// side is that of a ray moved by (e, e^2), e > 0 arbitrarily small: p x q + e (p.y - q.y) + e^2 (q.x - p.x).
// The edge from q to p gets the other sign (Edelsbrunner, Mucke, "Simulation of Simplicity", ACM Trans.
// Graph. 9(1), 1990).
float sideOfEdge(float product, vec2 p, vec2 q) {
    float moved = p.y != q.y ? p.y - q.y : q.x - p.x;
    return product != 0.0 ? product : moved;
}

// True if the ray crosses this triangle, of those that share the edge or corner that it hits: a ray that
// continues must cross one of them. intersectTriangle must have reported a hit.
bool crossesTriangle(Ray ray, RayFrame frame, Triangle triangle) {
    SeenTriangle seen = seenFrom(ray, frame, triangle);
    bool left = sideOfEdge(seen.ea, seen.c, seen.b) > 0.0;
    return left == (sideOfEdge(seen.eb, seen.a, seen.c) > 0.0) &&
           left == (sideOfEdge(seen.ec, seen.b, seen.a) > 0.0);
}

// The hit of a sliver, moved along its longest edge to where the ray passes: its weights are right across the
// sliver and wrong along it (docs/design/numerics.md 2.3). Triangles with sides up to 32 times their height,
// twice haveSlivers' bound, keep their hits. exchanged: u and v are exchanged, as in a mirrored instance.
void settleSliver(Ray ray, bool exchanged, inout Hit hit) {
    Triangle triangle = loadTriangle(hit.primitive & kPrimitiveIndexMask);
    precise vec3 a = triangle.v0 - ray.origin;
    precise vec3 b = triangle.v1 - ray.origin;
    precise vec3 c = triangle.v2 - ray.origin;
    precise vec3 ab = triangle.v1 - triangle.v0;
    precise vec3 ac = triangle.v2 - triangle.v0;
    precise vec3 bc = triangle.v2 - triangle.v1;
    precise float ab2 = dot(ab, ab);
    precise float ac2 = dot(ac, ac);
    precise float bc2 = dot(bc, bc);
    float longest = larger(ab2, larger(ac2, bc2));
    bool byAb = ab2 == longest;
    bool byAc = !byAb && ac2 == longest;
    vec3 edge = byAb ? ab : (byAc ? ac : bc);
    vec2 uv = exchanged ? vec2(hit.v, hit.u) : vec2(hit.u, hit.v);
    precise float w = 1.0 - uv.x - uv.y;
    precise vec3 at = w * a + uv.x * b + uv.y * c;
    precise float square = dot(ray.direction, ray.direction);
    precise vec3 aside = at - quotient(dot(at, ray.direction), square) * ray.direction;
    precise vec3 across = edge - quotient(dot(edge, ray.direction), square) * ray.direction;
    precise float width = dot(across, across);
    if (longest > 32.0 * length(cross(ab, ac)) && width > 0.0) {
        precise float share = quotient(-dot(aside, across), width);
        precise vec3 moved = at + share * edge;
        precise float t = quotient(dot(moved, ray.direction), square);
        // Clamping moves the hit across the sliver alone: `other` is the weight of the third corner.
        bool fromA = byAb || byAc;
        precise float along = (byAc ? uv.y : uv.x) + (fromA ? share : -share);
        precise float other = fromA ? (byAc ? uv.x : uv.y) + min(along, 0.0) : uv.y + share;
        along = clamp(along, 0.0, 1.0);
        other = clamp(other, 0.0, 1.0 - along);
        uv = exchanged != byAc ? vec2(other, along) : vec2(along, other);
        if (t > 0.0) hit = Hit(t, uv.x, uv.y, hit.primitive, hit.instance, hit.id);
    }
}

// The test of a leaf's triangles: primitives/robust.glsl, primitives/textbook.glsl or traversal/count.glsl.
bool hitTriangle(Ray ray, RayFrame frame, Triangle triangle, uint primitive, inout uint trips, out Hit hit);
// It sets this if dielectrics let shadow rays pass: false if the ray crosses another triangle of the edge.
bool crossesHere;

void triangleAttributes(uint attributes, vec3 weights, inout Surface surface) {
    uint first = attributes & kAttributeFirstMask;
    bool hasUvs = (attributes & kAttributeUvs) != 0u;
    if (FEATURE_UVS) {
        vec2 uv = vec2(dot(weights, loadVertexAttribute(first).value),
                       dot(weights, loadVertexAttribute(first + 1u).value));
        if (hasUvs) surface.uv = uv;
    }
    if (FEATURE_VERTEX_COLORS) {
        bool colored = (attributes & kAttributeColors) != 0u;
        uint row = first + (hasUvs ? 2u : 0u);
        precise vec3 color = weights.x * loadVertexAttribute(row).value +
                             weights.y * loadVertexAttribute(row + 1u).value +
                             weights.z * loadVertexAttribute(row + 2u).value;
        if (colored) surface.color = color;
    }
}

// Barycentric interpolation: off by gamma_7 of the sum of magnitudes (Pharr et al., PBRT 4th ed.,
// sec. 6.8.5), far below o + t d unless the triangle dwarfs the ray (docs/design/numerics.md 2.9).
void surfaceOfTriangle(Ray ray, Hit hit, Triangle triangle, Instance instance, inout Surface surface) {
    TriangleSurface details = loadTriangleSurface(hit.primitive & kPrimitiveIndexMask);
    if (FEATURE_INSTANCES && hit.instance != kNone && instance.mirrored != 0u) {
        hit = Hit(hit.t, hit.v, hit.u, hit.primitive, hit.instance, hit.id);
    }
    precise float w = 1.0 - hit.u - hit.v;
    precise vec3 p0 = w * triangle.v0;
    precise vec3 p1 = hit.u * triangle.v1;
    precise vec3 p2 = hit.v * triangle.v2;
    vec3 terms = abs(p0) + abs(p1) + abs(p2);
    surface.position = p0 + p1 + p2;
    surface.error = gammaBound(7.0) * terms;
    vec3 way = abs(ray.origin) + abs(hit.t * ray.direction);
    if (greatestComponent(terms) > 16.0 * greatestComponent(way))
        setPointOnPlane(ray, hit.t, triangle.v0, details.normal, surface);
    surface.geometricNormal = details.normal;
    surface.shadingNormal = details.normal;
    if (FEATURE_VERTEX_NORMALS) {
        bool smoothed = details.vertexNormals != kNone;
        VertexNormals corners = loadVertexNormals(smoothed ? details.vertexNormals : 0u);
        vec3 weights = vec3(w, hit.u, hit.v);
        if (FEATURE_INSTANCES && hit.instance != kNone) {
            // Unit vectors in the world are what is interpolated there.
            weights = quotient(
                weights, vec3(stretchOfNormal(instance, corners.n0), stretchOfNormal(instance, corners.n1),
                              stretchOfNormal(instance, corners.n2)));
        }
        vec3 sum = weights.x * corners.n0 + weights.y * corners.n1 + weights.z * corners.n2;
        float size = dot(sum, sum);
        vec3 direction = quotient(sum, squareRoot(max(size, 1e-30)));
        if (smoothed && size > 1e-30)
            surface.shadingNormal = dot(direction, details.normal) < 0.0 ? -direction : direction;
    }
    setOwner(details.object, details.primitive, details.material, surface);
    surface.uv = vec2(hit.u, hit.v);
    if (FEATURE_UVS || FEATURE_VERTEX_COLORS)
        triangleAttributes(details.attributes, vec3(w, hit.u, hit.v), surface);
}

#endif
