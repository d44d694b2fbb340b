// Counts the surfaces that a ray crosses, each once despite rounding, and lists them. All crossings count, in
// any order: the stackless traversal suits.
//
// In the plane across the ray (Woop's shear) all triangles of a vertex share its rounded place, so a closed
// mesh stays closed. It is seen from a point moved by (e, e^2) (sideOfEdge), with exact signs: products that
// round to the same number are compared as integers. A line hence crosses a closed mesh an even number of
// times. t only decides what lies behind the origin; if its sign is in doubt, the host counts the ray again.
#ifndef GLINT_COUNT_GLSL
#define GLINT_COUNT_GLSL

#include "traversal/state.glsl"

// The magnitude of x is m 2^(e - 150).
void takeApart(float x, out uint m, out int e) {
    uint bits = floatBitsToUint(x) & 0x7fffffffu;
    uint exponent = bits >> 23;
    m = (bits & 0x7fffffu) | (exponent > 0u ? 0x800000u : 0u);
    e = int(max(exponent, 1u));
}

// A product's magnitude as 64 binary digits, the first of them 1 unless it is zero, and an exponent.
struct Magnitude {
    uint hi, lo;
    int exponent;
};
Magnitude magnitudeOf(float x, float y) {
    uint mx, my;
    int ex, ey;
    takeApart(x, mx, ex);
    takeApart(y, my, ey);
    Magnitude p;
    umulExtended(mx, my, p.hi, p.lo);
    int lead = p.hi != 0u ? 31 - findMSB(p.hi) : (p.lo != 0u ? 63 - findMSB(p.lo) : 0);
    if (lead >= 32) {
        p.hi = p.lo << (lead - 32);
        p.lo = 0u;
    } else if (lead > 0) {
        p.hi = (p.hi << lead) | (p.lo >> (32 - lead));
        p.lo <<= lead;
    }
    p.exponent = ex + ey - lead;
    return p;
}
bool isZero(Magnitude p) { return (p.hi | p.lo) == 0u; }

// The sign of a b - c d, exactly.
int compareProducts(float a, float b, float c, float d) {
    Magnitude p = magnitudeOf(a, b);
    Magnitude q = magnitudeOf(c, d);
    uint signP = (floatBitsToUint(a) ^ floatBitsToUint(b)) >> 31;
    uint signQ = (floatBitsToUint(c) ^ floatBitsToUint(d)) >> 31;
    int first = isZero(p) ? 0 : 1 - 2 * int(signP);
    int second = isZero(q) ? 0 : 1 - 2 * int(signQ);
    int bits = p.exponent != q.exponent
                   ? (p.exponent > q.exponent ? 1 : -1)
                   : (p.hi != q.hi ? (p.hi > q.hi ? 1 : -1) : (p.lo != q.lo ? (p.lo > q.lo ? 1 : -1) : 0));
    return first != second ? sign(first - second) : first * bits;
}

// Side of the edge from p to q on which the moved ray passes: 1 or -1; 0 only if p and q coincide. The edge
// from q to p gets the other sign.
int sideExactly(vec2 p, vec2 q) {
    int side = compareProducts(p.x, q.y, p.y, q.x);
    int moved = p.y != q.y ? (p.y > q.y ? 1 : -1) : (p.x != q.x ? (q.x > p.x ? 1 : -1) : 0);
    return side != 0 ? side : moved;
}

// Error bound of the sum of weights times z. Each term of a weight rounds twice, their difference, the
// product with z and the sums again.
float boundOfSum(SeenTriangle seen, vec3 z) {
    precise vec3 terms = vec3(abs(seen.c.x * seen.b.y) + abs(seen.c.y * seen.b.x),
                              abs(seen.a.x * seen.c.y) + abs(seen.a.y * seen.c.x),
                              abs(seen.b.x * seen.a.y) + abs(seen.b.y * seen.a.x));
    return 16.0 * kUnit * dot(terms, abs(z));
}

// True if the ray crosses a triangle that it meets at an edge or a corner.
bool crossesExactly(SeenTriangle seen) {
    int sa = seen.ea != 0.0 ? (seen.ea > 0.0 ? 1 : -1) : sideExactly(seen.c, seen.b);
    int sb = seen.eb != 0.0 ? (seen.eb > 0.0 ? 1 : -1) : sideExactly(seen.a, seen.c);
    int sc = seen.ec != 0.0 ? (seen.ec > 0.0 ? 1 : -1) : sideExactly(seen.b, seen.a);
    return sa != 0 && sa == sb && sa == sc;
}

// Doubts about crossings since `doubts` was last 0. kAtEdge: an edge function is zero; the ray is counted
// again in a resume dispatch, which alone has the long code that compares exactly. kNearOrigin: rounding
// decides whether a crossing is behind the origin or before it; the host counts the ray again.
const uint kAtEdge = 1u, kNearOrigin = 2u;
uint doubts = 0u;

