// The primitives of a leaf, and the planes, which stand in no leaf.
#ifndef GLINT_LEAF_GLSL
#define GLINT_LEAF_GLSL

#include "traversal/state.glsl"

// True if the ray may pass through surfaces: holes, and as a shadow ray dielectrics.
bool mayPass(Traversal traversal) {
    return FEATURE_ALPHA_MASK || (FEATURE_COLORED_SHADOWS && isShadowRay(traversal));
}

// True if the ray hits the surface from its inner side. Spheres (with kTellsSides) and quadrics return the
// side in hit.u.
bool leavesThrough(Traversal traversal, Surface surface, Hit hit) {
    bool isRound =
        (kindOf(hit) == kKindSphere && SPHERE_FORM == kSphereRobust) || kindOf(hit) == kKindQuadric;
    vec3 direction = FEATURE_INSTANCES ? traversal.world.direction : traversal.ray.direction;
    return kTellsSides && isRound ? hit.u == kLeaves : dot(surface.geometricNormal, direction) > 0.0;
}

// True if the ray passes through its hit: a hole, or as a shadow ray a dielectric, which filters the light.
bool passesThrough(inout Traversal traversal, Hit hit) {
    Surface surface = surfaceOfHit(traversal, hit);
    bool through = FEATURE_ALPHA_MASK && holeAt(surface);
    if (FEATURE_COLORED_SHADOWS && isShadowRay(traversal) && !through) {
        bool counts = kindOf(hit) != kKindTriangle || crossesHere;
        through = passes(traversal.passage, surface, leavesThrough(traversal, surface, hit), counts, hit.t);
    }
    return through;
}

bool goesOnAfter(inout Traversal traversal, Hit hit) {
    bool through = passesThrough(traversal, hit);
    if (!through) accept(traversal, hit);
    return through;
}

// Tests the primitives `first` to `end` - 1 of a kind, which is a constant at each call.
void testEach(inout Traversal traversal, uint kind, uint first, uint end) {
    uint index = first;
    do {
        if (index < end) {
            Hit hit;
            if (hitPrimitive(traversal.ray, traversal.frame, kind, index, traversal.trips, hit))
                accept(traversal, hit);
            ++index;
            ++traversal.trips;
            if (MODE_COST) ++traversal.cost;
        }
    } while (index < end);
}

// Tests the primitives of a leaf, which are of one kind. Each kind has a loop, so that a subgroup tests
// further primitives of one kind alone.
void testLeaf(inout Traversal traversal, uint leaf) {
    uint kind = kindOfLeaf(leaf);
    uint first = leaf & kLeafFirstMask;
    uint end = first + sizeOfLeaf(leaf);
    if (mayPass(traversal)) {
        testEachHit(traversal, kind, first, end);
        return;
    }
#define GLINT_TEST(number, Kind, KINDS, kinds, one, many) \
    if (FEATURE_##KINDS && kKind##Kind != kKindPlane)     \
        testEach(traversal, kKind##Kind, kind == kKind##Kind ? first : end, end);
    GLINT_PRIMITIVES(GLINT_TEST, GLINT_NO_KIND)
}

// Hits shorten the ray, so that it tests each leaf at once (traversal/stack.glsl).
const bool kCollects = false;
bool collect(Node node, inout bool hit0, inout bool hit1) { return false; }
void testLeaves(inout Traversal traversal) {}

// Planes are infinite and in no leaf: every ray tests all of them. Their trips are in the budget already.
void testPlanes(inout Traversal traversal, uint planeCount) {
    uint trips = traversal.trips;
    if (mayPass(traversal) && FEATURE_OPEN_PLANES)
        testEachHit(traversal, kKindPlane, 0u, planeCount);
    else
        testEach(traversal, kKindPlane, 0u, planeCount);
    traversal.trips = trips;
}

#endif
