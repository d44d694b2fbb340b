// Hits of a packet with the primitives of leaves.
#ifndef GLINT_PACKET_HITS_GLSL
#define GLINT_PACKET_HITS_GLSL

#include "packet/packet.glsl"
#include "primitives/robust.glsl"
#include "traversal/leaf.glsl"

void testTriangle(inout Traversal one, vec3 a, vec3 b, vec3 c, vec3 v0, vec3 normal, uint primitive, uint id,
                  bool present) {
    float t, u, v;
    if (intersectTurned(one.ray, one.frame, a, b, c, v0, normal, t, u, v) && present)
        accept(one, Hit(t, u, v, primitive, kNone, id));
}

// Tests primitives `first` to `end` - 1 against all rays.
#define GLINT_PACKET_TEST(Kind)                                                                \
    void testPacket##Kind##s(uint first, uint end, inout uint trips) {                         \
        uint index = first;                                                                    \
        do {                                                                                   \
            if (index < end) {                                                                 \
                Kind one = load##Kind(index);                                                  \
                uint primitive = (kKind##Kind << kPrimitiveKindShift) | index;                 \
                GLINT_EACH_RAY {                                                               \
                    Hit hit;                                                                   \
                    if (hit##Kind(packet[r].ray, packet[r].frame, one, primitive, trips, hit)) \
                        accept(packet[r], hit);                                                \
                }                                                                              \
                ++index;                                                                       \
                ++trips;                                                                       \
            }                                                                                  \
        } while (index < end);                                                                 \
    }
GLINT_PACKET_TEST(Sphere)
GLINT_PACKET_TEST(Cuboid)

void testPacketLeaf(uint leaf, uint axis, uint lane, uint rows, inout uint trips) {
    uint kind = kindOfLeaf(leaf);
    uint first = leaf & kLeafFirstMask;
    uint end = first + sizeOfLeaf(leaf);
    if (FEATURE_TRIANGLES)
        testPacketTriangles(axis, kind == kKindTriangle ? first : end, end, lane, rows, trips);
    if (FEATURE_SPHERES) testPacketSpheres(kind == kKindSphere ? first : end, end, trips);
    if (FEATURE_CUBOIDS) testPacketCuboids(kind == kKindCuboid ? first : end, end, trips);
}

#endif
