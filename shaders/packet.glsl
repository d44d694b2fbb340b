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
#define GLINT_PACKET_RAYS 4  // kPacketRays in src/render/traversal_choice.h
#endif
#define GLINT_EACH_RAY for (uint r = 0u; r < GLINT_PACKET_RAYS; ++r)

// The packet of this invocation. Not handed to functions: the copies that takes cost the driver's compiler half of its time.
Traversal packet[GLINT_PACKET_RAYS];
float packetEnds[GLINT_PACKET_RAYS];    // updateEnds

// The stack is the same for all lanes and held across them: entry i is in lane i % 8 of row i / 8. A packet that needs more rows is
// given up and finished ray by ray.
#define GLINT_STACK_ROWS 4
const uint kRowsMask = (1u << GLINT_PACKET_RAYS) - 1u;
struct PacketStack {
    uvec4 child;  // as in a node
    uvec4 key;    // see keyOf, but with the rows that enter the box (rowsThatEnter) in the low bits
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

uint leastOfLanes(uint x) {
    x = leastUint(x, subgroupShuffleXor(x, 1u));
    x = leastUint(x, subgroupShuffleXor(x, 2u));
    return leastUint(x, subgroupShuffleXor(x, 4u));
}

uint sumOfLanes(uint x) {
    x += subgroupShuffleXor(x, 1u);
    x += subgroupShuffleXor(x, 2u);
    return x + subgroupShuffleXor(x, 4u);
}

vec3 fromLane(vec3 v, uint lane) {
    return vec3(subgroupShuffle(v.x, lane), subgroupShuffle(v.y, lane), subgroupShuffle(v.z, lane));
}

float leastOfLanes(float x) {
    x = leastFloat(x, subgroupShuffleXor(x, 1u));
    x = leastFloat(x, subgroupShuffleXor(x, 2u));
    return leastFloat(x, subgroupShuffleXor(x, 4u));
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

// Rays that agree in the signs of their direction and in its largest component walk together; a packet that has several such groups
// walks once for each. Near and far planes and the turn of the triangle test are then the same in all lanes.
uint groupOf(RayFrame frame) {
    return frame.axis | (frame.negative.x ? 4u : 0u) | (frame.negative.y ? 8u : 0u) | (frame.negative.z ? 16u : 0u);
}
bvec3 signsOf(uint group) { return bvec3((group & 4u) != 0u, (group & 8u) != 0u, (group & 16u) != 0u); }

// Between these lie all rays of a group that have something to find.
struct PacketBounds {
    vec3 nearOrigin, farOrigin;    // the origins' corner from which near planes are nearest, and the one from which far planes are farthest
    vec3 inverseLow, inverseHigh;  // of RayFrame::inverse
    float tMin;
};

PacketBounds boundsOf(bvec3 negative) {
    vec3 inverseLow = vec3(kInfinity), inverseHigh = vec3(-kInfinity), originLow = vec3(kInfinity), originHigh = vec3(-kInfinity);
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

// The later halves of intersectBox, of its planes that are already chosen; for a ray, and for a group, each lane with a box of its own.
// Rounding is monotone, so the same operations on the bounds enclose what they give for any ray, to the bit: a box that a ray enters is
// never left out.
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
    GLINT_EACH_RAY entered |= enters(packet[r].ray, packet[r].frame, nearPlane, farPlane, packetEnds[r]) ? 1u << r : 0u;
    entered |= subgroupShuffleXor(entered, 1u);
    entered |= subgroupShuffleXor(entered, 2u);
    return entered | subgroupShuffleXor(entered, 4u);
}

void pushOne(inout PacketStack stack, uint key, uint child, bool pushed, uint lane) {
    for (uint row = 0u; row < GLINT_STACK_ROWS; ++row) {
        bool mine = pushed && 8u * row + lane == stack.top;
        stack.key[row] = mine ? key : stack.key[row];
        stack.child[row] = mine ? child : stack.child[row];
    }
    stack.top += pushed ? 1u : 0u;
}

// The topmost entry that some ray may still reach, kNone if there is none; all above it are dropped. `end` is the key of the farthest
// point that any ray may still reach. rows: those that enter its box.
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
    uint held = row == 0u ? stack.child.x : (row == 1u ? stack.child.y : (row == 2u ? stack.child.z : stack.child.w));
    uint child = subgroupShuffle(held, place & 7u);
    uint heldKey = row == 0u ? stack.key.x : (row == 1u ? stack.key.y : (row == 2u ? stack.key.z : stack.key.w));
    rows = subgroupShuffle(heldKey, place & 7u) & kRowsMask;
    stack.top = empty ? 0u : place;
    return empty ? kNone : child;
}

// corners: of triangle `index`, turned, in the lanes from `lane` on.
void testRowTriangle(inout Traversal one, vec3 turned, vec3 corners, uint ids, uint lane, uint index, bool present) {
    vec3 v0 = fromLane(corners, lane);
    vec3 v1 = fromLane(corners, lane + 1u);
    vec3 v2 = fromLane(corners, lane + 2u);
    uint id = subgroupShuffle(ids, lane);
    uint primitive = (kKindTriangle << kPrimitiveKindShift) | index;
    precise vec3 a = v0 - turned;
    precise vec3 b = v1 - turned;
    precise vec3 c = v2 - turned;
    float t, u, v;
    if (intersectTurned(one.ray, one.frame, a, b, c, t, u, v) && present && !isOwnTriangle(one, primitive, id))
        accept(one, t, u, v, primitive, id);
    if (MODE_COST && present) ++one.cost;
}

// Row by row, of those rows that enter the leaf's box: where triangles are as small as pixels that is one or two of four, and on lavapipe only
// a loop skips. The row is taken out of the packet and put back by selection, as an index that is no constant costs more.
// Two triangles for a load and a trip. Any hit needs no more than to be known.
void testPacketTriangles(uint axis, uint first, uint end, uint lane, uint rows, inout uint trips) {
    uint left = first < end ? rows : 0u;
    do if (left != 0u) {
        Traversal one = packet[0];
        bool taken = (left & 1u) != 0u;
        for (uint r = 1u; r < GLINT_PACKET_RAYS; ++r) {
            bool mine = !taken && (left & (1u << r)) != 0u;
            one.ray.origin = mine ? packet[r].ray.origin : one.ray.origin;
            one.ray.tMin = mine ? packet[r].ray.tMin : one.ray.tMin;
            one.ray.tMax = mine ? packet[r].ray.tMax : one.ray.tMax;
            one.ray.source = mine ? packet[r].ray.source : one.ray.source;
            one.sourceTriangle = mine ? packet[r].sourceTriangle : one.sourceTriangle;
            one.frame.shear = mine ? packet[r].frame.shear : one.frame.shear;
            one.hit.primitive = mine ? packet[r].hit.primitive : one.hit.primitive;
#ifndef GLINT_ANY_HIT
            one.hit.t = mine ? packet[r].hit.t : one.hit.t;
            one.hit.u = mine ? packet[r].hit.u : one.hit.u;
            one.hit.v = mine ? packet[r].hit.v : one.hit.v;
            one.hit.id = mine ? packet[r].hit.id : one.hit.id;
#endif
            one.cost = mine ? packet[r].cost : one.cost;
            taken = taken || mine;
        }
        vec3 turned = turnToZ(one.ray.origin, axis);
        uint index = first;
        do if (index < end) {
            uvec4 texel = LOAD4(trianglesArray, 3u * index + lane);
            vec3 corners = turnToZ(uintBitsToFloat(texel.xyz), axis);
            testRowTriangle(one, turned, corners, texel.w, 0u, index, true);
            testRowTriangle(one, turned, corners, texel.w, 3u, index + 1u, index + 1u < end);
            index += 2u;
            ++trips;
        } while (index < end);
        bool given = false;
        GLINT_EACH_RAY {
            bool mine = !given && (left & (1u << r)) != 0u;
            packet[r].hit.primitive = mine ? one.hit.primitive : packet[r].hit.primitive;
#ifndef GLINT_ANY_HIT
            packet[r].ray.tMax = mine ? one.ray.tMax : packet[r].ray.tMax;
            packet[r].hit.t = mine ? one.hit.t : packet[r].hit.t;
            packet[r].hit.u = mine ? one.hit.u : packet[r].hit.u;
            packet[r].hit.v = mine ? one.hit.v : packet[r].hit.v;
            packet[r].hit.id = mine ? one.hit.id : packet[r].hit.id;
#endif
            packet[r].cost = mine ? one.cost : packet[r].cost;
            given = given || mine;
        }
        left &= left - 1u;
        ++trips;
    } while (left != 0u);
}

void testPacketSpheres(uint first, uint end, inout uint trips) {
    uint index = first;
    do if (index < end) {
        Sphere sphere = loadSphere(index);
        uint primitive = (kKindSphere << kPrimitiveKindShift) | index;
        GLINT_EACH_RAY {
            float t;
            if (intersectSphere(packet[r].ray, sphere, primitive, t))
                accept(packet[r], t, 0.0, 0.0, primitive, sphere.id);
            if (MODE_COST) ++packet[r].cost;
        }
        ++index;
        ++trips;
    } while (index < end);
}

// The padded ends of the rays' intervals, and the farthest of all lanes' as a key. An any-hit ray that has hit needs nothing more.
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

// Order of positive floats as of their bits; the low bits give way to the lane, which makes a distance shorter by 7 ulp at most, 15 on the stack.
bool isLeaf(uint child) { return child != kNone && !isNode(child); }

uint keyOf(float distance, uint lane, bool entered) {
    uint bits = floatBitsToUint(distance > 0.0 ? distance : 0.0);
    return entered ? (bits & ~7u) | lane : kNone;
}

// Returns false for a group that was given up: it ran out of trips or of stack.
// `trips` is no less than the trips that all loops have made: it is the same in all lanes, so lavapipe's count for the subgroup is this one,
// and no more than 40 pass between two looks at the budget (8 children and 2, for each row of a leaf 1 and kMaxLeafSize / 2, and 4). The per-lane budget, which
// leaves room for every lane to take its own way, is far below what a packet could use, and is kept.
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
    do if (current != kNone) {
        do if (isNode(current)) {
            PacketCorner lower = loadPacketCorner(16u * current + lane);
            vec3 upper = loadPacketCorner(16u * current + 8u + lane).corner;
            vec3 nearPlane = mix(lower.corner, upper, negative);
            vec3 farPlane = mix(upper, lower.corner, negative);
            float near;
            bool entered = groupEnters(bounds, nearPlane, farPlane, uintBitsToFloat(end), near);
            uint key = keyOf(near, lane, entered);
            uint count = sumOfLanes(entered ? 1u : 0u);
            key = sortLanes(key, lane);
            uint child = subgroupShuffle(lower.child, key & 7u);
            bool full = stack.top + count > 8u * GLINT_STACK_ROWS || trips > dispatch.tripBudget;
            complete = complete && !full;
            uint farther = count;
            do if (farther > 0u) {
                --farther;
                uint nextKey = subgroupShuffle(key, farther);
                uint nextChild = subgroupShuffle(child, farther);
                uint place = nextKey & 7u;
                uint entering = rowsThatEnter(fromLane(nearPlane, place), fromLane(farPlane, place));
                pushOne(stack, (nextKey & ~kRowsMask) | entering, nextChild, entering != 0u, lane);
                if (MODE_COST) GLINT_EACH_RAY packet[r].cost += packetEnds[r] >= 0.0 ? 1u : 0u;
            } while (farther > 0u);
            trips += count + 2u;
            uint popped = popReachable(stack, end, lane, rows);
            current = full ? kNone : popped;
            if (MODE_COST) GLINT_EACH_RAY packet[r].cost += packetEnds[r] >= 0.0 ? 8u : 0u;
        } while (isNode(current));
        // A loop of its own: leaves often follow each other, and without it each would cost a masked pass over the nodes' loop.
        do if (isLeaf(current)) {
            uint kind = (current >> kLeafKindShift) & kLeafKindMask;
            uint first = current & kLeafFirstMask;
            uint last = first + ((current >> kLeafCountShift) & kLeafCountMask) + 1u;
            if (FEATURE_TRIANGLES) testPacketTriangles(axis, kind == kKindTriangle ? first : last, last, lane, rows, trips);
            if (FEATURE_SPHERES) testPacketSpheres(kind == kKindSphere ? first : last, last, trips);
            end = updateEnds();
            uint popped = popReachable(stack, end, lane, rows);
            bool spent = trips > dispatch.tripBudget;
            complete = complete && !spent;
            current = end == 0u || spent ? kNone : popped;
            trips += 4u;
        } while (isLeaf(current));
        ++trips;
    } while (current != kNone);
    return complete;
}

