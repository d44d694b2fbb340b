// Triangles. The reference's own version is in src/reference/intersect.cpp.
#ifndef GLINT_PRIMITIVES_TRIANGLE_GLSL
#define GLINT_PRIMITIVES_TRIANGLE_GLSL

#include "instance.glsl"
#include "primitives/surface.glsl"
#include "textbook.glsl"

// Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013. Edges shared by two triangles
// get the same products with the same roundings, so no ray slips between them. The weights are formed before
// t: the paper's sum of products of three lengths overflows at 1e15. PBRT's bound on t's error (4th ed.,
// sec. 6.8.7) is left out: it cost 12 to 15 % of the time, refused true grazing hits, and spared no self-hit
// that the moved origin and the source primitive do not (docs/lab/building.md). The corners across the
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

// Whether the corners lie around the ray, along either axis. Beside a needle, in the line of it, products
// round to the same number, and each edge whose function is 0 for that seems to be met.
bool isAround(SeenTriangle seen) {
    vec2 lo = min(min(seen.a, seen.b), seen.c);
    vec2 hi = max(max(seen.a, seen.b), seen.c);
    return lo.x <= 0.0 && lo.y <= 0.0 && hi.x >= 0.0 && hi.y >= 0.0;
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
    precise float inverse = quotient(1.0, det);
    precise float wHit = ea * inverse;
    precise float uHit = eb * inverse;
    precise float vHit = ec * inverse;
    precise float tHit = wHit * az + uHit * bz + vHit * cz;
    t = tHit;
    u = uHit;
    v = vHit;

    bool inside = (ea >= 0.0 && eb >= 0.0 && ec >= 0.0) || (ea <= 0.0 && eb <= 0.0 && ec <= 0.0);
    if (FEATURE_SLIVERS) inside = inside && isAround(seen);
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

vec3 longestOf(vec3 a, vec3 b, vec3 c) {
    precise float a2 = dot(a, a);
    precise float b2 = dot(b, b);
    precise float c2 = dot(c, c);
    vec3 longer = b2 > a2 ? b : a;
    return c2 > larger(a2, b2) ? c : longer;
}

// Whether a triangle that intersectTriangle says is hit, with these weights, lies behind the origin for
// certain: a ray that leaves a surface at a grazing angle. Of a sliver the products of the edge functions are
// hundreds of times their sum, and t is off by as much. So its sign is found anew, as that of n.(x - o) by
// n.d. With weights a, b and c of 11 digits x is near o, so that n's own rounding tells little; and a x0 + b
// x1 + c x2 - o is exact for the upper 12 digits of all coordinates, multiples of one power of two, which
// leaves 2^-31 of their size. Along the longest edge x is off by as much as 11 digits leave of it, so that
// part of the way is taken off first: n.edge is 0, and what n's rounding would make of it is not. Each of n's
// components errs by three units of either product and one of their difference, the dot products by three
// units more: `doubt` holds for both, and what is taken off errs by three units of itself. A sign within all
// that is not certain.
bool liesBehind(vec3 origin, vec3 direction, Triangle triangle, float u, float v) {
    vec3 v0 = triangle.v0, v1 = triangle.v1, v2 = triangle.v2;
    precise vec3 e1 = v1 - v0;
    precise vec3 e2 = v2 - v0;
    precise vec3 p = e1.yzx * e2.zxy;
    precise vec3 q = e1.zxy * e2.yzx;
    precise vec3 n = p - q;
    vec3 doubt = 8.0 * kUnit * (abs(p) + abs(q));
    float size = larger(larger(greatestComponent(v0), greatestComponent(v1)),
                        larger(greatestComponent(v2), greatestComponent(origin)));
    precise float grid = uintBitsToFloat(floatBitsToUint(size) & 0x7f800000u) * 6144.0;
    precise vec3 h0 = (v0 + grid) - grid;
    precise vec3 h1 = (v1 + grid) - grid;
    precise vec3 h2 = (v2 + grid) - grid;
    precise vec3 ho = (origin + grid) - grid;
    precise float b = (u + 6144.0) - 6144.0;
    precise float c = (v + 6144.0) - 6144.0;
    precise float a = 1.0 - b - c;
    precise vec3 upper = a * h0 + b * h1 + c * h2 - ho;
    precise vec3 lower = a * (v0 - h0) + b * (v1 - h1) + c * (v2 - h2) - (origin - ho);
    precise vec3 way = upper + lower;
    precise vec3 e3 = v2 - v1;
    vec3 edge = longestOf(e1, e2, e3);
    precise float share = quotient(dot(way, edge), dot(edge, edge));
    precise vec3 along = share * edge;
    precise vec3 beside = way - along;
    precise float height = dot(n, beside);
    precise float speed = dot(n, direction);
    vec3 most = abs(n) + doubt;
    precise float sure =
        dot(doubt, abs(beside)) + dot(most, 4.0 * kUnit * abs(along) + 0.0078125 * kUnit * size);
    bool behind = speed > 0.0 ? height < -sure : height > sure;
    return behind && abs(speed) > dot(doubt, abs(direction));
}

// The hit of a sliver, moved along its longest edge to where the ray passes. Its weights are off by the
// rounding of the edge functions over its area, and so the point that they make by some units of the length's
// square over the height: they are right across a sliver and wrong along it. What is left between that point
// and the ray has nearly all its digits, as the weights add up to 1, and so has the share of the edge that
// takes it away. Triangles with sides up to 32 times their height, twice haveSlivers' bound, are as they were
// met. exchanged: u and v are, as in a mirrored instance.
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
    precise vec3 n = vec3(ab.y * ac.z - ab.z * ac.y, ab.z * ac.x - ab.x * ac.z, ab.x * ac.y - ab.y * ac.x);
    float longest = larger(ab2, larger(ac2, bc2));
    bool byAb = ab2 == longest;
    bool byAc = !byAb && ac2 == longest;
    vec3 edge = byAb ? ab : (byAc ? ac : bc);
    float u = exchanged ? hit.v : hit.u;
    float v = exchanged ? hit.u : hit.v;
    precise float w = 1.0 - u - v;
    precise vec3 at = w * a + u * b + v * c;
    precise float square = dot(ray.direction, ray.direction);
    precise vec3 aside = at - quotient(dot(at, ray.direction), square) * ray.direction;
    precise vec3 across = edge - quotient(dot(edge, ray.direction), square) * ray.direction;
    precise float width = dot(across, across);
    if (longest > 32.0 * length(n) && width > 0.0) {
        precise float share = quotient(-dot(aside, across), width);
        precise vec3 moved = at + share * edge;
        precise float t = quotient(dot(moved, ray.direction), square);
        precise float movedU = u + (byAb ? share : (byAc ? 0.0 : -share));
        precise float movedV = v + (byAb ? 0.0 : share);
        movedU = clamp(movedU, 0.0, 1.0);
        movedV = clamp(movedV, 0.0, 1.0 - movedU);
        if (t > 0.0)
            hit = Hit(t, exchanged ? movedV : movedU, exchanged ? movedU : movedV, hit.primitive,
                      hit.instance, hit.id);
    }
}

