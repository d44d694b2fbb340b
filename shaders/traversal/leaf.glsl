// The primitives of a leaf, and the planes, which stand in no leaf.
#ifndef GLINT_LEAF_GLSL
#define GLINT_LEAF_GLSL

#include "traversal/state.glsl"

// True if the ray may pass through surfaces: holes, and as a shadow ray dielectrics.
bool mayPass(Traversal traversal) {
    return FEATURE_ALPHA_MASK || (FEATURE_COLORED_SHADOWS && isShadowRay(traversal));
}

bool hitTriangle(inout Traversal traversal, Ray ray, uint index, uint primitive, out Hit hit) {
    Triangle triangle = loadTriangle(index);
    float t, u, v;
    bool isHit = meetTriangle(ray, traversal.frame, triangle, loadTriangleSurface(index).normal, t, u, v);
    if (FEATURE_COLORED_SHADOWS && isShadowRay(traversal))
        traversal.passage.counts = crossesOnce(ray, traversal.frame, triangle);
    hit = Hit(t, u, v, primitive, kNone, triangle.id);
    return isHit;
}

// True if the ray hits the surface from its inner side. Round primitives return the side with the hit
// (kTellsSides).
bool leavesThrough(Traversal traversal, Surface surface, Hit hit) {
    bool isRound =
        (kindOf(hit) == kKindSphere && SPHERE_FORM == kSphereRobust) || kindOf(hit) == kKindQuadric;
    vec3 direction = traversal.ray.direction;
    if (FEATURE_INSTANCES && traversal.instance != kNone) direction = traversal.world.direction;
    return kTellsSides && isRound ? hit.u == kLeaves : dot(surface.geometricNormal, direction) > 0.0;
}

// True if the ray passes through its hit: a hole, or as a shadow ray a dielectric, which filters the light.
bool passesThrough(inout Traversal traversal, Hit hit) {
    Surface surface = surfaceOfHit(traversal, hit);
    bool through = FEATURE_ALPHA_MASK && holeAt(surface);
    if (FEATURE_COLORED_SHADOWS && isShadowRay(traversal) && !through)
        through = passes(traversal.passage, surface, leavesThrough(traversal, surface, hit), hit);
    return through;
}

void handleHit(inout Traversal traversal, Hit hit) {
    if (!passesThrough(traversal, hit)) accept(traversal, hit);
}

// Tests the primitives `first` to `end` - 1 of a kind, which is a constant at each call.
void testEach(inout Traversal traversal, uint kind, uint first, uint end) {
    uint index = first;
    do {
        if (index < end) {
            Hit hit;
            if (hitPrimitive(traversal, traversal.ray, kind, index, hit)) accept(traversal, hit);
            ++index;
            ++traversal.trips;
            if (MODE_COST) ++traversal.cost;
        }
    } while (index < end);
}

// Trips that one pass through the loops around a leaf counts, in scenes with instances: those loops, and each
// loop in them, of which a subgroup makes one trip even if no lane has work there.
uint tripsOfPass() {
    uint trips = 3u;
#define GLINT_ADD(FEATURE, kinds, loops) trips += FEATURE_##FEATURE ? loops : 0u;
    GLINT_LEAF_LOOPS(GLINT_ADD)
    return trips;
}

// Tests the primitives of a leaf, which are of one kind: a loop for each kind, of which a subgroup skips
// those that no lane enters.
void testLeaf(inout Traversal traversal, uint leaf) {
    uint kind = kindOfLeaf(leaf);
    uint first = leaf & kLeafFirstMask;
    uint end = first + sizeOfLeaf(leaf);
    if (mayPass(traversal)) {
        testEachHit(traversal, kind, first, end);
        return;
    }
    if (FEATURE_TRIANGLES) testEach(traversal, kKindTriangle, kind == kKindTriangle ? first : end, end);
    if (FEATURE_SPHERES) testEach(traversal, kKindSphere, kind == kKindSphere ? first : end, end);
    if (FEATURE_DISCS) testEach(traversal, kKindDisc, kind == kKindDisc ? first : end, end);
    if (FEATURE_POLYGONS) testEach(traversal, kKindPolygon, kind == kKindPolygon ? first : end, end);
    if (FEATURE_QUADRICS) testEach(traversal, kKindQuadric, kind == kKindQuadric ? first : end, end);
    if (FEATURE_CUBOIDS) testEach(traversal, kKindCuboid, kind == kKindCuboid ? first : end, end);
}

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
