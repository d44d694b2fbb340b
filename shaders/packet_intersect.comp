#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
// The closest hit of each live path, packet by packet: intersect.comp for subgroups of 8 lanes. A lane takes GLINT_PACKET_RAYS paths, those of
// a subgroup being consecutive: 8 are a block of 4x2 pixels, 16 one of 4x4, 32 one of 8x4.
#include "path.glsl"
#include "packet.glsl"

void main() {
    uint paths[GLINT_PACKET_RAYS];
    Hit before[GLINT_PACKET_RAYS];
    bool live[GLINT_PACKET_RAYS];
    Traversal packet[GLINT_PACKET_RAYS];
    uint lane = gl_LocalInvocationID.x & 7u;
    uint firstPath = (gl_GlobalInvocationID.x - lane) * GLINT_PACKET_RAYS + lane;
    GLINT_EACH_RAY {
        paths[r] = firstPath + 8u * r;
        packet[r].ray = loadRay(paths[r]);
        before[r] = loadHit(paths[r], kNone);
        packet[r].hit = before[r];
        packet[r].trips = 0u;
        packet[r].cost = 0u;
        live[r] = isAlive(packet[r].ray) && paths[r] < dispatch.run * dispatch.interleave * kWorkgroupSize;
        packet[r].ray.tMax = live[r] ? packet[r].hit.t : -1.0;
    }
    bool complete = tracePacket(packet, loadEnvironment(0u));
    // lavapipe stores word by word and lane by lane, 14 instructions each: so nothing is stored that does not change, and the walk row
    // only for kernels that read what is in it.
    uint unfinished = 0u;
    GLINT_EACH_RAY {
        Hit hit = packet[r].hit;
        bool goesOn = live[r] && !complete && !settled(packet[r]);
        if (live[r] && (goesOn || hit.primitive != before[r].primitive)) {
            uint t = floatBitsToUint(hit.t) | (goesOn ? kStartAgain : 0u);
            storeRow(kRowHit, paths[r], uvec4(t, floatBitsToUint(hit.u), floatBitsToUint(hit.v), hit.primitive));
        }
        if (MODE_AOVS || MODE_COST) {
            uvec4 walkRow = loadRow(kRowWalk, paths[r]);
            if (live[r]) storeRow(kRowWalk, paths[r], uvec4(kNone, hit.id, walkRow.z + packet[r].cost, walkRow.w));
        }
        unfinished += goesOn ? 1u : 0u;
    }
    if (unfinished > 0u) atomicAdd(counters[kCounterUnfinished], unfinished);
}
