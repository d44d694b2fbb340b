// Counts the surfaces that a ray crosses, and lists them. All crossings count, in any order: the stackless
// traversal suits.
#ifndef GLINT_COUNT_GLSL
#define GLINT_COUNT_GLSL

#include "traversal/crossings.glsl"
#include "traversal/hit.glsl"
#include "traversal/stackless.glsl"

bool isAnyHit(Traversal traversal) { return false; }
bool isShadowRay(Traversal traversal) { return false; }

// Crossings of the current ray.
struct CrossingCount {
    uint count;     // surfaces so far
    uint doubtful;  // 1: rounding decides about one of them, and the host counts again
    uvec2 list;     // of MODE_LIST: the place of the first crossing, and how many are listed
};
CrossingCount crossings;

// Counts a crossing. With MODE_LIST it is stored behind the rows of the paths, in two rows.
void count(Traversal traversal, uint kind, Hit hit) {
    if (MODE_LIST && crossings.count < crossings.list.y) {
        bool exchanged = FEATURE_INSTANCES && traversal.mirrored && kind == kKindTriangle;
        uint place = (kPathRows + (FEATURE_INSTANCES ? 1u : 0u)) * dispatch.capacity +
                     2u * (crossings.list.x + crossings.count);
        storePathRow(place, uvec4(floatBitsToUint(hit.t), floatBitsToUint(exchanged ? hit.v : hit.u),
                                  floatBitsToUint(exchanged ? hit.u : hit.v), hit.primitive));
        storePathRow(place + 1u, uvec4(FEATURE_INSTANCES ? traversal.instance : kNone, 0u, 0u, 0u));
    }
    ++crossings.count;
}

bool hitTriangle(inout Traversal traversal, Ray ray, uint index, uint primitive, out Hit hit) {
    Triangle triangle = loadTriangle(index);
    float t, u, v;
    bool doubtful;
    bool isHit = crossTriangle(ray, traversal.frame, triangle, traversal.trips, t, u, v, doubtful);
    crossings.doubtful |= doubtful ? 1u : 0u;
    hit = Hit(t, u, v, primitive, kNone, triangle.id);
    return isHit;
}

// Counts the crossings of primitives `first` to `end` - 1, each looked for from the one before on.
void countAll(inout Traversal traversal, uint kind, uint first, uint end) {
    uint index = first;
    float after = traversal.ray.tMin;
    do {
        if (index < end) {
            Ray rest = traversal.ray;
            rest.tMin = after;
            Hit hit;
            bool isHit = hitPrimitive(traversal, rest, kind, index, hit);
            bool isHole = FEATURE_ALPHA_MASK && holeAt(surfaceOfHit(traversal, kind, hit).surface);
            if (isHit && !isHole) count(traversal, kind, hit);
            bool further = isHit && hit.t > after && hasFurtherHits(kind);
            after = further ? hit.t : traversal.ray.tMin;
            index += further ? 0u : 1u;
            traversal.trips += 2u;  // of this loop, and of those in the tests
        }
    } while (index < end);
}

void testLeaf(inout Traversal traversal, uint leaf) {
    uint first = leaf & kLeafFirstMask;
    countAll(traversal, kindOfLeaf(leaf), first, first + sizeOfLeaf(leaf));
}

// Counts from `slot` on, kSlotFresh for the beginning, and returns the slot to continue from, kNone at the
// end. `place`: the instance that an unfinished ray is in, and its slot in the world.
uint countFrom(inout Traversal traversal, Environment environment, uint slot, uvec2 place) {
    bool sound = prepare(traversal, environment);
    bool begins = slot == kSlotFresh;
    if (FEATURE_PLANES) {
        uint trips = traversal.trips;  // those of the planes are in the budget already
        countAll(traversal, kKindPlane, 0u, sound && begins ? environment.planeCount : 0u);
        traversal.trips = trips;
    }
    if (begins) slot = environment.root == kNone ? kNone : 0u;
    if (begins) place = uvec2(kNone);
    bool inTree = kHasTree && sound && slot != kNone;
    enterAgain(traversal, place, inTree);
    return traverseFrom(traversal, inTree ? slot : kNone);
}

#endif
