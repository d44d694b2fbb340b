#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_shuffle : require
// How often each ray crosses surfaces in its interval, and with GLINT_LIST where.
// The rows of a ray: kRowHit holds tMax, the number, 1 where it is in doubt, 1 where a packet gave it up
// (packet_count.comp) and the number is that of planes; kRowThroughput, of a list,
// its first place and how many there are.
#define GLINT_CROSSINGS
#include "path.glsl"
#include "traversal.glsl"

void main() {
    uint path = pathIndex();
    uvec4 walkRow = loadWalkRow(path);
    Traversal traversal;
    traversal.ray = loadRay(path);
    uvec4 hitRow = uvec4(floatBitsToUint(traversal.ray.tMax), 0u, 0u, 0u);
    if (!kFirstGiven) hitRow = loadRow(kRowHit, path);
    if (MODE_RESUME && hitRow.w != 0u) walkRow.x = 0u;
    traversal.hit = Hit(uintBitsToFloat(hitRow.x), 0.0, 0.0, kNone, kNone, 0u);
    traversal.trips = 0u;
    traversal.cost = 0u;
    traversal.crossed = hitRow.y;
    traversal.doubtful = hitRow.z;
    traversal.list = uvec2(0u);
#ifdef GLINT_LIST
    traversal.list = loadRow(kRowThroughput, path).xy;
#endif
    bool live = isAlive(traversal.ray) && (!MODE_RESUME || walkRow.x != kNone);
    traversal.ray.tMax = live ? traversal.hit.t : -1.0;
    uvec4 instanceRow = loadInstanceRow(path);
    uint slot = trace(traversal, loadEnvironment(0u), walkRow.x, instanceRow.zw);
    if (live) storeRow(kRowHit, path, uvec4(hitRow.x, traversal.crossed, traversal.doubtful, 0u));
    if (FEATURE_INSTANCES && live && (MODE_RESUME || slot != kNone))
        storeInstanceRow(path, uvec4(kNone, instanceRow.y, traversal.instance, traversal.worldSlot));
    if (live && (MODE_RESUME || slot != kNone)) storeRow(kRowWalk, path, uvec4(slot, 0u, 0u, 0u));
    if (live && slot != kNone) atomicAdd(counters[kCounterUnfinished], 1u);
}
