// Layouts, limits and lists that the host and the shaders must agree on, written once and included by both.
// Algorithms are never shared (docs/architecture.md).
//
// Every struct is a list of 16-byte rows, so that std430, std140 and C++ agree without padding:
//   V3F(a, b)  vec3 a, float b      V3U(a, b)  vec3 a, uint b      U4(a, b, c, d)  four uints
// GLSL loads a struct with loadX(index), generated from the same list (shaders/storage.glsl).
#ifndef GLINT_SHARED_LAYOUT_H
#define GLINT_SHARED_LAYOUT_H

// ---- Structs
// ---------------------------------------------------------------------------------------------------

// Two children of a BVH node. child: see kLeafFlag below. `escape` is the slot (2 * node + side) at which a
// walk in depth-first order goes on once both children are done, kNone at the end.
#define GLINT_NODE_ROWS(V3F, V3U, U4) \
    V3U(lo0, child0)                  \
    V3U(hi0, child1)                  \
    V3U(lo1, escape)                  \
    V3U(hi1, reserved)

// id: the global primitive number (objects in file order, faces in file order), the tie-break for equal t.
#define GLINT_TRIANGLE_ROWS(V3F, V3U, U4) \
    V3U(v0, id)                           \
    V3U(v1, reserved1)                    \
    V3U(v2, reserved2)

// What shading needs of a triangle. normal: unit, outward by winding, computed in double from the rounded
// vertices. vertexNormals: index into the VertexNormals array, or kNone.
#define GLINT_TRIANGLE_SURFACE_ROWS(V3F, V3U, U4) \
    V3U(normal, object)                           \
    U4(primitive, material, vertexNormals, reserved)

// Unit vertex normals of one triangle.
#define GLINT_VERTEX_NORMALS_ROWS(V3F, V3U, U4) \
    V3F(n0, reserved0)                          \
    V3F(n1, reserved1)                          \
    V3F(n2, reserved2)

// Ordinary sphere: `point` is the centre, anchorNormal is zero. Anchored sphere (radius much greater than its
// distance from the eye, so that centre and radius would cancel): `point` lies on the surface, anchorNormal n
// is the unit outward normal there, and the surface is |x - point|^2 + 2 radius n.(x - point) = 0.
#define GLINT_SPHERE_ROWS(V3F, V3U, U4) \
    V3F(point, radius)                  \
    V3U(anchorNormal, id)               \
    U4(object, primitive, material, reserved)

// normal: unit.
#define GLINT_PLANE_ROWS(V3F, V3U, U4) \
    V3U(point, id)                     \
    V3U(normal, object)                \
    U4(primitive, material, reserved0, reserved1)

// normal: unit. The disc is what of the plane through `center` lies no farther than `radius` from it.
#define GLINT_DISC_ROWS(V3F, V3U, U4) \
    V3U(center, id)                   \
    V3F(normal, radius)               \
    U4(object, primitive, material, reserved)

// normal: unit; point: in the plane. The outline's vertices stand from firstVertex on, the first one again at
// the end and as often as it takes to make `trips` times kPolygonEdgesPerTrip edges: an edge without length
// crosses nothing.
#define GLINT_POLYGON_ROWS(V3F, V3U, U4) \
    V3U(point, id)                       \
    V3U(normal, object)                  \
    U4(primitive, material, firstVertex, trips)

#define GLINT_POLYGON_VERTEX_ROWS(V3F, V3U, U4) V3F(position, reserved)

#define GLINT_MATERIAL_ROWS(V3F, V3U, U4) \
    V3F(ambient, shininess)               \
    V3F(diffuse, reserved0)               \
    V3F(specular, reserved1)              \
    V3F(mirror, reserved2)

// kind: kLight... below. position: a unit vector towards the light if it is directional. axis: of a spot
// light, unit, the way the light travels. Its full light ends at the angle whose 1 - cos is `inner`, all
// light at that of `outer`: as differences from 1 they keep a narrow cone's digits. inner <= outer.
#define GLINT_LIGHT_ROWS(V3F, V3U, U4) \
    V3U(position, kind)                \
    V3F(intensity, inner)              \
    V3F(axis, outer)

// Camera ray of the film point (X, Y), in pixels from the top left corner, with x = X - width/2, y = Y -
// height/2: origin = eye + x originStepX + y originStepY, direction = normalize(center + x stepX + y stepY).
// The origin steps are 0 for a perspective camera, the direction's for a parallel one.
// near, far bound t, the distance from the origin; far may be kInfinity.
#define GLINT_CAMERA_ROWS(V3F, V3U, U4) \
    V3F(eye, nearT)                     \
    V3F(center, farT)                   \
    V3F(stepX, halfWidth)               \
    V3F(stepY, halfHeight)              \
    V3F(originStepX, reserved0)         \
    V3F(originStepY, reserved1)

// Everything else that is the same for all rays. root: kNone when no primitive is in the BVH, else 0.
#define GLINT_ENVIRONMENT_ROWS(V3F, V3U, U4) \
    V3F(background, reserved0)               \
    V3F(ambient, reserved1)                  \
    U4(root, planeCount, lightCount, maxDepth)

// One corner of the box of a child of an 8-wide node: see packetTree (src/bvh/packet_tree.h).
#define GLINT_PACKET_CORNER_ROWS(V3F, V3U, U4) V3U(corner, child)

