#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_shuffle : require
// How often each ray crosses triangles and planes in its interval, packet by packet: count.comp for subgroups
// of 8 lanes. A ray's doubts stand in its hit's id.
#define GLINT_CROSSINGS true
#include "path_rows.glsl"
#include "packet/packet.glsl"
#include "traversal/count.glsl"

void testTriangle(inout Traversal one, vec3 a, vec3 b, vec3 c, vec3 v0, vec3 normal, uint primitive, uint id,
                  bool present) {
    float t, u, v;
    doubts = 0u;
    bool live = present && one.ray.tMax > one.ray.tMin;
    if (live && crossTriangle(one.ray, seenAlong(one.frame, a, b, c), t, u, v)) ++one.crossings;
    one.hit.id |= doubts;
}

void testPacketLeaf(uint leaf, uint axis, uint lane, uint rows, inout uint trips) {
    uint first = leaf & kLeafFirstMask;
    testPacketTriangles(axis, first, first + sizeOfLeaf(leaf), lane, rows, trips);
}

void main() {
    uint paths[kPacketRays];
    bool live[kPacketRays];
    float tMax[kPacketRays];
    GLINT_EACH_RAY {
        bool present;
        paths[r] = packetPath(1u, 0u, r, present);
        packet[r].ray = loadRay(paths[r]);
        tMax[r] = packet[r].ray.tMax;
        live[r] = present && isAlive(packet[r].ray);
        if (!live[r]) packet[r].ray.tMax = -1.0;
        packet[r].hit = Hit(tMax[r], 0.0, 0.0, kNone, kNone, 0u);
        packet[r].trips = 0u;
        packet[r].crossings = 0u;
    }
    packetTrips = 0u;
    bool complete = tracePacket(loadEnvironment(0u));
    uint unfinished = 0u;
    GLINT_EACH_RAY {
        uint unsure = packet[r].hit.id;
        bool again = !complete || (unsure & kAtEdge) != 0u;
        uvec2 counted = again ? uvec2(0u) : uvec2(packet[r].crossings, unsure & kNearOrigin);
        if (live[r]) storeRow(kRowHit, paths[r], uvec4(floatBitsToUint(tMax[r]), counted, 0u));
        if (live[r] && again) storeRow(kRowWalk, paths[r], uvec4(kSlotFresh, 0u, 0u, 0u));
        unfinished += live[r] && again ? 1u : 0u;
    }
    if (unfinished > 0u) atomicAdd(counters[kCounterUnfinished], unfinished);
}
