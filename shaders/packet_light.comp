#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_shuffle : require
// Adds the light of the scene's lights to each hit, packet by packet: light.comp for subgroups of 8 lanes.
#define GLINT_SHADOW_RAYS true
#include "packet/hits.glsl"
#include "shading/light.glsl"

bool isAnyHit(Traversal traversal) { return true; }

// A path that hit nothing, or ended before, has nothing to light.
bool mayHaveRay(uint path) { return loadRow(kRowHit, path).w != kNone; }

void onePacket(uint turn) {
    Lit lit[kPacketRays];
    GLINT_EACH_RAY {
        bool present;
        uint path = packetPath(kPacketTurns, turn, r, present);
        lit[r] = loadLit(path, present, loadWalkRow(path));
        packet[r].cost = 0u;
    }
    Environment environment = loadEnvironment(0u);
    packetTrips = 0u;
    uint index = dispatch.lightIndex;
    uint end = dispatch.lightEnd;
    bool complete = true;
    Sight sights[kPacketRays];
    do {
        if (index < end) {
            GLINT_EACH_RAY sights[r] = aim(lit[r], index, true, packet[r]);
            complete = tracePacket(environment);
            GLINT_EACH_RAY take(lit[r], index, sights[r], packet[r], complete);
            ++index;
        }
    } while (complete && index < end);
    // After a packet was given up, rays that are not settled must start again.
    GLINT_EACH_RAY {
        bool again = sights[r].facing && !settled(packet[r]);
        uint further = index < end ? kSlotFresh : kNone;
        Rest rest = Rest(complete ? kNone : (again ? 0u : further), again ? index - 1u : index);
        store(lit[r], packet[r], rest);
    }
}

void main() { eachPacket(kPacketTurns); }
