#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_shuffle : require
// How often each ray crosses surfaces in its interval, and with MODE_LIST where. Rows of a ray: kRowHit holds
// tMax, the number of crossings, doubts about it (traversal/count.glsl), 0; with MODE_LIST kRowThroughput
// holds the place of the first crossing in the list and the number of crossings.
#define GLINT_CROSSINGS true
#include "path_rows.glsl"
#include "traversal/count.glsl"

void main() {
    uint path = pathIndex();
    uvec4 walkRow = loadWalkRow(path);
    Traversal traversal;
    traversal.ray = loadRay(path);
    uvec4 hitRow = uvec4(floatBitsToUint(traversal.ray.tMax), 0u, 0u, 0u);
    if (!kFirstGiven) hitRow = loadRow(kRowHit, path);
    traversal.hit = Hit(uintBitsToFloat(hitRow.x), 0.0, 0.0, kNone, kNone, 0u);
    traversal.trips = 0u;
    traversal.cost = 0u;
    traversal.nearest = kInfinity;
    traversal.crossings = hitRow.y;
    if (MODE_LIST) listOfRay = loadRow(kRowThroughput, path).xy;
    bool live = isAlive(traversal.ray) && (!MODE_RESUME || walkRow.x != kNone);
    traversal.ray.tMax = live ? traversal.hit.t : -1.0;
    uvec4 instanceRow = loadInstanceRow(path);
    for (uint i = 0u; i < kCountLeaves; ++i) leaves[i] = kNone;
    // A leaf of polygons may take so many trips that the budget has room for one.
    uint slot;
    if (MODE_RESUME || FEATURE_POLYGONS)
        slot = resume(traversal, loadEnvironment(0u), MODE_RESUME ? walkRow.x : kSlotFresh, instanceRow.zw);
    else
        slot = trace(traversal, loadEnvironment(0u));
    bool again = (!MODE_RESUME && slot != kNone) || (doubts & kAtEdge) != 0u;
    if (again) slot = kSlotFresh;
    bool unfinished = live && slot != kNone;
    uvec2 counted = again ? uvec2(0u) : uvec2(traversal.crossings, hitRow.z | (doubts & kNearOrigin));
    if (live) storeRow(kRowHit, path, uvec4(hitRow.x, counted, 0u));
    if (FEATURE_INSTANCES && live && (MODE_RESUME || unfinished))
        storeInstanceRow(path, uvec4(kNone, instanceRow.y, traversal.instance, traversal.worldSlot));
    if (live && (MODE_RESUME || unfinished)) storeRow(kRowWalk, path, uvec4(slot, 0u, 0u, 0u));
    if (unfinished) atomicAdd(counters[kCounterUnfinished], 1u);
}
