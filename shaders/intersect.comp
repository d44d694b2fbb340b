#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_shuffle : require
// The closest hit of each live path.
#include "path_rows.glsl"
#include "primitives/textbook.glsl"
#include "traversal/leaf.glsl"
#include "traversal/stack.glsl"
#include "traversal/stackless.glsl"

#ifndef GLINT_ANY_HIT
#define GLINT_ANY_HIT 0
#endif
bool isAnyHit(Traversal traversal) { return GLINT_ANY_HIT == 1; }
bool entersBox(Traversal traversal, vec3 lo, vec3 hi) { return rayEntersBox(traversal, lo, hi); }

void main() {
    bool present;
    uint path = listedPath(present);
    uvec4 walkRow = loadWalkRow(path);
    Traversal traversal;
    traversal.ray = loadRay(path);
    traversal.hit = hitBefore(traversal.ray, path, walkRow.y);
    // Later rays have no far end, and their hit rows are not made ready for them.
    bool later = dispatch.bounce != 0u;
    if (!MODE_RESUME && kBounces && later) traversal.hit = Hit(kInfinity, 0.0, 0.0, kNone, kNone, 0u);
    traversal.trips = 0u;
    traversal.cost = 0u;
    bool packetGaveUp = MODE_RESUME && (floatBitsToUint(traversal.hit.t) & kStartAgain) != 0u;
    if (packetGaveUp) {
        traversal.hit.t = abs(traversal.hit.t);
        walkRow.x = 0u;
    }
    uint before = traversal.hit.primitive;
    bool live = present && isAlive(traversal.ray) && (!MODE_RESUME || walkRow.x != kNone);
    if (MODE_TALLY && FEATURE_TRANSMISSION)
        live = live && loadRow(treeRow(kTreeRowBranch), path).z == dispatch.rayClass;
    traversal.ray.tMax = live ? traversal.hit.t : -1.0;
    // Bound on the closest hit's t from earlier dispatches (accept).
    traversal.nearest = traversal.hit.t;
    if (MODE_RESUME) {
        uvec4 bounds = loadRow(kRowLight, path);
        traversal.hit.id = bounds.x;
        traversal.nearest = uintBitsToFloat(bounds.y);
        if (live) traversal.ray.tMax = uintBitsToFloat(bounds.z);
    }
    uvec4 instanceRow = loadInstanceRow(path);
    uint slot;
    if (MODE_RESUME)
        slot = resume(traversal, loadEnvironment(0u), walkRow.x, instanceRow.zw);
    else
        slot = trace(traversal, loadEnvironment(0u));
    Hit hit = traversal.hit;
    // Stores are expensive (traversal/lanes.glsl): a camera ray's rows stay as they are where nothing
    // changes.
    bool changes = MODE_RESUME || hit.primitive != before || (kBounces && later);
    if (live && changes) storeRow(kRowHit, path, hitRowOf(hit));
    if (FEATURE_INSTANCES && live && (changes || slot != kNone))
        storeInstanceRow(path, uvec4(hit.instance, instanceRow.y, traversal.instance, traversal.worldSlot));
    if (live && (MODE_RESUME || MODE_AOVS || MODE_COST || slot != kNone))
        storeRow(kRowWalk, path, uvec4(slot, hit.id, walkRow.z + traversal.cost, walkRow.w));
    if (live && slot != kNone) {
        storeRow(kRowLight, path,
                 uvec4(hit.id, floatBitsToUint(traversal.nearest), floatBitsToUint(traversal.ray.tMax), 0u));
        atomicAdd(counters[kCounterUnfinished], 1u);
    }
}
