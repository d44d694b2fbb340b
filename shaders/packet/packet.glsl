// Hits of a packet: the rays of all 8 lanes of a subgroup, kPacketRays in each, traverse an 8-wide BVH
// together. All lanes visit the same node, so one load brings a node: lane c reads child c. After Wald,
// Slusallek, Benthin, Wagner, "Interactive Rendering with Coherent Ray Tracing", Computer Graphics Forum
// 20(3), 2001.
//
// Boxes that the packet's bounds enter are tested against every ray, as boxes of small subtrees are narrower
// than a packet. Primitives are tested by the arithmetic of single rays, so both kernels give the same bits.
//
// Written for lavapipe: subgroupShuffle and subgroupShuffleXor are one instruction there, unlike votes,
// ballots and broadcasts; all loop conditions are the same in all lanes, as shuffles need.
#ifndef GLINT_PACKET_GLSL
#define GLINT_PACKET_GLSL

#include "traversal/state.glsl"

#define GLINT_EACH_RAY for (uint r = 0u; r < kPacketRays; ++r)

// The packet of this invocation. Global, as copies for arguments doubled the driver's time to compile.
Traversal packet[kPacketRays];
float packetEnds[kPacketRays];  // updateEnds
uint packetTrips;               // of the packet, over all its traversals

// The stack lies across the lanes: entry i is in lane i % 8 of row i / 8. A packet that needs more rows is
// given up and finished ray by ray.
#define GLINT_STACK_ROWS 4
const uint kRowsMask = (1u << kPacketRays) - 1u;
struct PacketStack {
    uvec4 child;  // as in a node
    uvec4 key;    // see keyOf, but with the rows that enter the box (rowsThatEnter) in the low bits
    uint top;
};

float leastFloat(float a, float b) { return a < b ? a : b; }

// Type name(Type): the result of `combine` over the 8 lanes, in all of them.
#define GLINT_OVER_LANES(Type, name, combine)         \
    Type name(Type x) {                               \
        x = combine(x, subgroupShuffleXor(x, 1u));    \
        x = combine(x, subgroupShuffleXor(x, 2u));    \
        return combine(x, subgroupShuffleXor(x, 4u)); \
    }
uint sum(uint a, uint b) { return a + b; }
GLINT_OVER_LANES(float, largestOfLanes, larger)
GLINT_OVER_LANES(float, leastOfLanes, leastFloat)
GLINT_OVER_LANES(uint, largestOfLanes, max)
GLINT_OVER_LANES(uint, leastOfLanes, min)
GLINT_OVER_LANES(uint, sumOfLanes, sum)

vec3 fromLane(vec3 v, uint lane) {
    return vec3(subgroupShuffle(v.x, lane), subgroupShuffle(v.y, lane), subgroupShuffle(v.z, lane));
}

vec3 least3(vec3 a, vec3 b) { return vec3(leastFloat(a.x, b.x), leastFloat(a.y, b.y), leastFloat(a.z, b.z)); }
vec3 larger3(vec3 a, vec3 b) { return vec3(larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z)); }
float least(vec3 v) { return leastFloat(v.x, leastFloat(v.y, v.z)); }
float largest4(vec3 v, float w) { return larger(larger(v.x, v.y), larger(v.z, w)); }
vec3 leastOfLanes(vec3 v) { return vec3(leastOfLanes(v.x), leastOfLanes(v.y), leastOfLanes(v.z)); }
vec3 largestOfLanes(vec3 v) { return vec3(largestOfLanes(v.x), largestOfLanes(v.y), largestOfLanes(v.z)); }

