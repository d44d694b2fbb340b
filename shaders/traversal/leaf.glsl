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

// True if the ray passes through its hit: a hole, or as a shadow ray a dielectric, which filters the light.
bool passesThrough(inout Traversal traversal, uint kind, Hit hit) {
    Met met = surfaceOfHit(traversal, kind, hit);
    bool through = FEATURE_ALPHA_MASK && holeAt(met.surface);
    if (FEATURE_COLORED_SHADOWS && isShadowRay(traversal) && !through)
        through = passes(traversal.passage, met, kind, hit.t);
    return through;
}

void handleHit(inout Traversal traversal, uint kind, Hit hit) {
    if (!passesThrough(traversal, kind, hit)) accept(traversal, hit.t, hit.u, hit.v, hit.primitive, hit.id);
}

void testTriangles(inout Traversal traversal, uint first, uint end) {
    uint index = first;
    do {
        if (index < end) {
            uint primitive = (kKindTriangle << kPrimitiveKindShift) | index;
            Hit hit;
            if (hitTriangle(traversal, traversal.ray, index, primitive, hit))
                accept(traversal, hit.t, hit.u, hit.v, hit.primitive, hit.id);
            ++index;
            ++traversal.trips;
            if (MODE_COST) ++traversal.cost;
        }
    } while (index < end);
}

// The same for the kinds whose files have hit<Kind>.
#define GLINT_TEST_EACH(Kind)                                                                                \
    void test##Kind##s(inout Traversal traversal, uint first, uint end) {                                    \
        uint index = first;                                                                                  \
        do {                                                                                                 \
            if (index < end) {                                                                               \
                uint primitive = (kKind##Kind << kPrimitiveKindShift) | index;                               \
                Hit hit;                                                                                     \
                if (hit##Kind(traversal.ray, traversal.frame, load##Kind(index), primitive, traversal.trips, \
                              hit))                                                                          \
                    accept(traversal, hit.t, hit.u, hit.v, hit.primitive, hit.id);                           \
                ++index;                                                                                     \
                ++traversal.trips;                                                                           \
                if (MODE_COST) ++traversal.cost;                                                             \
            }                                                                                                \
        } while (index < end);                                                                               \
    }
GLINT_TEST_EACH(Sphere)
GLINT_TEST_EACH(Disc)
GLINT_TEST_EACH(Polygon)
GLINT_TEST_EACH(Quadric)
GLINT_TEST_EACH(Cuboid)

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
    if (FEATURE_TRIANGLES) testTriangles(traversal, kind == kKindTriangle ? first : end, end);
    if (FEATURE_SPHERES) testSpheres(traversal, kind == kKindSphere ? first : end, end);
    if (FEATURE_DISCS) testDiscs(traversal, kind == kKindDisc ? first : end, end);
    if (FEATURE_POLYGONS) testPolygons(traversal, kind == kKindPolygon ? first : end, end);
    if (FEATURE_QUADRICS) testQuadrics(traversal, kind == kKindQuadric ? first : end, end);
    if (FEATURE_CUBOIDS) testCuboids(traversal, kind == kKindCuboid ? first : end, end);
}

// Planes are infinite and in no leaf: every ray tests all of them. Their trips are in the budget already.
void testPlanes(inout Traversal traversal, uint planeCount) {
    uint trips = traversal.trips;
    if (mayPass(traversal) && FEATURE_OPEN_PLANES) {
        testEachHit(traversal, kKindPlane, 0u, planeCount);
        traversal.trips = trips;
        return;
    }
    uint index = 0u;
    do {
        if (index < planeCount) {
            uint primitive = (kKindPlane << kPrimitiveKindShift) | index;
            Hit hit;
            if (hitPlane(traversal.ray, traversal.frame, loadPlane(index), primitive, traversal.trips, hit))
                accept(traversal, hit.t, hit.u, hit.v, hit.primitive, hit.id);
            ++index;
            if (MODE_COST) ++traversal.cost;
        }
    } while (index < planeCount);
}

#endif
