#version 450
#extension GL_GOOGLE_include_directive : require
// The closest hit of each live path.
#include "path.glsl"
#include "traversal.glsl"

void main() {
    uint path = pathIndex();
    uvec4 walkRow = loadRow(kRowWalk, path);
    Traversal traversal;
    traversal.ray = loadRay(path);
    traversal.hit = loadHit(path, walkRow.y);
    traversal.trips = 0u;
    traversal.cost = 0u;
    bool live = isAlive(traversal.ray) && (!MODE_RESUME || walkRow.x != kNone);
    traversal.ray.tMax = live ? traversal.hit.t : -1.0;
    uvec4 instanceRow = loadInstanceRow(path);
    uint slot = trace(traversal, loadEnvironment(0u), walkRow.x, instanceRow.zw);
    if (live) {
        Hit hit = traversal.hit;
        storeRow(kRowHit, path, uvec4(floatBitsToUint(hit.t), floatBitsToUint(hit.u), floatBitsToUint(hit.v), hit.primitive));
        storeInstanceRow(path, uvec4(hit.instance, instanceRow.y, traversal.instance, traversal.worldSlot));
        storeRow(kRowWalk, path, uvec4(slot, hit.id, walkRow.z + traversal.cost, walkRow.w));
        if (slot != kNone) atomicAdd(counters[kCounterUnfinished], 1u);
    }
}
