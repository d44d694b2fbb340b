// Crossings of surfaces, each counted once despite rounding.
//
// In the plane across the ray (Woop's shear) all triangles of a vertex share its rounded place, so a closed
// mesh stays closed. It is seen from a point moved by (e, e^2) (sideOfEdge), with exact signs: products that
// round to the same number are compared as integers. A line hence crosses a closed mesh an even number of
// times. t only decides what lies behind the origin; if its sign is in doubt, the host counts the ray again.
#ifndef GLINT_CROSSINGS_GLSL
#define GLINT_CROSSINGS_GLSL

#include "primitives/triangle.glsl"

// True if the position of a crossing matters, besides that it is in the interval.
const bool kPlacesMatter = MODE_LIST || FEATURE_ALPHA_MASK;

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

// True if the ray crosses the triangle at a t of its interval, 0 excluded. doubtful: rounding decides whether
// the crossing is behind the origin or before it. t, u and v are valid only if they are needed.
bool crossTriangle(Ray ray, RayFrame frame, Triangle triangle, inout uint trips, out float t, out float u,
                   out float v, out bool doubtful) {
    SeenTriangle seen = seenFrom(ray, frame, triangle);
    float ea = seen.ea;
    float eb = seen.eb;
    float ec = seen.ec;
    vec3 ts = seen.ts;
    float nearest = min(ts.x, min(ts.y, ts.z));
    float farthest = max(ts.x, max(ts.y, ts.z));
    // The decision in rounded arithmetic. Three nonzero signs are right (a rounded difference of rounded
    // products has the sign of the exact difference), and t lies between those of the corners.
    bool crosses = hasOneSign(seen) && farthest > 0.0 && farthest >= ray.tMin && nearest <= ray.tMax;
    bool certain =
        ea != 0.0 && eb != 0.0 && ec != 0.0 && nearest > 0.0 && nearest > ray.tMin && farthest <= ray.tMax;
    bool closer = crosses && (kPlacesMatter || !certain);
    t = nearest;
    u = 0.0;
    v = 0.0;
    doubtful = false;
    do {
        if (closer) {
            int sa = ea != 0.0 ? (ea > 0.0 ? 1 : -1) : sideExactly(seen.c, seen.b);
            int sb = eb != 0.0 ? (eb > 0.0 ? 1 : -1) : sideExactly(seen.a, seen.c);
            int sc = ec != 0.0 ? (ec > 0.0 ? 1 : -1) : sideExactly(seen.b, seen.a);
            crosses = sa != 0 && sa == sb && sa == sc;
            precise float det = ea + eb + ec;
            precise float inverse = quotient(1.0, det);
            precise float wHit = ea * inverse;
            precise float uHit = eb * inverse;
            precise float vHit = ec * inverse;
            precise float tHit = wHit * ts.x + uHit * ts.y + vHit * ts.z;
            // All three rounded to zero: any point of the triangle will do.
            bool collapsed = det == 0.0;
            t = collapsed ? farthest : tHit;
            u = collapsed ? 0.0 : uHit;
            v = collapsed ? 0.0 : vHit;
            float bound = boundOfSum(seen, ts);
            precise float sum = ea * ts.x + eb * ts.y + ec * ts.z;
            doubtful = crosses && nearest <= 0.0 && !(abs(sum) > bound);
            // A certain crossing lies between its corners, and so between the ray's ends, whatever t rounds
            // to.
            bool below = kPlacesMatter && certain && t < nearest;
            bool above = kPlacesMatter && certain && t > farthest;
            t = below ? nearest : (above ? farthest : t);
            crosses = crosses && t > 0.0 && t > ray.tMin && t <= ray.tMax;
            closer = false;
            ++trips;
        }
    } while (closer);
    return crosses;
}

#endif