bool meetTriangle(Ray ray, RayFrame frame, Triangle triangle, out float t, out float u, out float v) {
    if (INTERSECTOR == kTriangleBarycentric) return triangleByCramer(ray, triangle, t, u, v);
    if (INTERSECTOR == kTriangleProjection) return triangleByProjection(ray, triangle, t, u, v);
    if (INTERSECTOR == kTrianglePlanar3d) return triangleInSpace(ray, triangle, t, u, v);
    return intersectTriangle(ray, frame, triangle, t, u, v);
}

// crossesTriangle; the textbooks' tests do not agree about their edges with each other, so there each
// triangle is for itself.
bool crossesOnce(Ray ray, RayFrame frame, Triangle triangle) {
    if (INTERSECTOR != kTriangleWatertight) return true;
    return crossesTriangle(ray, frame, triangle);
}

void triangleAttributes(uint attributes, vec3 weights, inout Surface surface) {
    uint first = attributes & kAttributeFirstMask;
    bool hasUvs = (attributes & kAttributeUvs) != 0u;
    if (FEATURE_UVS) {
        vec2 uv = vec2(weigh(weights, loadVertexAttribute(first).value),
                       weigh(weights, loadVertexAttribute(first + 1u).value));
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

// Weights of a point that lies so far inside that neither its rounding nor that of an edge's test takes it
// into a neighbour. In a plane through the coordinates' origin the error of a point has no part along the
// normal, so rays start in the plane itself, where a neighbour's test finds t = 0 but for its rounding. That
// distance is `margin`, 8 units of the corners' coordinates, the longest edge and what an instance's place
// adds; the least height is twice the area by the longest edge. Pulling towards the centroid by s adds s / 3
// to each weight; slivers are pulled by no more than moves the point by a few margins.
vec3 awayFromEdges(vec3 weights, Triangle triangle, float placed) {
    precise vec3 e1 = triangle.v1 - triangle.v0;
    precise vec3 e2 = triangle.v2 - triangle.v0;
    precise vec3 e3 = e2 - e1;
    precise vec3 n = vec3(e1.y * e2.z - e1.z * e2.y, e1.z * e2.x - e1.x * e2.z, e1.x * e2.y - e1.y * e2.x);
    float edge = larger(greatestComponent(e1), larger(greatestComponent(e2), greatestComponent(e3)));
    float size = larger(greatestComponent(triangle.v0),
                        larger(greatestComponent(triangle.v1), greatestComponent(triangle.v2)));
    precise float margin = 8.0 * kUnit * (size + edge + placed);
    precise float least = quotient(margin * edge, larger(greatestComponent(n), 0.5 * (edge * edge)));
    float smallest = weights.x < weights.y ? weights.x : weights.y;
    smallest = weights.z < smallest ? weights.z : smallest;
    precise float pull = 3.0 * least;
    pull = pull < 1.0 ? pull : 1.0;
    precise vec3 moved = weights + pull * (vec3(1.0 / 3.0) - weights);
    return smallest < least ? moved : weights;
}

// Barycentric interpolation: off by gamma_7 of the sum of magnitudes (Pharr et al., PBRT 4th ed.,
// sec. 6.8.5), far below the error of o + t d. `instance`: of the hit, if it has one.
void surfaceOfTriangle(Hit hit, Instance instance, inout Surface surface) {
    uint index = hit.primitive & kPrimitiveIndexMask;
    Triangle triangle = loadTriangle(index);
    TriangleSurface details = loadTriangleSurface(index);
    if (FEATURE_INSTANCES && hit.instance != kNone && instance.mirrored != 0u) {
        float u = hit.u;
        hit.u = hit.v;
        hit.v = u;
    }
    precise float w = 1.0 - hit.u - hit.v;
    float placed = 0.0;
    if (FEATURE_INSTANCES && hit.instance != kNone) {
        float row =
            larger(greatestComponent(instance.toObjectX),
                   larger(greatestComponent(instance.toObjectY), greatestComponent(instance.toObjectZ)));
        precise float inObject = 3.0 * row * greatestComponent(instance.place);
        placed = inObject;
    }
    vec3 inside = awayFromEdges(vec3(w, hit.u, hit.v), triangle, placed);
    precise vec3 p0 = inside.x * triangle.v0;
    precise vec3 p1 = inside.y * triangle.v1;
    precise vec3 p2 = inside.z * triangle.v2;
    precise vec3 position = p0 + p1 + p2;
    surface.position = position;
    surface.error = gammaBound(7.0) * (abs(p0) + abs(p1) + abs(p2));
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
    surface.object = details.object;
    surface.primitive = details.primitive;
    surface.material = details.material;
    surface.uv = vec2(hit.u, hit.v);
    if (FEATURE_UVS || FEATURE_VERTEX_COLORS)
        triangleAttributes(details.attributes, vec3(w, hit.u, hit.v), surface);
}

#endif
