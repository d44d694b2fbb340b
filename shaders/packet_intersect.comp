#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
// The closest hit of each live path, packet by packet: intersect.comp for subgroups of 8 lanes. A lane takes kPacketRays paths, those of a
// subgroup being consecutive: 8 are a block of 4x2 pixels, 16 one of 4x4.
#include "path.glsl"
#include "packet.glsl"

void main() {
    uint paths[GLINT_PACKET_RAYS];
    uvec4 walkRows[GLINT_PACKET_RAYS];
    bool live[GLINT_PACKET_RAYS];
    Traversal packet[GLINT_PACKET_RAYS];
    uint lane = gl_LocalInvocationID.x & 7u;
    uint firstPath = (gl_GlobalInvocationID.x - lane) * GLINT_PACKET_RAYS + lane;
    GLINT_EACH_RAY {
        paths[r] = firstPath + 8u * r;
        walkRows[r] = loadRow(kRowWalk, paths[r]);
        packet[r].ray = loadRay(paths[r]);
        packet[r].hit = loadHit(paths[r], walkRows[r].y);
        packet[r].trips = 0u;
        packet[r].cost = 0u;
        live[r] = isAlive(packet[r].ray) && paths[r] < dispatch.run * dispatch.interleave * kWorkgroupSize;
        packet[r].ray.tMax = live[r] ? packet[r].hit.t : -1.0;
    }
    uint slots[GLINT_PACKET_RAYS];
    tracePacket(packet, loadEnvironment(0u), slots);
    GLINT_EACH_RAY {
        if (live[r]) {
            Hit hit = packet[r].hit;
            storeRow(kRowHit, paths[r], uvec4(floatBitsToUint(hit.t), floatBitsToUint(hit.u), floatBitsToUint(hit.v), hit.primitive));
            storeRow(kRowWalk, paths[r], uvec4(slots[r], hit.id, walkRows[r].z + packet[r].cost, walkRows[r].w));
            if (slots[r] != kNone) atomicAdd(counters[kCounterUnfinished], 1u);
        }
    }
}
