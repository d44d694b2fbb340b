// The hit of a ray and a primitive of any kind.
#ifndef GLINT_HIT_GLSL
#define GLINT_HIT_GLSL

#include "traversal/state.glsl"

// The closest hit of triangle `index` in the interval of `ray`, which is the traversal's or the rest of it.
// Crossings have a test of their own: traversal/leaf.glsl or traversal/count.glsl.
bool hitTriangle(inout Traversal traversal, Ray ray, uint index, uint primitive, out Hit hit);

// The same for a primitive of any kind. Each kind's file has the formulas.
bool hitPrimitive(inout Traversal traversal, Ray ray, uint kind, uint index, out Hit hit) {
    uint primitive = (kind << kPrimitiveKindShift) | index;
    bool isHit = false;
    hit = Hit(0.0, 0.0, 0.0, kNone, kNone, 0u);
    if (FEATURE_TRIANGLES && kind == kKindTriangle)
        isHit = hitTriangle(traversal, ray, index, primitive, hit);
    if (FEATURE_SPHERES && kind == kKindSphere)
        isHit = hitSphere(ray, traversal.frame, loadSphere(index), primitive, traversal.trips, hit);
    if (FEATURE_PLANES && kind == kKindPlane)
        isHit = hitPlane(ray, traversal.frame, loadPlane(index), primitive, traversal.trips, hit);
    if (FEATURE_DISCS && kind == kKindDisc)
        isHit = hitDisc(ray, traversal.frame, loadDisc(index), primitive, traversal.trips, hit);
    if (FEATURE_POLYGONS && kind == kKindPolygon)
        isHit = hitPolygon(ray, traversal.frame, loadPolygon(index), primitive, traversal.trips, hit);
    if (FEATURE_QUADRICS && kind == kKindQuadric)
        isHit = hitQuadric(ray, traversal.frame, loadQuadric(index), primitive, traversal.trips, hit);
    if (FEATURE_CUBOIDS && kind == kKindCuboid)
        isHit = hitCuboid(ray, traversal.frame, loadCuboid(index), primitive, traversal.trips, hit);
    return isHit;
}

// True if a ray may hit a primitive of this kind more than once.
bool hasFurtherHits(uint kind) { return kind == kKindSphere || kind == kKindQuadric || kind == kKindCuboid; }

// The surface at a hit in the coordinates that the traversal is in.
Met surfaceOfHit(Traversal traversal, uint kind, Hit hit) {
    if (FEATURE_INSTANCES) hit.instance = traversal.instance;
    return metAt(traversal.ray, kind, hit);
}

#endif
