// Hits of a group of a packet's rays: the nearest nodes first for closest hits, the farthest for any hits,
// which seldom lie in the neighbourhood that a ray leaves.
#ifndef GLINT_PACKET_TRAVERSE_GLSL
#define GLINT_PACKET_TRAVERSE_GLSL

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

// The padded ends of the rays' intervals, and the farthest of all lanes' as a key. An any-hit ray that has
// hit needs nothing more.
uint updateEnds() {
    float farthest = -1.0;
    GLINT_EACH_RAY {
        if (settled(packet[r])) packet[r].ray.tMax = -1.0;
        precise float end = packet[r].ray.tMax * kFarPad;
        packetEnds[r] = end;
        farthest = larger(farthest, end);
    }
    farthest = largestOfLanes(farthest);
    return farthest < 0.0 ? 0u : floatBitsToUint(farthest);
}

// Pushes the children of a node that any row enters, the one that comes first last. False if the stack is
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
    if (isAnyHit(packet[0])) key = entered ? (0x7f800000u - (key & ~7u)) | lane : kNone;
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
            // Any-hit rays never shorten, so none of their entries gets out of reach.
            uint distance = isAnyHit(packet[0]) ? 0u : nextKey & ~kRowsMask;
            pushOne(stack, distance | entering, nextChild, entering != 0u, lane);
        }
    } while (farther > 0u);
    trips += count + 2u;
    return !full;
}

// Returns false for a group that ran out of trips or of stack. `trips` is the same in all lanes, so it is at
// least the driver's count for the subgroup, and at most 40 pass between two checks of the budget (8 children
// and 2, for each row of a leaf 1 and kMaxLeafSize / 2, and 4). The budget of single rays is far below what a
// packet could use.
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
            // Leaves often follow each other: without a loop of their own each would run the nodes' code.
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
