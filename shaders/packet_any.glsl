// Whether each ray of a group of a packet hits anything. Nothing gets nearer here, so that no entry of the stack ever falls out of reach; but rays
// are settled, and what only they enter is dropped. Children come as they lie in the node: by distance, nearest first, a ray that leaves a
// surface meets its own neighbourhood first, which seldom shades it.
#ifndef GLINT_PACKET_ANY_GLSL
#define GLINT_PACKET_ANY_GLSL

// As PacketStack's, the key being the rows that enter the box. `awake`: rows with rays that are not settled.
uint popAwake(inout PacketStack stack, uint awake, uint lane, inout uint rows) {
    uint height = 0u;
    for (uint row = 0u; row < GLINT_STACK_ROWS; ++row) {
        uint place = 8u * row + lane;
        bool reachable = place < stack.top && (stack.key[row] & awake) != 0u;
        height = reachable ? place + 1u : height;
    }
    height = largestOfLanes(height);
    bool empty = height == 0u;
    uint place = height - 1u;
    uint row = place >> 3;
    uint held = row == 0u ? stack.child.x : (row == 1u ? stack.child.y : (row == 2u ? stack.child.z : stack.child.w));
    uint child = subgroupShuffle(held, place & 7u);
    uint heldKey = row == 0u ? stack.key.x : (row == 1u ? stack.key.y : (row == 2u ? stack.key.z : stack.key.w));
    rows = subgroupShuffle(heldKey, place & 7u) & awake;
    stack.top = empty ? 0u : place;
    return empty ? kNone : child;
}

uint anyOfLanes(uint bits) {
    bits |= subgroupShuffleXor(bits, 1u);
    bits |= subgroupShuffleXor(bits, 2u);
    return bits | subgroupShuffleXor(bits, 4u);
}

// A ray that has hit needs nothing more. Returns the rows that do, in all lanes.
uint updateAwake() {
    uint awake = 0u;
    GLINT_EACH_RAY {
        if (settled(packet[r])) packetEnds[r] = -1.0;
        awake |= packetEnds[r] >= 0.0 ? 1u << r : 0u;
    }
    return anyOfLanes(awake);
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
        one.hit.primitive = primitive;
    if (MODE_COST && present) ++one.cost;
}

// Row by row, as for the closest hit, but with less to take out and put back.
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
            if (FEATURE_SPLIT_TRIANGLES) one.sourceTriangle = mine ? packet[r].sourceTriangle : one.sourceTriangle;
            one.frame.shear = mine ? packet[r].frame.shear : one.frame.shear;
            one.hit.primitive = mine ? packet[r].hit.primitive : one.hit.primitive;
            if (MODE_COST) one.cost = mine ? packet[r].cost : one.cost;
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
            if (MODE_COST) packet[r].cost = mine ? one.cost : packet[r].cost;
            given = given || mine;
        }
        left &= left - 1u;
        ++trips;
    } while (left != 0u);
}

// As the closest hit's walkGroup.
bool walkGroup(uint group, uint root, uint lane, inout uint trips) {
    PacketStack stack;
    stack.child = uvec4(kNone);
    stack.key = uvec4(0u);
    stack.top = 0u;
    float farthest = -1.0;
    GLINT_EACH_RAY {
        precise float end = packet[r].ray.tMax * kFarPad;
        packetEnds[r] = packet[r].ray.tMax > packet[r].ray.tMin ? end : -1.0;
        farthest = larger(farthest, packetEnds[r]);
    }
    farthest = largestOfLanes(farthest);
    uint awake = updateAwake();
    bvec3 negative = signsOf(group);
    uint axis = group & 3u;
    PacketBounds bounds = boundsOf(negative);
    uint current = awake == 0u ? kNone : root;
    uint rows = awake;
    bool complete = true;
    do if (current != kNone) {
        do if (isNode(current)) {
            PacketCorner lower = loadPacketCorner(16u * current + lane);
            vec3 upper = loadPacketCorner(16u * current + 8u + lane).corner;
            vec3 nearPlane = mix(lower.corner, upper, negative);
            vec3 farPlane = mix(upper, lower.corner, negative);
            float near;
            bool entered = groupEnters(bounds, nearPlane, farPlane, farthest, near);
            uint left = anyOfLanes(entered ? 1u << lane : 0u);
            bool full = stack.top > 8u * (GLINT_STACK_ROWS - 1) || trips > dispatch.tripBudget;
            complete = complete && !full;
            do if (left != 0u) {
                uint place = uint(findLSB(left));
                left &= left - 1u;
                uint entering = rowsThatEnter(fromLane(nearPlane, place), fromLane(farPlane, place));
                pushOne(stack, entering, subgroupShuffle(lower.child, place), entering != 0u, lane);
                ++trips;
                if (MODE_COST) GLINT_EACH_RAY packet[r].cost += packetEnds[r] >= 0.0 ? 1u : 0u;
            } while (left != 0u);
            trips += 2u;
            uint popped = popAwake(stack, awake, lane, rows);
            current = full ? kNone : popped;
            if (MODE_COST) GLINT_EACH_RAY packet[r].cost += packetEnds[r] >= 0.0 ? 8u : 0u;
        } while (isNode(current));
        do if (isLeaf(current)) {
            uint kind = (current >> kLeafKindShift) & kLeafKindMask;
            uint first = current & kLeafFirstMask;
            uint last = first + ((current >> kLeafCountShift) & kLeafCountMask) + 1u;
            if (FEATURE_TRIANGLES) testPacketTriangles(axis, kind == kKindTriangle ? first : last, last, lane, rows, trips);
            if (FEATURE_SPHERES) testPacketSpheres(kind == kKindSphere ? first : last, last, trips);
            awake = updateAwake();
            uint popped = popAwake(stack, awake, lane, rows);
            bool spent = trips > dispatch.tripBudget;
            complete = complete && !spent;
            current = spent ? kNone : popped;
            trips += 4u;
        } while (isLeaf(current));
        ++trips;
    } while (current != kNone);
    return complete;
}

#endif
