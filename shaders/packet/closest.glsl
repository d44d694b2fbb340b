// The closest hits of a group of a packet's rays: nodes in order of distance.
#ifndef GLINT_PACKET_CLOSEST_GLSL
#define GLINT_PACKET_CLOSEST_GLSL

#include "packet/packet.glsl"

// The topmost entry that some ray may still reach, kNone if there is none; all above it are dropped. `end` is
// the key of the farthest point that any ray may still reach. rows: those that enter its box.
uint popReachable(inout PacketStack stack, uint end, uint lane, inout uint rows) {
    uint height = 0u;
    for (uint row = 0u; row < GLINT_STACK_ROWS; ++row) {
        uint place = 8u * row + lane;
        bool reachable = place < stack.top && stack.key[row] <= end;
        height = reachable ? place + 1u : height;
    }
    height = largestOfLanes(height);
    bool empty = height == 0u;
    uint place = height - 1u;
    uint row = place >> 3;
    uint held =
        row == 0u ? stack.child.x : (row == 1u ? stack.child.y : (row == 2u ? stack.child.z : stack.child.w));
    uint child = subgroupShuffle(held, place & 7u);
    uint heldKey =
        row == 0u ? stack.key.x : (row == 1u ? stack.key.y : (row == 2u ? stack.key.z : stack.key.w));
    rows = subgroupShuffle(heldKey, place & 7u) & kRowsMask;
    stack.top = empty ? 0u : place;
    return empty ? kNone : child;
}

// The padded ends of the rays' intervals, and the farthest of all lanes' as a key.
uint updateEnds() {
    float farthest = -1.0;
    GLINT_EACH_RAY {
        precise float end = packet[r].ray.tMax * kFarPad;
        packetEnds[r] = end;
        farthest = larger(farthest, end);
    }
    farthest = largestOfLanes(farthest);
    return farthest < 0.0 ? 0u : floatBitsToUint(farthest);
}

// Puts the children of a node that any row enters on the stack, the nearest last. False where the stack is
// full or the budget spent; then the group must be given up.
bool pushChildren(uint node, PacketBounds bounds, bvec3 negative, uint end, uint lane, uint budget,
                  inout PacketStack stack, inout uint trips) {
    PacketCorner lower = loadPacketCorner(16u * node + lane);
    vec3 upper = loadPacketCorner(16u * node + 8u + lane).corner;
    vec3 nearPlane = mix(lower.corner, upper, negative);
    vec3 farPlane = mix(upper, lower.corner, negative);
    float near;
    bool entered = groupEnters(bounds, nearPlane, farPlane, uintBitsToFloat(end), near);
    uint key = keyOf(near, lane, entered);
    uint count = sumOfLanes(entered ? 1u : 0u);
    key = sortLanes(key, lane);
    uint child = subgroupShuffle(lower.child, key & 7u);
    bool full = stack.top + count > 8u * GLINT_STACK_ROWS || trips > budget;
    uint farther = count;
    do {
        if (farther > 0u) {
            --farther;
            uint nextKey = subgroupShuffle(key, farther);
            uint nextChild = subgroupShuffle(child, farther);
            uint place = nextKey & 7u;
            uint entering = rowsThatEnter(fromLane(nearPlane, place), fromLane(farPlane, place));
            pushOne(stack, (nextKey & ~kRowsMask) | entering, nextChild, entering != 0u, lane);
            if (MODE_COST) {
                GLINT_EACH_RAY packet[r].cost += packetEnds[r] >= 0.0 ? 1u : 0u;
            }
        }
    } while (farther > 0u);
    trips += count + 2u;
    if (MODE_COST) {
        GLINT_EACH_RAY packet[r].cost += packetEnds[r] >= 0.0 ? 8u : 0u;
    }
    return !full;
}

// Returns false for a group that was given up: it ran out of trips or of stack.
// `trips` is no less than the trips that all loops have made: it is the same in all lanes, so the
// driver's count for the subgroup is this one, and no more than 40 pass between two looks at the budget (8
// children and 2, for each row of a leaf 1 and kMaxLeafSize / 2, and 4). The per-lane budget, which leaves
// room for every lane to take its own way, is far below what a packet could use, and is kept.
bool walkGroup(uint group, uint root, uint lane, inout uint trips) {
    PacketStack stack;
    stack.child = uvec4(kNone);
    stack.key = uvec4(kNone);
    stack.top = 0u;
    uint end = updateEnds();
    bvec3 negative = signsOf(group);
    uint axis = group & 3u;
    PacketBounds bounds = boundsOf(negative);
    uint current = end == 0u ? kNone : root;
    uint rows = kRowsMask;
    bool complete = true;
    uint budget = dispatch.tripBudget;
    do {
        if (current != kNone) {
            do {
                if (isNode(current)) {
                    bool pushed = pushChildren(current, bounds, negative, end, lane, budget, stack, trips);
                    complete = complete && pushed;
                    uint popped = popReachable(stack, end, lane, rows);
                    current = pushed ? popped : kNone;
                }
            } while (isNode(current));
            // A loop of its own: leaves often follow each other, and without it each would cost a masked pass
            // over the nodes' loop.
            do {
                if (isLeaf(current)) {
                    testPacketLeaf(current, axis, lane, rows, trips);
                    end = updateEnds();
                    uint popped = popReachable(stack, end, lane, rows);
                    bool spent = trips > budget;
                    complete = complete && !spent;
                    current = end == 0u || spent ? kNone : popped;
                    trips += 4u;
                }
            } while (isLeaf(current));
            ++trips;
        }
    } while (current != kNone);
    return complete;
}

#endif
