// Closest hit, or any hit if GLINT_ANY_HIT is defined, of a packet: the rays of all 8 lanes of a subgroup, GLINT_PACKET_RAYS in each,
// walk an 8-wide tree together. Which node is next is the same in all lanes, so one load brings a node (lane c reads child c) where
// the per-lane traversal needs one for each lane. Ancestry: Wald, Slusallek, Benthin, Wagner, "Interactive Rendering with Coherent Ray
// Tracing", Computer Graphics Forum 20(3), 2001.
//
// Every box is tested against every ray, not against the packet's bounds: the boxes of small subtrees are narrower than a packet, and
// bounds would enter most of them in vain. A hit is found by the arithmetic of the per-lane traversal, so both kernels give the same bits.
//
// Written for lavapipe: only subgroupShuffle and subgroupShuffleXor, which are one instruction there, never a vote, ballot or broadcast;
// all loop conditions are the same in all lanes, as a shuffle reads a lane that has left a loop as it was then.
#ifndef GLINT_PACKET_GLSL
#define GLINT_PACKET_GLSL

#include "traversal.glsl"

#ifndef GLINT_PACKET_RAYS
#define GLINT_PACKET_RAYS 1
#endif
#define GLINT_EACH_RAY for (uint r = 0u; r < GLINT_PACKET_RAYS; ++r)

// The stack is the same for all lanes and held across them: entry i is in lane i % 8 of row i / 8. A packet that needs more rows is
// given up and finished ray by ray.
#define GLINT_STACK_ROWS 4
struct PacketStack {
    uvec4 child;  // as in a node
    uvec4 key;    // see keyOf
    uint top;
};

float leastFloat(float a, float b) { return a < b ? a : b; }
uint leastUint(uint a, uint b) { return a < b ? a : b; }
uint largerUint(uint a, uint b) { return a > b ? a : b; }

float largestOfLanes(float x) {
    x = larger(x, subgroupShuffleXor(x, 1u));
    x = larger(x, subgroupShuffleXor(x, 2u));
    return larger(x, subgroupShuffleXor(x, 4u));
}

uint largestOfLanes(uint x) {
    x = largerUint(x, subgroupShuffleXor(x, 1u));
    x = largerUint(x, subgroupShuffleXor(x, 2u));
    return largerUint(x, subgroupShuffleXor(x, 4u));
}

uint sumOfLanes(uint x) {
    x += subgroupShuffleXor(x, 1u);
    x += subgroupShuffleXor(x, 2u);
    return x + subgroupShuffleXor(x, 4u);
}

vec3 fromLane(vec3 v, uint lane) {
    return vec3(subgroupShuffle(v.x, lane), subgroupShuffle(v.y, lane), subgroupShuffle(v.z, lane));
}

// Half of a transposition and a minimum at once: of a in the lanes where `bit` is 0, of b in the others.
float foldLanes(float a, float b, uint lane, uint bit) {
    bool odd = (lane & bit) != 0u;
    float kept = odd ? b : a;
    float given = odd ? a : b;
    return leastFloat(kept, subgroupShuffleXor(given, bit));
}

// Ascending over the 8 lanes (Batcher's bitonic network, six exchanges).
uint exchange(uint key, uint mask, bool upper) {
    uint other = subgroupShuffleXor(key, mask);
    uint lower = leastUint(key, other);
    uint higher = largerUint(key, other);
    return upper ? higher : lower;
}
uint sortLanes(uint key, uint lane) {
    bool b0 = (lane & 1u) != 0u, b1 = (lane & 2u) != 0u, b2 = (lane & 4u) != 0u;
    key = exchange(key, 1u, b0 != b1);
    key = exchange(key, 2u, b1 != b2);
    key = exchange(key, 1u, b0 != b2);
    key = exchange(key, 4u, b2);
    key = exchange(key, 2u, b1);
    return exchange(key, 1u, b0);
}

// Distance at which the first ray enters child `child`, kInfinity if none does; in every lane that of its own rays.
float enterChild(Traversal packet[GLINT_PACKET_RAYS], float ends[GLINT_PACKET_RAYS], vec3 los, vec3 his, uint child) {
    vec3 lo = fromLane(los, child);
    vec3 hi = fromLane(his, child);
    float first = kInfinity;
    GLINT_EACH_RAY {
        float near;
        bool entered = intersectBox(packet[r].ray, packet[r].frame, lo, hi, ends[r], near);
        near = entered ? near : kInfinity;
        first = leastFloat(first, near);
    }
    return first;
}