#define GLINT_STRUCTS(X)                            \
    X(Node, GLINT_NODE_ROWS)                        \
    X(Triangle, GLINT_TRIANGLE_ROWS)                \
    X(TriangleSurface, GLINT_TRIANGLE_SURFACE_ROWS) \
    X(VertexNormals, GLINT_VERTEX_NORMALS_ROWS)     \
    X(Sphere, GLINT_SPHERE_ROWS)                    \
    X(Plane, GLINT_PLANE_ROWS)                      \
    X(Disc, GLINT_DISC_ROWS)                        \
    X(Polygon, GLINT_POLYGON_ROWS)                  \
    X(PolygonVertex, GLINT_POLYGON_VERTEX_ROWS)     \
    X(Material, GLINT_MATERIAL_ROWS)                \
    X(Light, GLINT_LIGHT_ROWS)                      \
    X(Camera, GLINT_CAMERA_ROWS)                    \
    X(Environment, GLINT_ENVIRONMENT_ROWS)          \
    X(PacketCorner, GLINT_PACKET_CORNER_ROWS)

// ---- The C++ side
// ----------------------------------------------------------------------------------------------

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
namespace glint::shared {
#define GLINT_CPP_V3F(a, b) \
    glm::vec3 a{0};         \
    float b = 0;
#define GLINT_CPP_V3U(a, b) \
    glm::vec3 a{0};         \
    uint32_t b = 0;
#define GLINT_CPP_U4(a, b, c, d) uint32_t a = 0, b = 0, c = 0, d = 0;
#define GLINT_CPP_STRUCT(Name, ROWS)                     \
    struct alignas(16) Name {                            \
        ROWS(GLINT_CPP_V3F, GLINT_CPP_V3U, GLINT_CPP_U4) \
    };                                                   \
    static_assert(sizeof(Name) % 16 == 0 && alignof(Name) == 16);
GLINT_STRUCTS(GLINT_CPP_STRUCT)
#undef GLINT_CPP_STRUCT
#define GLINT_CONST_UINT(name, value) inline constexpr uint32_t name = value
#define GLINT_CONST_FLOAT(name, value) inline constexpr float name = value
#else
#define GLINT_CONST_UINT(name, value) const uint name = value
#define GLINT_CONST_FLOAT(name, value) const float name = value
#endif

// ---- Constants
// -------------------------------------------------------------------------------------------------

GLINT_CONST_UINT(kNone, 0xffffffffu);
// A ray's interval that has no far end holds this: the largest float, so that no infinity enters the
// arithmetic.
GLINT_CONST_FLOAT(kInfinity, 3.402823466e38f);

// A child is the index of a node, kNone for no child, or a leaf: kLeafFlag | kind << kLeafKindShift | (count
// - 1) << kLeafCountShift | first, where `first` indexes the kind's array in leaf order. A leaf holds one
// kind.
GLINT_CONST_UINT(kLeafFlag, 0x80000000u);
GLINT_CONST_UINT(kLeafKindShift, 28u);
GLINT_CONST_UINT(kLeafKindMask, 7u);
GLINT_CONST_UINT(kLeafCountShift, 25u);
GLINT_CONST_UINT(kLeafCountMask, 7u);
GLINT_CONST_UINT(kLeafFirstMask, 0x01ffffffu);  // 2^25 = 33.5 million primitives of a kind
GLINT_CONST_UINT(kMaxLeafSize, 8u);             // what kLeafCountMask can say

// A primitive is kind << kPrimitiveKindShift | index into the kind's array (leaf order); kNone for none.
GLINT_CONST_UINT(kPrimitiveKindShift, 28u);
GLINT_CONST_UINT(kPrimitiveIndexMask, 0x0fffffffu);
GLINT_CONST_UINT(kKindTriangle, 0u);
GLINT_CONST_UINT(kKindSphere, 1u);
GLINT_CONST_UINT(kKindPlane, 2u);
GLINT_CONST_UINT(kKindDisc, 3u);
GLINT_CONST_UINT(kKindPolygon, 4u);
GLINT_CONST_UINT(kKindCount, 5u);

GLINT_CONST_UINT(kLightPoint, 0u);
GLINT_CONST_UINT(kLightPointInverseSquare, 1u);
GLINT_CONST_UINT(kLightDirectional, 2u);
GLINT_CONST_UINT(kLightSpot, 3u);
GLINT_CONST_UINT(kLightSpotInverseSquare, 4u);

// Levels of the BVH below the root that the builder may use; a traversal pushes at most one entry per level.
GLINT_CONST_UINT(kMaxBvhDepth, 48u);
// Infinite planes are tested one by one, outside the BVH; the bound keeps that loop far below the 65,535
// trips after which lavapipe ends every loop.
GLINT_CONST_UINT(kMaxPlanes, 1024u);
// The outline of a polygon is followed by so many edges in one loop trip, for as many trips at the most: with
// a leaf of 2^11 trips and 16 lanes lavapipe's 65,535 still leave a ray some 700 trips before it has to be
// resumed (renderer.cpp).
GLINT_CONST_UINT(kPolygonEdgesPerTrip, 4u);
GLINT_CONST_UINT(kMaxPolygonTrips, 2048u);
// Invocations per workgroup; one workgroup traces one 8x8 tile. Vulkan guarantees 128.
GLINT_CONST_UINT(kWorkgroupSize, 64u);
GLINT_CONST_UINT(kTileSize, 8u);

// Children of a node of the packets' tree, and lanes of the subgroups that walk it.
GLINT_CONST_UINT(kPacketWidth, 8u);

#ifdef __cplusplus
}  // namespace glint::shared
#endif

#endif