// Ascending over the 8 lanes (Batcher's bitonic network, six exchanges).
uint exchange(uint key, uint mask, bool upper) {
    uint other = subgroupShuffleXor(key, mask);
    uint lower = min(key, other);
    uint higher = max(key, other);
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

// Rays whose directions agree in signs and largest component form a group, which traverses by itself: near
// and far planes and the turn of the triangle test are then the same in all lanes.
uint groupOf(RayFrame frame) {
    return frame.axis | (frame.negative.x ? 4u : 0u) | (frame.negative.y ? 8u : 0u) |
           (frame.negative.z ? 16u : 0u);
}
bvec3 signsOf(uint group) { return bvec3((group & 4u) != 0u, (group & 8u) != 0u, (group & 16u) != 0u); }

// Bounds of all live rays of a group.
struct PacketBounds {
    vec3 nearOrigin, farOrigin;    // corners of the origins: near planes are nearest, far planes farthest
    vec3 inverseLow, inverseHigh;  // of RayFrame::inverse
    float tMin;
};

PacketBounds boundsOf(bvec3 negative) {
    vec3 inverseLow = vec3(kInfinity), inverseHigh = vec3(-kInfinity), originLow = vec3(kInfinity),
         originHigh = vec3(-kInfinity);
    float tMin = kInfinity;
    GLINT_EACH_RAY {
        bool live = packet[r].ray.tMax > packet[r].ray.tMin;
        vec3 inverse = packet[r].frame.inverse;
        vec3 origin = packet[r].ray.origin;
        inverseLow = least3(inverseLow, live ? inverse : inverseLow);
        inverseHigh = larger3(inverseHigh, live ? inverse : inverseHigh);
        originLow = least3(originLow, live ? origin : originLow);
        originHigh = larger3(originHigh, live ? origin : originHigh);
        tMin = leastFloat(tMin, live ? packet[r].ray.tMin : tMin);
    }
    PacketBounds bounds;
    bounds.tMin = leastOfLanes(tMin);
    bounds.inverseLow = leastOfLanes(inverseLow);
    bounds.inverseHigh = largestOfLanes(inverseHigh);
    originLow = leastOfLanes(originLow);
    originHigh = largestOfLanes(originHigh);
    bounds.nearOrigin = mix(originHigh, originLow, negative);
    bounds.farOrigin = mix(originLow, originHigh, negative);
    return bounds;
}

// intersectBox for chosen planes: of a ray, and of a group, each lane with a box of its own. Rounding is
// monotone, so the bounds enclose the results of every ray to the bit: no box that a ray enters is left out.
bool enters(Ray ray, RayFrame frame, vec3 nearPlane, vec3 farPlane, float tEnd) {
    precise vec3 t0 = (nearPlane - ray.origin) * frame.inverse;
    precise vec3 t1 = (farPlane - ray.origin) * frame.inverse;
    float near = largest4(t0, ray.tMin);
    precise float padded = least(t1) * kFarPad;
    return near <= leastFloat(padded, tEnd);
}
bool groupEnters(PacketBounds bounds, vec3 nearPlane, vec3 farPlane, float tEnd, out float tNear) {
    precise vec3 toNear = nearPlane - bounds.nearOrigin;
    precise vec3 toFar = farPlane - bounds.farOrigin;
    precise vec3 near0 = toNear * bounds.inverseLow;
    precise vec3 near1 = toNear * bounds.inverseHigh;
    precise vec3 far0 = toFar * bounds.inverseLow;
    precise vec3 far1 = toFar * bounds.inverseHigh;
    tNear = largest4(least3(near0, near1), bounds.tMin);
    precise float padded = least(larger3(far0, far1)) * kFarPad;
    return tNear <= leastFloat(padded, tEnd);
}

// Bit r is set, in all lanes, if some ray of row r enters the box.
uint rowsThatEnter(vec3 nearPlane, vec3 farPlane) {
    uint entered = 0u;
    GLINT_EACH_RAY entered |=
        enters(packet[r].ray, packet[r].frame, nearPlane, farPlane, packetEnds[r]) ? 1u << r : 0u;
    return anyOfLanes(entered);
}

// Positive floats are ordered like their bits. The lane replaces low bits, so a distance is shorter by at
// most 7 ulp, on the stack by 15.
uint keyOf(float distance, uint lane, bool entered) {
    uint bits = floatBitsToUint(distance > 0.0 ? distance : 0.0);
    return entered ? (bits & ~7u) | lane : kNone;
}

bool isLeaf(uint child) { return child != kNone && !isNode(child); }

void pushOne(inout PacketStack stack, uint key, uint child, bool pushed, uint lane) {
    for (uint row = 0u; row < GLINT_STACK_ROWS; ++row) {
        bool mine = pushed && 8u * row + lane == stack.top;
        stack.key[row] = mine ? key : stack.key[row];
        stack.child[row] = mine ? child : stack.child[row];
    }
    stack.top += pushed ? 1u : 0u;
}

// The tests of a query: packet/hits.glsl, or packet_count.comp. a, b, c: the corners relative to the origin
// and rotated, like v0 and the normal. False `present`: no triangle.
void testTriangle(inout Traversal one, vec3 a, vec3 b, vec3 c, vec3 v0, vec3 normal, uint primitive, uint id,
                  bool present);
// rows: those that enter the leaf's box.
void testPacketLeaf(uint leaf, uint axis, uint lane, uint rows, inout uint trips);
void testPlanes(inout Traversal traversal, uint planeCount);

// corners: of triangle `index`, turned, in the lanes from `lane` on.
// normals: of the triangles of the pair, turned, in lanes 0 and 1.
void testRowTriangle(inout Traversal one, vec3 turned, vec3 corners, vec3 normals, uint ids, uint lane,
                     uint index, bool present) {
    vec3 v0 = fromLane(corners, lane);
    vec3 v1 = fromLane(corners, lane + 1u);
    vec3 v2 = fromLane(corners, lane + 2u);
    uint id = subgroupShuffle(ids, lane);
    uint primitive = (kKindTriangle << kPrimitiveKindShift) | index;
    precise vec3 a = v0 - turned;
    precise vec3 b = v1 - turned;
    precise vec3 c = v2 - turned;
    testTriangle(one, a, b, c, v0, fromLane(normals, lane / 3u), primitive, id, present);
}

// Fields of a ray that tests change.
#define GLINT_TESTED_FIELDS(X) \
    X(hit.primitive) X(hit.t) X(hit.u) X(hit.v) X(hit.id) X(nearest) X(ray.tMax) X(crossings)

// Takes the rays of a row out of the packet. `row` has the row's bit alone. By selection: an index that is
// not constant costs more.
Traversal takeRow(uint row) {
    Traversal one = packet[0];
    for (uint r = 1u; r < kPacketRays; ++r) {
        bool mine = row == 1u << r;
#define GLINT_TAKE(field) one.field = mine ? packet[r].field : one.field;
        GLINT_TESTED_FIELDS(GLINT_TAKE)
        GLINT_TAKE(ray.origin)
        GLINT_TAKE(ray.tMin)
        GLINT_TAKE(ray.source)
        GLINT_TAKE(frame.shear)
    }
    return one;
}

// Puts them back.
void putRow(uint row, Traversal one) {
    GLINT_EACH_RAY {
        bool mine = row == 1u << r;
#define GLINT_PUT(field) packet[r].field = mine ? one.field : packet[r].field;
        GLINT_TESTED_FIELDS(GLINT_PUT)
    }
}

// Row by row, only those that enter the leaf's box: with pixel-sized triangles one or two of four. Two
// triangles for a load and a trip.
void testPacketTriangles(uint axis, uint first, uint end, uint lane, uint rows, inout uint trips) {
    uint left = first < end ? rows : 0u;
    do {
        if (left != 0u) {
            uint row = left & (~left + 1u);
            Traversal one = takeRow(row);
            vec3 turned = turnToZ(one.ray.origin, axis);
            uint index = first;
            do {
                if (index < end) {
                    uvec4 texel = trianglesArrayRow(3u * index + lane);
                    vec3 corners = turnToZ(uintBitsToFloat(texel.xyz), axis);
                    vec3 normals = turnToZ(loadTriangleSurface(index + (lane & 1u)).normal, axis);
                    testRowTriangle(one, turned, corners, normals, texel.w, 0u, index, true);
                    testRowTriangle(one, turned, corners, normals, texel.w, 3u, index + 1u, index + 1u < end);
                    index += 2u;
                    ++trips;
                }
            } while (index < end);
            putRow(row, one);
            left ^= row;
            ++trips;
        }
    } while (left != 0u);
}

// Pops the topmost entry that some ray may still reach and drops all above it; kNone if none is left. `end`
// is the key of the farthest point that any ray may still reach. rows: those that enter its box.
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

// Pushes the children of a node that any row enters, the one that comes first last: the nearest for closest
// hits, the farthest for any hits (isFarthestFirst, traversal/stack.glsl). False if the stack is full or the
// budget spent; then the group must be given up.
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

// Returns false if some group was given up.
bool traversePacket(uint root) {
    uint lane = gl_LocalInvocationID.x & 7u;
    uint groups[kPacketRays];
    float tMax[kPacketRays];
    uint group = kNone;
    GLINT_EACH_RAY {
        tMax[r] = packet[r].ray.tMax;
        bool live = packet[r].ray.tMax > packet[r].ray.tMin && root != kNone && !settled(packet[r]);
        groups[r] = live ? groupOf(packet[r].frame) : kNone;
        group = min(group, groups[r]);
    }
    group = leastOfLanes(group);
    uint trips = packetTrips;
    bool complete = true;
    do {
        if (group != kNone) {
            GLINT_EACH_RAY packet[r].ray.tMax = groups[r] == group ? tMax[r] : -1.0;
            bool walked = walkGroup(group, root, lane, trips);
            complete = complete && walked;
            uint next = kNone;
            GLINT_EACH_RAY {
                if (groups[r] == group) {
                    tMax[r] = packet[r].ray.tMax;
                    groups[r] = kNone;
                }
                next = min(next, groups[r]);
            }
            // A packet that is given up starts again as a whole; further groups would only add trips.
            group = complete ? leastOfLanes(next) : kNone;
            ++trips;
        }
    } while (group != kNone);
    GLINT_EACH_RAY packet[r].ray.tMax = tMax[r];
    packetTrips = trips;
    return complete;
}

// trace() of a packet. False if it was given up: hits so far are kept, and rays not settled must start again.
bool tracePacket(Environment environment) {
    GLINT_EACH_RAY {
        if (!prepare(packet[r], environment)) packet[r].ray.tMax = -1.0;
        if (FEATURE_PLANES)
            testPlanes(packet[r], packet[r].ray.tMax > packet[r].ray.tMin ? environment.planeCount : 0u);
    }
    return traversePacket(environment.root);
}

// Path r of this lane: those of a packet are consecutive, a block of 8x4 pixels. If the dispatch has no such
// path, `present` is false and the path one that may be read.
uint packetPath(uint turns, uint turn, uint r, out bool present) {
    uint lane = gl_LocalInvocationID.x & 7u;
    uint path = ((gl_GlobalInvocationID.x - lane) * turns + 8u * turn) * kPacketRays + lane + 8u * r;
    present = path < dispatch.run * dispatch.interleave * kWorkgroupSize;
    return present ? path : 0u;
}

// Each kernel defines these: false only if the path has no ray to trace, by one row of the path; and tracing
// a packet.
bool mayHaveRay(uint path);
void onePacket(uint turn);

// A subgroup traces `turns` packets one after the other, but those without rays, if others follow: many
// packets of shadow rays are empty, and an empty packet would cost the kernel's whole code
// (traversal/lanes.glsl).
void eachPacket(uint turns) {
    uint turn = 0u;
    do {
        uint some = 0u;
        do {
            GLINT_EACH_RAY {
                bool present;
                bool may = mayHaveRay(packetPath(turns, turn, r, present));
                some |= present && may ? 1u : 0u;
            }
            some = anyOfLanes(some);
            ++turn;
        } while (some == 0u && turn < turns);
        onePacket(turn - 1u);
    } while (turn < turns);
}

#endif