// Returns false if some group was given up.
bool traversePacket(uint root) {
    uint lane = gl_LocalInvocationID.x & 7u;
    uint groups[GLINT_PACKET_RAYS];
    float tMax[GLINT_PACKET_RAYS];
    uint group = kNone;
    GLINT_EACH_RAY {
        tMax[r] = packet[r].ray.tMax;
        bool live = packet[r].ray.tMax > packet[r].ray.tMin && root != kNone && !settled(packet[r]);
        groups[r] = live ? groupOf(packet[r].frame) : kNone;
        group = leastUint(group, groups[r]);
    }
    group = leastOfLanes(group);
    uint trips = 0u;
    bool complete = true;
    do if (group != kNone) {
        GLINT_EACH_RAY packet[r].ray.tMax = groups[r] == group ? tMax[r] : -1.0;
        bool walked = walkGroup(group, root, lane, trips);
        complete = complete && walked;
        uint next = kNone;
        GLINT_EACH_RAY {
            if (groups[r] == group) {
                tMax[r] = packet[r].ray.tMax;
                groups[r] = kNone;
            }
            next = leastUint(next, groups[r]);
        }
        group = leastOfLanes(next);
        ++trips;
    } while (group != kNone);
    GLINT_EACH_RAY packet[r].ray.tMax = tMax[r];
    return complete;
}

// As trace() of the per-lane traversal. Returns false for a packet that was given up: what its rays have hit by then is kept, and those
// that are not settled are to be started again.
bool tracePacket(Environment environment) {
    GLINT_EACH_RAY {
        if (!prepare(packet[r], environment)) packet[r].ray.tMax = -1.0;
        if (FEATURE_PLANES) testPlanes(packet[r], packet[r].ray.tMax > packet[r].ray.tMin ? environment.planeCount : 0u);
    }
    return traversePacket(environment.root);
}

// Path r of this lane: those of a subgroup are consecutive, 8 being a block of 4x2 pixels, 16 one of 4x4, 32 one of 8x4. Where the dispatch has
// no such path, `present` is false and the path one that may be read.
uint packetPath(uint r, out bool present) {
    uint lane = gl_LocalInvocationID.x & 7u;
    uint path = (gl_GlobalInvocationID.x - lane) * GLINT_PACKET_RAYS + lane + 8u * r;
    present = path < dispatch.run * dispatch.interleave * kWorkgroupSize;
    return present ? path : 0u;
}

#endif