// Appends the children whose key is not kNone, `count` of them, the nearest last.
void pushSorted(inout PacketStack stack, uint sortedKey, uint sortedChild, uint count, uint lane) {
    // Lane of the sorted children that each lane takes; the same in each row, whose size is the number of lanes.
    uint from = (count - 1u - (lane - stack.top)) & 7u;
    uint key = subgroupShuffle(sortedKey, from);
    uint child = subgroupShuffle(sortedChild, from);
    for (uint row = 0u; row < GLINT_STACK_ROWS; ++row) {
        bool mine = 8u * row + lane - stack.top < count;
        stack.key[row] = mine ? key : stack.key[row];
        stack.child[row] = mine ? child : stack.child[row];
    }
    stack.top += count;
}

// The topmost entry that some ray may still reach, kNone if there is none; all above it are dropped. `end` is the key of the farthest
// point that any ray may still reach.
uint popReachable(inout PacketStack stack, uint end, uint lane) {
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
    uint held = row == 0u ? stack.child.x : (row == 1u ? stack.child.y : (row == 2u ? stack.child.z : stack.child.w));
    uint child = subgroupShuffle(held, place & 7u);
    stack.top = empty ? 0u : place;
    return empty ? kNone : child;
}

void testPacketTriangle(inout Traversal packet[GLINT_PACKET_RAYS], Triangle triangle, uint index, bool present) {
    uint primitive = (kKindTriangle << kPrimitiveKindShift) | index;
    GLINT_EACH_RAY {
        float t, u, v;
        if (intersectTriangle(packet[r].ray, packet[r].frame, triangle, t, u, v) && present && primitive != packet[r].ray.source)
            accept(packet[r].ray, packet[r].hit, t, u, v, primitive, triangle.id);
        if (MODE_COST && present) ++packet[r].cost;
    }
}

// Two triangles for a load and a trip.
void testPacketTriangles(inout Traversal packet[GLINT_PACKET_RAYS], uint first, uint end, uint lane, inout uint trips) {
    uint index = first;
    while (index < end) {
        uvec4 texel = LOAD4(trianglesArray, 3u * index + lane);
        vec3 corner = uintBitsToFloat(texel.xyz);
        Triangle triangle;
        triangle.v0 = fromLane(corner, 0u);
        triangle.v1 = fromLane(corner, 1u);
        triangle.v2 = fromLane(corner, 2u);
        triangle.id = subgroupShuffle(texel.w, 0u);
        testPacketTriangle(packet, triangle, index, true);
        triangle.v0 = fromLane(corner, 3u);
        triangle.v1 = fromLane(corner, 4u);
        triangle.v2 = fromLane(corner, 5u);
        triangle.id = subgroupShuffle(texel.w, 3u);
        testPacketTriangle(packet, triangle, index + 1u, index + 1u < end);
        index += 2u;
        ++trips;
    }
}

void testPacketSpheres(inout Traversal packet[GLINT_PACKET_RAYS], uint first, uint end, inout uint trips) {
    uint index = first;
    while (index < end) {
        Sphere sphere = loadSphere(index);
        uint primitive = (kKindSphere << kPrimitiveKindShift) | index;
        GLINT_EACH_RAY {
            float t;
            if (intersectSphere(packet[r].ray, sphere, primitive, t))
                accept(packet[r].ray, packet[r].hit, t, 0.0, 0.0, primitive, sphere.id);
            if (MODE_COST) ++packet[r].cost;
        }
        ++index;
        ++trips;
    }
}

// The padded ends of the rays' intervals, and the farthest of all lanes' as a key. An any-hit ray that has hit needs nothing more.
uint updateEnds(inout Traversal packet[GLINT_PACKET_RAYS], inout float ends[GLINT_PACKET_RAYS]) {
    float farthest = -1.0;
    GLINT_EACH_RAY {
        if (settled(packet[r])) packet[r].ray.tMax = -1.0;
        precise float end = packet[r].ray.tMax * kFarPad;
        ends[r] = end;
        farthest = larger(farthest, end);
    }
    farthest = largestOfLanes(farthest);
    return farthest < 0.0 ? 0u : floatBitsToUint(farthest);
}

