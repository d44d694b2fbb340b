#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_shuffle : require
#ifdef GLINT_PACKET
#extension GL_KHR_shader_subgroup_basic : require
#endif
// What the lights add to each hit. A dispatch goes through as many lights as its loop trips allow
// (Dispatch::lightEnd).
#define GLINT_ANY_HIT
#define GLINT_SHADOW_RAYS
#include "path.glsl"
#include "passage.glsl"
#ifdef GLINT_PACKET
#include "packet.glsl"
#else
#include "traversal.glsl"
#endif
#include "lighting.glsl"

Lit loadLit(uint path, bool present, uvec4 walkRow) {
    Interaction at = interactionAt(loadRay(path), loadHit(path, walkRow.y), loadMedia(path));
    return litAt(path, present && isAlive(at.ray), at, loadRow(kRowRadiance, path),
                 uintBitsToFloat(loadRow(kRowThroughput, path).xyz));
}

// Where a path goes on that has run out of trips, kNone in `slot` if it has not.
struct Rest {
    uint slot;
    uint light;
};

void store(Lit lit, Traversal traversal, Rest rest) {
    bool unfinished = lit.live && rest.slot != kNone;
    if (lit.changed) storeRow(kRowRadiance, lit.path, packRow(lit.radiance, lit.hits));
    // Not stored where nobody reads what would change (packet_intersect.comp says what a store costs).
    if (lit.live && (MODE_AOVS || MODE_COST || MODE_RESUME || unfinished)) {
        uvec4 walkRow = loadWalkRow(lit.path);
        storeRow(kRowWalk, lit.path,
                 uvec4(rest.slot, walkRow.y, walkRow.z + traversal.cost, walkRow.w | lit.shadowBits));
    }
    if (unfinished) {
        storeRow(kRowLight, lit.path, uvec4(rest.light, 0u, 0u, 0u));
        if (kFiltered) storeRow(treeRow(kTreeRowShadow), lit.path, packRow(traversal.passage.depth, 0u));
        storeInstanceRow(lit.path,
                         uvec4(loadInstanceRow(lit.path).xy, traversal.instance, traversal.worldSlot));
        atomicAdd(counters[kCounterUnfinished], 1u);
    }
}

#ifdef GLINT_PACKET
// A path that hit nothing, or ended before, has nothing to light.
bool mayHaveRay(uint path) { return loadRow(kRowHit, path).w != kNone; }

void onePacket(uint turn) {
    Lit lit[GLINT_PACKET_RAYS];
    GLINT_EACH_RAY {
        bool present;
        uint path = packetPath(turn, r, present);
        lit[r] = loadLit(path, present, loadWalkRow(path));
        packet[r].cost = 0u;
    }
    Environment environment = loadEnvironment(0u);
    packetTrips = 0u;
    uint index = dispatch.lightIndex;
    uint end = dispatch.lightEnd;
    bool complete = true;
    Sight sights[GLINT_PACKET_RAYS];
    do {
        if (index < end) {
            GLINT_EACH_RAY sights[r] = aim(lit[r], index, true, packet[r]);
            complete = tracePacket(environment);
            GLINT_EACH_RAY take(lit[r], index, sights[r], packet[r], complete);
            ++index;
        }
    } while (complete && index < end);
    // Of a packet that was given up, rays that are not settled are to be started again.
    GLINT_EACH_RAY {
        bool again = sights[r].facing && !settled(packet[r]);
        uint further = index < end ? kSlotFresh : kNone;
        Rest rest = Rest(complete ? kNone : (again ? 0u : further), again ? index - 1u : index);
        store(lit[r], packet[r], rest);
    }
}

void main() {
    uint turn = 0u;
    do {
        onePacket(nextPacket(turn));
    } while (turn < kPacketTurns);
}
#else
void main() {
    bool present;
    uint path = listedPath(present);
    uvec4 walkRow = loadWalkRow(path);
    Lit lit = loadLit(path, present && (!MODE_RESUME || walkRow.x != kNone), walkRow);
    Environment environment = loadEnvironment(0u);
    uvec2 place = loadInstanceRow(path).zw;
    Rest rest = Rest(kSlotFresh, dispatch.lightIndex);
    if (MODE_RESUME) rest = Rest(walkRow.x, loadRow(kRowLight, path).x);
    uint end = dispatch.lightEnd;
    uint budget = dispatch.tripBudget;
    Traversal traversal;
    traversal.trips = 0u;
    traversal.cost = 0u;
    bool going = lit.live && rest.light < end;
    do {
        if (kConvergent || going) {
            Sight sight = kNoSight;
            if (going) sight = aim(lit, rest.light, rest.slot == kSlotFresh, traversal);
            if (kConvergent && !going) removeRay(traversal);
            uint left = trace(traversal, environment, rest.slot, place);
            if (going) {
                bool finished = left == kNone || settled(traversal) || !sight.facing;
                take(lit, rest.light, sight, traversal, finished);
                rest.slot = finished ? kSlotFresh : left;
                rest.light += finished ? 1u : 0u;
                going = finished && rest.light < end && traversal.trips < budget;
            }
        }
    } while (anyGoesOn(going));
    if (rest.light >= end) rest.slot = kNone;
    store(lit, traversal, rest);
}
#endif
