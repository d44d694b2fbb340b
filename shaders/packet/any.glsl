// Any hits of a group of a packet's rays. No entry of the stack ever gets out of reach, but rays are settled.
// The farthest child comes first: a ray that leaves a surface would else test its own neighbourhood first,
// which seldom shades it.
#ifndef GLINT_PACKET_ANY_GLSL
#define GLINT_PACKET_ANY_GLSL

#include "packet/packet.glsl"

// A ray that has hit needs nothing more. True, in all lanes, if some ray does.
bool updateAwake() {
    uint awake = 0u;
    GLINT_EACH_RAY {
        if (settled(packet[r])) packetEnds[r] = -1.0;
        awake |= packetEnds[r] >= 0.0 ? 1u : 0u;
    }
    return anyOfLanes(awake) != 0u;
}

// Inner children that are still to be visited, of the nodes on the way down. A node's inner children follow
// each other (packetTree), so a level is one word, the same for all lanes: the number of the first one in its
// upper bits, then whether they are taken from the lowest lane on or from the highest, then which lanes'
// remain. Levels are held across the lanes, 8 in each of two registers.
struct PacketLevels {
    uvec2 levels;
    uint depth;
};
const uint kLevels = 16u;
const uint kLevelFirstShift = 9u;  // kMostPacketNodes in src/render/kernel_choice.h
const uint kLevelAscends = 256u;

// Returns the next node to visit, or kNone if no level is left. `first`: first inner child of the current
// node; the other inner children follow it. `entered`: lanes of the children to visit. The child in lane
// `farthest` comes next. The others wait as one level, and are taken from that end of the node. If no child
// is entered, the next node comes from the deepest level.
uint nextChild(inout PacketLevels levels, uint first, uint entered, uint farthest, uint lane) {
    bool down = entered != 0u;
    uint bit = 1u << farthest;
    uint pushed =
        (first << kLevelFirstShift) | (entered ^ bit) | ((entered & (bit - 1u)) == 0u ? kLevelAscends : 0u);
    uint last = levels.depth - 1u;
    uint deepest = subgroupShuffle(last < 8u ? levels.levels.x : levels.levels.y, last & 7u);
    uint waiting = deepest & 255u;
    uint place = (deepest & kLevelAscends) != 0u ? uint(findLSB(waiting)) : uint(findMSB(waiting));
    uint popped = deepest ^ (1u << (place & 7u));
    uint child =
        down ? first + farthest : (levels.depth == 0u ? kNone : (deepest >> kLevelFirstShift) + place);
    uint changed = down ? levels.depth : last;
    uint level = down ? pushed : popped;
    levels.levels.x = changed == lane ? level : levels.levels.x;
    levels.levels.y = changed == lane + 8u ? level : levels.levels.y;
    levels.depth = (level & 255u) != 0u ? changed + 1u : changed;
    return child;
}

// The rows that enter the child in this lane's place, if it is among the children `left` that the group
// enters.
uint rowsOfChild(uint left, vec3 nearPlane, vec3 farPlane, uint lane, inout uint trips) {
    uint entering = 0u;
    do {
        if (left != 0u) {
            uint place = uint(findLSB(left));
            left &= left - 1u;
            uint rows = rowsThatEnter(fromLane(nearPlane, place), fromLane(farPlane, place));
            entering = lane == place ? rows : entering;
            ++trips;
            if (MODE_COST) {
                GLINT_EACH_RAY packet[r].cost += packetEnds[r] >= 0.0 ? 1u : 0u;
            }
        }
    } while (left != 0u);
    return entering;
}

// Tests the leaves in the places `leaves` of a node, each by the rows that enter it.
void testLeaves(uint leaves, uint leafChild, uint leafRows, uint axis, uint lane, inout uint trips) {
    do {
        if (leaves != 0u) {
            uint place = uint(findLSB(leaves));
            leaves &= leaves - 1u;
            uint leaf = subgroupShuffle(leafChild, place);
            uint rows = subgroupShuffle(leafRows, place);
            testPacketLeaf(leaf, axis, lane, rows, trips);
            trips += 2u;
        }
    } while (leaves != 0u);
}

// Any-hit counterpart of the closest hit's walkGroup. Tests the leaves among a node's children at once; the
// inner children wait. At most 200 trips pass between two checks of the budget (8 boxes, and 8 leaves of 22).
// kPacketTurns packets therefore stay far below the trip limit of a subgroup (lanes.glsl).
bool walkGroup(uint group, uint root, uint lane, inout uint trips) {
    PacketLevels levels = PacketLevels(uvec2(0u), 0u);
    float end = -1.0;
    GLINT_EACH_RAY {
        precise float padded = packet[r].ray.tMax * kFarPad;
        packetEnds[r] = packet[r].ray.tMax > packet[r].ray.tMin ? padded : -1.0;
        end = larger(end, packetEnds[r]);
    }
    end = largestOfLanes(end);
    bool awake = updateAwake();
    bvec3 negative = signsOf(group);
    uint axis = group & 3u;
    PacketBounds bounds = boundsOf(negative);
    uint current = awake ? root : kNone;
    bool complete = true;
    // A constant of the dispatch costs 25 instructions wherever it stands, in a loop each time.
    uint budget = dispatch.tripBudget;
    do {
        if (current != kNone) {
            uint leaves = 0u;
            uint leafChild = kNone;
            uint leafRows = 0u;
            do {
                if (current != kNone) {
                    PacketCorner lower = loadPacketCorner(16u * current + lane);
                    vec3 upper = loadPacketCorner(16u * current + 8u + lane).corner;
                    vec3 nearPlane = mix(lower.corner, upper, negative);
                    vec3 farPlane = mix(upper, lower.corner, negative);
                    float near;
                    bool entered = groupEnters(bounds, nearPlane, farPlane, end, near);
                    uint left = anyOfLanes(entered ? 1u << lane : 0u);
                    uint entering = rowsOfChild(left, nearPlane, farPlane, lane, trips);
                    leafChild = lower.child;
                    leafRows = entering;
                    bool inner = isNode(lower.child);
                    uint some = anyOfLanes(entering != 0u ? (inner ? 1u : 256u) << lane : 0u);
                    leaves = some >> 8;
                    uint farthest =
                        largestOfLanes(inner && entering != 0u ? keyOf(near, lane, true) : 0u) & 7u;
                    bool full = levels.depth >= kLevels || trips > budget;
                    complete = complete && !full;
                    uint child =
                        nextChild(levels, subgroupShuffle(lower.child, 0u), some & 255u, farthest, lane);
                    current = full ? kNone : child;
                    trips += 2u;
                    if (MODE_COST) {
                        GLINT_EACH_RAY packet[r].cost += packetEnds[r] >= 0.0 ? 8u : 0u;
                    }
                }
            } while (current != kNone && leaves == 0u);
            testLeaves(leaves, leafChild, leafRows, axis, lane, trips);
            awake = updateAwake();
            current = awake ? current : kNone;
            ++trips;
        }
    } while (current != kNone);
    return complete;
}

#endif