// True if the ray crosses the triangle at a t of its interval, 0 excluded. Three nonzero signs are right (a
// rounded difference of rounded products has the sign of the exact difference), and t lies between those of
// the corners.
bool crossTriangle(Ray ray, SeenTriangle seen, out float t, out float u, out float v) {
    float nearest = min(seen.ts.x, min(seen.ts.y, seen.ts.z));
    float farthest = max(seen.ts.x, max(seen.ts.y, seen.ts.z));
    bool crosses = hasOneSign(seen) && farthest > 0.0 && farthest >= ray.tMin && nearest <= ray.tMax;
    bool atEdge = crosses && (seen.ea == 0.0 || seen.eb == 0.0 || seen.ec == 0.0);
    if (MODE_RESUME)
        crosses = crosses && (!atEdge || crossesExactly(seen));
    else
        doubts |= atEdge ? kAtEdge : 0u;

    precise float det = seen.ea + seen.eb + seen.ec;
    precise float inverse = quotient(1.0, det);
    precise vec3 weights = vec3(seen.ea, seen.eb, seen.ec) * inverse;
    precise float mean = weights.x * seen.ts.x + weights.y * seen.ts.y + weights.z * seen.ts.z;
    // All three rounded to zero: any point of the triangle will do.
    bool collapsed = det == 0.0;
    u = collapsed ? 0.0 : weights.y;
    v = collapsed ? 0.0 : weights.z;
    t = collapsed || mean > farthest ? farthest : (mean > nearest ? mean : nearest);
    precise float sum = seen.ea * seen.ts.x + seen.eb * seen.ts.y + seen.ec * seen.ts.z;
    if (crosses && nearest <= 0.0 && !(abs(sum) > boundOfSum(seen, seen.ts))) doubts |= kNearOrigin;
    return crosses && t > 0.0 && t > ray.tMin && t <= ray.tMax;
}

// ---- Counts and lists ----

// Leaves that a ray has collected, kNone behind them: crossings do not shorten the ray, so that those of a
// subgroup test theirs together (docs/lab/library.md).
const bool kCollects = true;
uint leaves[kCountLeaves];
#include "traversal/stack.glsl"
#include "traversal/stackless.glsl"

bool isAnyHit(Traversal traversal) { return false; }
bool entersBox(Traversal traversal, vec3 lo, vec3 hi) { return rayEntersBox(traversal, lo, hi); }

// The place of the ray's first crossing in the list of MODE_LIST, and how many are listed.
uvec2 listOfRay = uvec2(0u);

// Counts a crossing. With MODE_LIST it is stored behind the rows of the paths, in two rows.
void count(inout Traversal traversal, Hit hit) {
    if (MODE_LIST && traversal.crossings < listOfRay.y) {
        hit = inWorld(traversal, hit);
        uint place = (kPathRows + (FEATURE_INSTANCES ? 1u : 0u)) * dispatch.capacity +
                     2u * (listOfRay.x + traversal.crossings);
        storePathRow(place, hitRowOf(hit));
        storePathRow(place + 1u, uvec4(hit.instance, 0u, 0u, 0u));
    }
    ++traversal.crossings;
}

bool hitTriangle(Ray ray, RayFrame frame, Triangle triangle, uint primitive, inout uint trips, out Hit hit) {
    float t, u, v;
    bool isHit = crossTriangle(ray, seenFrom(ray, frame, triangle), t, u, v);
    hit = Hit(t, u, v, primitive, kNone, triangle.id);
    return isHit;
}
bool hitSphere(Ray ray, RayFrame frame, Sphere sphere, uint primitive, inout uint trips, out Hit hit) {
    return intersectSphere(ray, frame, sphere, primitive, hit);
}

// Counts a hit, unless it is a hole; further hits count, too.
bool goesOnAfter(inout Traversal traversal, Hit hit) {
    bool isHole = FEATURE_ALPHA_MASK && holeAt(surfaceOfHit(traversal, hit));
    if (!isHole) count(traversal, hit);
    return true;
}

void testPlanes(inout Traversal traversal, uint planeCount) {
    uint trips = traversal.trips;
    testEachHit(traversal, kKindPlane, 0u, planeCount);
    traversal.trips = trips;
}

void testLeaf(inout Traversal traversal, uint leaf) {
    uint first = leaf & kLeafFirstMask;
    testEachHit(traversal, kindOfLeaf(leaf), first, first + sizeOfLeaf(leaf));
}

void collectLeaf(inout bool hits, uint child) {
    bool isLeaf = hits && !isNode(child) && !isInstance(child);
    hits = hits && !isLeaf;
    for (uint i = 0u; i < kCountLeaves; ++i) {
        uint next = leaves[i];
        leaves[i] = isLeaf ? child : next;
        child = next;
    }
}

bool collect(Node node, inout bool hit0, inout bool hit1) {
    collectLeaf(hit0, node.child0);
    collectLeaf(hit1, node.child1);
    return leaves[kCountLeaves - 2u] != kNone;
}

// Takes the first primitive out of the first leaf.
void dropPrimitive() {
    if (sizeOfLeaf(leaves[0]) > 1u) {
        leaves[0] += 1u - (1u << kLeafCountShift);
    } else {
        for (uint i = 1u; i < kCountLeaves; ++i) leaves[i - 1u] = leaves[i];
        leaves[kCountLeaves - 1u] = kNone;
    }
}

// One primitive a trip, whichever leaf it is in; after each hit, the next hit of the same primitive, as in
// testEachHit. Said twice, as a function for both costs random rays an eighth of their rate.
void testLeaves(inout Traversal traversal) {
    float after = traversal.ray.tMin;
    do {
        if (leaves[0] != kNone) {
            uint kind = kindOfLeaf(leaves[0]);
            Ray rest = traversal.ray;
            rest.tMin = after;
            Hit hit;
            bool further =
                hitPrimitive(rest, traversal.frame, kind, leaves[0] & kLeafFirstMask, traversal.trips, hit);
            if (further) further = goesOnAfter(traversal, hit) && hit.t > after && hasFurtherHits(kind);
            after = further ? hit.t : traversal.ray.tMin;
            if (!further) dropPrimitive();
            traversal.trips += 2u;  // of this loop, and of those in the tests
            if (MODE_COST && !further) ++traversal.cost;
        }
    } while (leaves[0] != kNone);
}

#endif
