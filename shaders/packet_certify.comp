#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
// The nearest hit of each ray, and whether it is certain, packet by packet: certify.comp for subgroups of 8
// lanes. Rows as there; of a packet that is given up no ray is certain.
#define GLINT_CERTIFY
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
        uvec4 hitRow = loadRow(kRowHit, paths[r]);
        live[r] = present && isAlive(packet[r].ray);
        packet[r].ray.tMax = live[r] ? uintBitsToFloat(hitRow.x) : -1.0;
        packet[r].hit = Hit(packet[r].ray.tMax, 0.0, 0.0, kNone, kNone, 0u);
        packet[r].trips = 0u;
        packet[r].cost = 0u;
        packet[r].certainty =
            beginCertainty(packet[r].ray, uintBitsToFloat(hitRow.y), uintBitsToFloat(hitRow.z));
    }
    packetTrips = 0u;
    bool complete = tracePacket(loadEnvironment(0u));
    // The row of a certain miss stays as it is: stores are dear (packet_intersect.comp).
    GLINT_EACH_RAY {
        Hit hit = packet[r].hit;
        bool certain = complete && isCertain(packet[r].certainty, hit, packet[r].ray.tMax);
        if (live[r] && (!certain || hit.primitive != kNone)) {
            uint t = floatBitsToUint(hit.t) | (certain ? 0u : 0x80000000u);
            storeRow(kRowHit, paths[r],
                     uvec4(t, floatBitsToUint(hit.u), floatBitsToUint(hit.v), hit.primitive));
        }
    }
}
