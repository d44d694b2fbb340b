#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_shuffle : require
// The nearest hit of each ray, and whether it is certain. kRowHit comes with tMax, Certainty::slack and
// Certainty::boxSlack, and goes as intersect.comp leaves it, with a sign before t where it is not certain: so
// also if the walk runs out of trips.
#define GLINT_CERTIFY
#include "path.glsl"
#include "traversal.glsl"

void main() {
    uint path = pathIndex();
    uvec4 hitRow = loadRow(kRowHit, path);
    Environment environment = loadEnvironment(0u);
    Traversal traversal;
    traversal.ray = loadRay(path);
    traversal.ray.tMax = isAlive(traversal.ray) ? uintBitsToFloat(hitRow.x) : -1.0;
    traversal.hit = Hit(traversal.ray.tMax, 0.0, 0.0, kNone, kNone, 0u);
    traversal.trips = 0u;
    traversal.cost = 0u;
    traversal.certainty = beginCertainty(traversal.ray, uintBitsToFloat(hitRow.y), uintBitsToFloat(hitRow.z));
    bool sound = prepare(traversal, environment);
    if (FEATURE_PLANES) judgePlanes(traversal, sound ? environment.planeCount : 0u);
    uint left = traverse(traversal, kHasTree && sound ? environment.root : kNone);
    bool certain = left == kNone && isCertain(traversal.certainty, traversal.hit, traversal.ray.tMax);
    Hit hit = traversal.hit;
    uint t = floatBitsToUint(hit.t) | (certain ? 0u : 0x80000000u);
    storeRow(kRowHit, path, uvec4(t, floatBitsToUint(hit.u), floatBitsToUint(hit.v), hit.primitive));
    storeInstanceRow(path, uvec4(traversal.hit.instance, kNone, kNone, kNone));
}
