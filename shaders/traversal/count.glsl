// Counts the surfaces that a ray crosses, and lists them. All crossings count, in any order: the stackless
// traversal suits.
#ifndef GLINT_COUNT_GLSL
#define GLINT_COUNT_GLSL

#include "primitives/robust.glsl"
#include "traversal/crossings.glsl"
#include "traversal/stackless.glsl"

bool isAnyHit(Traversal traversal) { return false; }
bool isShadowRay(Traversal traversal) { return false; }
bool entersBox(Traversal traversal, vec3 lo, vec3 hi) { return rayEntersBox(traversal, lo, hi); }

// Crossings of the current ray.
struct CrossingCount {
    uint count;     // surfaces so far
    uint doubtful;  // 1: rounding decides about one of them, and the host counts again
    uvec2 list;     // of MODE_LIST: the place of the first crossing, and how many are listed
};
CrossingCount crossings;

// Counts a crossing. With MODE_LIST it is stored behind the rows of the paths, in two rows.
void count(Traversal traversal, Hit hit) {
    if (MODE_LIST && crossings.count < crossings.list.y) {
        hit = inWorld(traversal, hit);
        uint place = (kPathRows + (FEATURE_INSTANCES ? 1u : 0u)) * dispatch.capacity +
                     2u * (crossings.list.x + crossings.count);
        storePathRow(place, hitRowOf(hit));
        storePathRow(place + 1u, uvec4(hit.instance, 0u, 0u, 0u));
    }
    ++crossings.count;
}

bool hitTriangle(Ray ray, RayFrame frame, Triangle triangle, uint primitive, inout uint trips, out Hit hit) {
    float t, u, v;
    bool doubtful;
    bool isHit = crossTriangle(ray, frame, triangle, trips, t, u, v, doubtful);
    crossings.doubtful |= doubtful ? 1u : 0u;
    hit = Hit(t, u, v, primitive, kNone, triangle.id);
    return isHit;
}

// Counts a hit, unless it is a hole.
void handleHit(inout Traversal traversal, Hit hit) {
    bool isHole = FEATURE_ALPHA_MASK && holeAt(surfaceOfHit(traversal, hit));
    if (!isHole) count(traversal, hit);
}

void testLeaf(inout Traversal traversal, uint leaf) {
    uint first = leaf & kLeafFirstMask;
    testEachHit(traversal, kindOfLeaf(leaf), first, first + sizeOfLeaf(leaf));
}

void testPlanes(inout Traversal traversal, uint planeCount) {
    uint trips = traversal.trips;
    testEachHit(traversal, kKindPlane, 0u, planeCount);
    traversal.trips = trips;
}

#endif
