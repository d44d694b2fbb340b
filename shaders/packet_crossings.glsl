// Triangles that the rays of a packet cross, as shaders/leaf.glsl counts them for single rays.
#ifndef GLINT_PACKET_CROSSINGS_GLSL
#define GLINT_PACKET_CROSSINGS_GLSL

// Triangles that a ray may put aside; one that has more is started again by itself.
const uint kMostPacketAside = 4u;

// corners: of triangle `index`, turned, in the lanes from `lane` on. A ray of another group has the end -1,
// and triangles about the origin seem to lie before that.
void lookAtRowTriangle(inout Traversal one, vec3 turned, vec3 corners, uint lane, uint index, bool present) {
    vec3 v0 = fromLane(corners, lane);
    vec3 v1 = fromLane(corners, lane + 1u);
    vec3 v2 = fromLane(corners, lane + 2u);
    precise vec3 a = v0 - turned;
    precise vec3 b = v1 - turned;
    precise vec3 c = v2 - turned;
    Look look = lookAtTurned(one.ray, one.frame, a, b, c);
    bool certain = look.certain;
    bool crosses = look.crosses && present && one.ray.tMax > 0.0;
    bool aside = crosses && !certain;
    one.crossed += crosses && certain ? 1u : 0u;
    one.aside0 = aside ? uvec4(index, one.aside0.xyz) : one.aside0;
    one.aside += aside ? 1u : 0u;
}

// Row by row, as for any hit.
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
                one.crossed = mine ? packet[r].crossed : one.crossed;
                one.aside = mine ? packet[r].aside : one.aside;
                one.aside0 = mine ? packet[r].aside0 : one.aside0;
            }
            vec3 turned = turnToZ(one.ray.origin, axis);
            uint index = first;
            do {
                if (index < end) {
                    uvec4 texel = LOAD4(trianglesArray, 3u * index + lane);
                    vec3 corners = turnToZ(uintBitsToFloat(texel.xyz), axis);
                    lookAtRowTriangle(one, turned, corners, 0u, index, true);
                    lookAtRowTriangle(one, turned, corners, 3u, index + 1u, index + 1u < end);
                    index += 2u;
                    ++trips;
                }
            } while (index < end);
            GLINT_EACH_RAY {
                bool mine = row == 1u << r;
                packet[r].crossed = mine ? one.crossed : packet[r].crossed;
                packet[r].aside = mine ? one.aside : packet[r].aside;
                packet[r].aside0 = mine ? one.aside0 : packet[r].aside0;
            }
            left ^= row;
            ++trips;
        }
    } while (left != 0u);
}

// Looks closely at what was put aside: one triangle of each lane in a trip, whichever row's it is.
void settlePacketAside() {
    uint trips = 0u;
    bool some = false;
    GLINT_EACH_RAY some = some || packet[r].aside > 0u;
    do {
        if (some) {
            Traversal one = packet[0];
            uint row = 0u;
            for (uint r = 1u; r < GLINT_PACKET_RAYS; ++r) {
                bool mine = packet[r].aside > 0u;
                row = mine ? r : row;
                one.ray.origin = mine ? packet[r].ray.origin : one.ray.origin;
                one.ray.tMin = mine ? packet[r].ray.tMin : one.ray.tMin;
                one.ray.tMax = mine ? packet[r].ray.tMax : one.ray.tMax;
                one.frame.shear = mine ? packet[r].frame.shear : one.frame.shear;
                one.frame.axis = mine ? packet[r].frame.axis : one.frame.axis;
                one.aside0 = mine ? packet[r].aside0 : one.aside0;
            }
            float t, u, v;
            bool doubtful;
            bool isHit =
                crossTriangle(one.ray, one.frame, loadTriangle(one.aside0.x), trips, t, u, v, doubtful);
            some = false;
            GLINT_EACH_RAY {
                bool mine = row == r;
                packet[r].crossed += mine && isHit ? 1u : 0u;
                packet[r].doubtful |= mine && doubtful ? 1u : 0u;
                packet[r].aside -= mine ? 1u : 0u;
                packet[r].aside0 = mine ? packet[r].aside0.yzww : packet[r].aside0;
                some = some || packet[r].aside > 0u;
            }
        }
    } while (some);
}

#endif
