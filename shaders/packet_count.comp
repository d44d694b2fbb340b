#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
// How often each ray crosses triangles and planes in its interval, packet by packet: count.comp for subgroups
// of 8 lanes. Rows as there; a ray that is to be started again by itself has a 1 in the last word.
#define GLINT_CROSSINGS
#include "path.glsl"
#include "packet.glsl"

bool mayHaveRay(uint path) { return uintBitsToFloat(loadRow(kRowDirection, path).w) < kInfinity; }

void main() {
    uint paths[GLINT_PACKET_RAYS];
    bool live[GLINT_PACKET_RAYS];
    GLINT_EACH_RAY {
        bool present;
        paths[r] = packetPath(0u, r, present);
        packet[r].ray = loadRay(paths[r]);
        packet[r].hit = hitBefore(packet[r].ray, paths[r], 0u);
        packet[r].trips = 0u;
        packet[r].cost = 0u;
        packet[r].crossed = 0u;
        packet[r].doubtful = 0u;
        packet[r].aside = 0u;
        packet[r].aside0 = uvec4(kNone);
        live[r] = present && isAlive(packet[r].ray);
        packet[r].ray.tMax = live[r] ? packet[r].hit.t : -1.0;
    }
    packetTrips = 0u;
    bool complete = tracePacket(loadEnvironment(0u));
    bool again[GLINT_PACKET_RAYS];
    uint unfinished = 0u;
    GLINT_EACH_RAY {
        again[r] = live[r] && (!complete || packet[r].aside > kMostPacketAside);
        packet[r].aside = again[r] ? 0u : packet[r].aside;
        unfinished += again[r] ? 1u : 0u;
    }
    settlePacketAside();
    GLINT_EACH_RAY {
        if (live[r])
            storeRow(kRowHit, paths[r],
                     uvec4(floatBitsToUint(packet[r].hit.t), again[r] ? packet[r].list.x : packet[r].crossed,
                           again[r] ? 0u : packet[r].doubtful, again[r] ? 1u : 0u));
    }
    if (unfinished > 0u) atomicAdd(counters[kCounterUnfinished], unfinished);
}