// Order of positive floats as of their bits; the low bits give way to the lane, which makes a distance shorter by 7 ulp at most.
uint keyOf(float distance, uint lane) {
    uint bits = floatBitsToUint(distance > 0.0 ? distance : 0.0);
    return distance == kInfinity ? kNone : (bits & ~7u) | lane;
}

// Returns false for a packet that was given up: it ran out of trips or of stack.
bool traversePacket(inout Traversal packet[GLINT_PACKET_RAYS], uint root) {
    uint lane = gl_LocalInvocationID.x & 7u;
    PacketStack stack;
    stack.child = uvec4(kNone);
    stack.key = uvec4(kNone);
    stack.top = 0u;
    float ends[GLINT_PACKET_RAYS];
    uint end = updateEnds(packet, ends);
    uint trips = 0u;
    uint current = end == 0u ? kNone : root;
    bool complete = true;
    while (current != kNone) {
        while (isNode(current)) {
            PacketCorner lower = loadPacketCorner(16u * current + lane);
            vec3 los = lower.corner;
            vec3 his = loadPacketCorner(16u * current + 8u + lane).corner;
            float near01 = foldLanes(enterChild(packet, ends, los, his, 0u), enterChild(packet, ends, los, his, 1u), lane, 1u);
            float near23 = foldLanes(enterChild(packet, ends, los, his, 2u), enterChild(packet, ends, los, his, 3u), lane, 1u);
            float near03 = foldLanes(near01, near23, lane, 2u);
            float near45 = foldLanes(enterChild(packet, ends, los, his, 4u), enterChild(packet, ends, los, his, 5u), lane, 1u);
            float near67 = foldLanes(enterChild(packet, ends, los, his, 6u), enterChild(packet, ends, los, his, 7u), lane, 1u);
            float near47 = foldLanes(near45, near67, lane, 2u);
            float near = foldLanes(near03, near47, lane, 4u);
            uint key = keyOf(near, lane);
            uint count = sumOfLanes(key == kNone ? 0u : 1u);
            key = sortLanes(key, lane);
            uint child = subgroupShuffle(lower.child, key & 7u);
            bool full = stack.top + count > 8u * GLINT_STACK_ROWS || trips > dispatch.tripBudget;
            complete = complete && !full;
            pushSorted(stack, key, child, count, lane);
            uint popped = popReachable(stack, end, lane);
            current = full ? kNone : popped;
            ++trips;
            if (MODE_COST) GLINT_EACH_RAY packet[r].cost += ends[r] >= 0.0 ? 8u : 0u;
        }
        uint kind = (current >> kLeafKindShift) & kLeafKindMask;
        uint first = current & kLeafFirstMask;
        uint last = current == kNone ? first : first + ((current >> kLeafCountShift) & kLeafCountMask) + 1u;
        if (FEATURE_TRIANGLES) testPacketTriangles(packet, kind == kKindTriangle ? first : last, last, lane, trips);
        if (FEATURE_SPHERES) testPacketSpheres(packet, kind == kKindSphere ? first : last, last, trips);
        end = updateEnds(packet, ends);
        uint popped = popReachable(stack, end, lane);
        current = current == kNone || end == 0u ? kNone : popped;
        trips += 3u;
    }
    return complete;
}

// As trace() of the per-lane traversal. A packet that was given up leaves its rays unfinished at slot 0.
void tracePacket(inout Traversal packet[GLINT_PACKET_RAYS], Environment environment, out uint slots[GLINT_PACKET_RAYS]) {
    GLINT_EACH_RAY {
        if (!prepare(packet[r])) packet[r].ray.tMax = -1.0;
        if (FEATURE_PLANES) testPlanes(packet[r], packet[r].ray.tMax > packet[r].ray.tMin ? environment.planeCount : 0u);
    }
    bool complete = traversePacket(packet, environment.root);
    GLINT_EACH_RAY slots[r] = complete || packet[r].ray.tMax < 0.0 ? kNone : 0u;
}

#if GLINT_PACKET_RAYS == 1
// trace() for a kernel whose lanes bring one ray each.
uint traceOneEach(inout Traversal traversal, Environment environment) {
    Traversal packet[1] = Traversal[1](traversal);
    uint slots[1];
    tracePacket(packet, environment, slots);
    traversal = packet[0];
    return slots[0];
}
#endif

#endif
