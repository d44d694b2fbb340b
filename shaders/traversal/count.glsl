// Counts the surfaces that a ray crosses, and lists them. All crossings count, in any order: the stackless
// traversal suits.
#ifndef GLINT_COUNT_GLSL
#define GLINT_COUNT_GLSL

#include "primitives/robust.glsl"
#include "traversal/crossings.glsl"
#include "traversal/state.glsl"

// Rays collect leaves, so that those of a subgroup test together (docs/lab/library.md).
const uint kMostLeaves = kCountLeaves;
#include "traversal/leaves.glsl"
#include "traversal/stackless.glsl"

bool isAnyHit(Traversal traversal) { return false; }
bool isShadowRay(Traversal traversal) { return false; }
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
    bool isHit = crossTriangle(ray, seenFrom(ray, frame, triangle), trips, t, u, v);
    hit = Hit(t, u, v, primitive, kNone, triangle.id);
    return isHit;
}

// Counts a hit, unless it is a hole.
void handleHit(inout Traversal traversal, Hit hit) {
    bool isHole = FEATURE_ALPHA_MASK && holeAt(surfaceOfHit(traversal, hit));
    if (!isHole) count(traversal, hit);
}

void testPlanes(inout Traversal traversal, uint planeCount) {
    uint trips = traversal.trips;
    testEachHit(traversal, kKindPlane, 0u, planeCount);
    traversal.trips = trips;
}

// One primitive a trip, whichever leaf it is in; after each hit, the next hit of the same primitive.
void testLeaves(inout Traversal traversal, Leaves leaves) {
    float after = traversal.ray.tMin;
    do {
        if (leaves.list[0] != kNone) {
            uint kind = kindOfLeaf(leaves.list[0]);
            Ray rest = traversal.ray;
            rest.tMin = after;
            Hit hit;
            bool isHit = hitPrimitive(rest, traversal.frame, kind, leaves.list[0] & kLeafFirstMask,
                                      traversal.trips, hit);
            if (isHit) handleHit(traversal, hit);
            bool further = isHit && hit.t > after && hasFurtherHits(kind);
            after = further ? hit.t : traversal.ray.tMin;
            if (!further) dropPrimitive(leaves);
            traversal.trips += 2u;  // of this loop, and of those in the tests
            if (MODE_COST && !further) ++traversal.cost;
        }
    } while (leaves.list[0] != kNone);
}

#endif
