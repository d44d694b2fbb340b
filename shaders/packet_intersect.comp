#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_shuffle : require
// The closest hit of each live path, packet by packet: intersect.comp for subgroups of 8 lanes.
#include "path_rows.glsl"
#include "packet/hits.glsl"
#ifndef GLINT_ANY_HIT
#define GLINT_ANY_HIT 0
#endif
const uint kTurns = GLINT_ANY_HIT == 1 ? kPacketTurns : 1u;
bool isAnyHit(Traversal traversal) { return GLINT_ANY_HIT == 1; }

bool mayHaveRay(uint path) { return uintBitsToFloat(loadRow(kRowDirection, path).w) < kInfinity; }

void onePacket(uint turn) {
    uint paths[kPacketRays];
    Hit before[kPacketRays];
    bool live[kPacketRays];
    GLINT_EACH_RAY {
        bool present;
        paths[r] = packetPath(kTurns, turn, r, present);
        packet[r].ray = loadRay(paths[r]);
        before[r] = hitBefore(packet[r].ray, paths[r], kNone);
        packet[r].hit = before[r];
        packet[r].trips = 0u;
        live[r] = present && isAlive(packet[r].ray);
        packet[r].ray.tMax = live[r] ? packet[r].hit.t : -1.0;
    }
    packetTrips = 0u;
    bool complete = tracePacket(loadEnvironment(0u));
    // Stores are expensive (traversal/lanes.glsl): rows that do not change are not stored, and the walk row
    // is stored only for kernels that read it.
    uint unfinished = 0u;
    GLINT_EACH_RAY {
        Hit hit = packet[r].hit;
        bool goesOn = live[r] && !complete && !settled(packet[r]);
        if (live[r] && (goesOn || hit.primitive != before[r].primitive)) {
            uvec4 row = hitRowOf(hit);
            storeRow(kRowHit, paths[r], uvec4(row.x | (goesOn ? kStartAgain : 0u), row.yzw));
        }
        if (goesOn)
            storeRow(
                kRowLight, paths[r],
                uvec4(hit.id, floatBitsToUint(packet[r].nearest), floatBitsToUint(packet[r].ray.tMax), 0u));
        if (MODE_AOVS) {
            uvec4 walkRow = loadRow(kRowWalk, paths[r]);
            if (live[r]) storeRow(kRowWalk, paths[r], uvec4(kNone, hit.id, walkRow.z, walkRow.w));
        }
        unfinished += goesOn ? 1u : 0u;
    }
    if (unfinished > 0u) atomicAdd(counters[kCounterUnfinished], unfinished);
}

void main() { eachPacket(kTurns); }
