// What triangles say about the nearest hits of a packet's rays, as shaders/leaf.glsl says it of single rays.
#ifndef GLINT_PACKET_CERTAINTY_GLSL
#define GLINT_PACKET_CERTAINTY_GLSL

// corners: of triangle `index`, turned, in the lanes from `lane` on. A ray of another group has the end -1,
// before which nothing is possible.
void judgeRowTriangle(inout Traversal one, vec3 turned, vec3 corners, uint ids, uint lane, uint index,
                      bool present) {
    vec3 v0 = fromLane(corners, lane);
    vec3 v1 = fromLane(corners, lane + 1u);
    vec3 v2 = fromLane(corners, lane + 2u);
    uint id = subgroupShuffle(ids, lane);
    precise vec3 a = v0 - turned;
    precise vec3 b = v1 - turned;
    precise vec3 d = v2 - turned;
    Span span = spanOfTurned(one.certainty, one.ray, one.frame, a, b, d);
    span.possible = span.possible && present;
    span.sure = span.sure && present;
    judge(one, span, kKindTriangle, index, id);
}

// Row by row, as in packet_closest.glsl.
void testPacketTriangles(uint axis, uint first, uint end, uint lane, uint rows, inout uint trips) {
    uint left = first < end ? rows : 0u;
    do {
        if (left != 0u) {
            Traversal one = packet[0];
            uint row = left & (~left + 1u);
            for (uint r = 1u; r < GLINT_PACKET_RAYS; ++r) {
                bool mine = row == 1u << r;
                one.ray.origin = mine ? packet[r].ray.origin : one.ray.origin;
                one.ray.tMin = mine ? packet[r].ray.tMin : one.ray.tMin;
                one.ray.tMax = mine ? packet[r].ray.tMax : one.ray.tMax;
                one.frame.shear = mine ? packet[r].frame.shear : one.frame.shear;
                one.hit.primitive = mine ? packet[r].hit.primitive : one.hit.primitive;
                one.hit.t = mine ? packet[r].hit.t : one.hit.t;
                one.hit.u = mine ? packet[r].hit.u : one.hit.u;
                one.hit.v = mine ? packet[r].hit.v : one.hit.v;
                one.hit.id = mine ? packet[r].hit.id : one.hit.id;
                one.certainty.offset = mine ? packet[r].certainty.offset : one.certainty.offset;
                one.certainty.lower = mine ? packet[r].certainty.lower : one.certainty.lower;
                one.certainty.threat = mine ? packet[r].certainty.threat : one.certainty.threat;
            }
            vec3 turned = turnToZ(one.ray.origin, axis);
            uint index = first;
            do {
                if (index < end) {
                    uvec4 texel = LOAD4(trianglesArray, 3u * index + lane);
                    vec3 corners = turnToZ(uintBitsToFloat(texel.xyz), axis);
                    judgeRowTriangle(one, turned, corners, texel.w, 0u, index, true);
                    judgeRowTriangle(one, turned, corners, texel.w, 3u, index + 1u, index + 1u < end);
                    index += 2u;
                    ++trips;
                }
            } while (index < end);
            GLINT_EACH_RAY {
                bool mine = row == 1u << r;
                packet[r].hit.primitive = mine ? one.hit.primitive : packet[r].hit.primitive;
                packet[r].ray.tMax = mine ? one.ray.tMax : packet[r].ray.tMax;
                packet[r].hit.t = mine ? one.hit.t : packet[r].hit.t;
                packet[r].hit.u = mine ? one.hit.u : packet[r].hit.u;
                packet[r].hit.v = mine ? one.hit.v : packet[r].hit.v;
                packet[r].hit.id = mine ? one.hit.id : packet[r].hit.id;
                packet[r].certainty.lower = mine ? one.certainty.lower : packet[r].certainty.lower;
                packet[r].certainty.threat = mine ? one.certainty.threat : packet[r].certainty.threat;
            }
            left ^= row;
            ++trips;
        }
    } while (left != 0u);
}

#endif
