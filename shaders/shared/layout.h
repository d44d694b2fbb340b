// Layouts, limits and lists that the host and the shaders must agree on, written once and included by both.
// Algorithms are never shared (docs/design/architecture.md).
//
// Every struct is a list of 16-byte rows, so that std430, std140 and C++ agree without padding:
//   V3F(A, a, b)  vec3 a, float b     V3U(A, a, b)  vec3 a, uint b     U4(A, a, b, c, d)  four uints
// where A is what the list's user hands on.
// GLSL loads a struct with loadX(index), generated from the same list (shaders/storage.glsl).
#ifndef GLINT_SHARED_LAYOUT_H
#define GLINT_SHARED_LAYOUT_H

#include "shared/primitives.h"

// ---- Structs ----

// Two children of a BVH node. child: see kLeafFlag below. `escape` is the slot (2 * node + side) at which a
// walk in depth-first order goes on once both children are done, kNone at the end.
#define GLINT_NODE_ROWS(V3F, V3U, U4, A) \
    V3U(A, lo0, child0)                  \
    V3U(A, hi0, child1)                  \
    V3U(A, lo1, escape)                  \
    V3U(A, hi1, reserved)

// Shading data of a triangle. normal: unit, outward by winding, computed in double from the rounded vertices.
// vertexNormals: index into the VertexNormals array, or kNone. attributes: the first of the triangle's rows
// in the VertexAttribute array, with the flags kAttribute... in its upper bits; 0 if the triangle has no such
// rows.
#define GLINT_TRIANGLE_SURFACE_ROWS(V3F, V3U, U4, A) \
    V3U(A, normal, object)                           \
    U4(A, primitive, material, vertexNormals, attributes)

// Unit vertex normals of one triangle.
#define GLINT_VERTEX_NORMALS_ROWS(V3F, V3U, U4, A) \
    V3F(A, n0, reserved0)                          \
    V3F(A, n1, reserved1)                          \
    V3F(A, n2, reserved2)

#define GLINT_POLYGON_VERTEX_ROWS(V3F, V3U, U4, A) V3F(A, position, reserved)

// ...Texture: 1 + the index into the Texture array, or 0 for none. Where the diffuse texture's alpha is below
// alphaCutoff the surface is not there. medium: 0, or 1 + the material's index in the optics array; the
// number that stands for the material in lists of media.
#define GLINT_MATERIAL_ROWS(V3F, V3U, U4, A) \
    V3F(A, ambient, shininess)               \
    V3F(A, diffuse, alphaCutoff)             \
    V3F(A, specular, reserved1)              \
    V3U(A, mirror, medium)                   \
    U4(A, ambientTexture, diffuseTexture, specularTexture, mirrorTexture)

// Additional data of a dielectric material. density: -ln(transmission), so that the light that passes many
// surfaces is the exponential of a sum. attenuation: per unit length. rank: the priority as an unsigned
// number of the same order (kRankOfZero is priority 0).
#define GLINT_OPTICS_ROWS(V3F, V3U, U4, A) \
    V3F(A, transmission, ior)              \
    V3U(A, attenuation, rank)              \
    V3U(A, density, transmissionTexture)

// flags: kTexture... below. An image's texels stand from firstTexel on, by rows from the top. Its coordinates
// are (u, v) * scale + offset; a checker's colours are colorA and colorB. `place`: offset, or, of a solid
// checker, a corner of its cubes, whose edge is 1 / scaleU, in the coordinates of object frames. The
// environment map is a texture too.
#define GLINT_TEXTURE_ROWS(V3F, V3U, U4, A) \
    U4(A, flags, width, height, firstTexel) \
    V3F(A, place, scaleU)                   \
    V3F(A, colorA, scaleV)                  \
    V3F(A, colorB, reserved)

#define GLINT_TEXEL_ROWS(V3F, V3U, U4, A) V3F(A, color, alpha)

// Rows of a triangle: with kAttributeUvs (u0 u1 u2), (v0 v1 v2); then, with kAttributeColors, the linear
// colours of its three vertices.
#define GLINT_VERTEX_ATTRIBUTE_ROWS(V3F, V3U, U4, A) V3F(A, value, reserved)

// Coordinate frame of an object. Its own coordinates of a local position p are toObjectX.p + offsetX, ...,
// counted from the cubes of solid checkers (src/pack/pack_textures.h). Texture coordinates are made, by
// uvKind (kUv... below), of U = toU.p + offsetU, V and W.
#define GLINT_OBJECT_FRAME_ROWS(V3F, V3U, U4, A) \
    V3F(A, toObjectX, offsetX)                   \
    V3F(A, toObjectY, offsetY)                   \
    V3F(A, toObjectZ, offsetZ)                   \
    V3F(A, toU, offsetU)                         \
    V3F(A, toV, offsetV)                         \
    V3F(A, toW, offsetW)                         \
    U4(A, uvKind, reserved0, reserved1, reserved2)

// kind: kLight... below. position: a unit vector towards the light if it is directional. axis: of a spot
// light, unit, the way the light travels. Its full light ends at the angle whose 1 - cos is `inner`, all
// light at that of `outer`: as differences from 1 they keep a narrow cone's digits. inner <= outer.
#define GLINT_LIGHT_ROWS(V3F, V3U, U4, A) \
    V3U(A, position, kind)                \
    V3F(A, intensity, inner)              \
    V3F(A, axis, outer)

// Camera ray of the film point (X, Y), in pixels from the top left corner, with x = X - width/2, y = Y -
// height/2: origin = eye + x originStepX + y originStepY, direction = normalize(center + x stepX + y stepY).
// The origin steps are 0 for a perspective camera, the direction's for a parallel one.
// near, far bound t, the distance from the origin; far may be kInfinity.
// Thin lens: the ray through the point (a, b) of the unit disc starts a lensX + b lensY beside the eye and
// its direction, before it is normalised, is less by inverseFocus times that; inverseFocus is 1 over the
// focus distance, so that all rays of a film point meet there. Without a lens all three are 0.
#define GLINT_CAMERA_ROWS(V3F, V3U, U4, A) \
    V3F(A, eye, nearT)                     \
    V3F(A, center, farT)                   \
    V3F(A, stepX, halfWidth)               \
    V3F(A, stepY, halfHeight)              \
    V3F(A, originStepX, reserved0)         \
    V3F(A, originStepY, reserved1)         \
    V3F(A, lensX, inverseFocus)            \
    V3F(A, lensY, reserved2)

// Everything else that is the same for all rays. root: kNone when no primitive is in the BVH, else 0.
// radianceBound: no ray of the tree brings more, in any channel (kInfinity: not known); minContribution: what
// brings less to the pixel is not followed. eyeMedium0..3: the media around the eye, outermost first, 0 where
// the list has ended. With instances the boxes of the world's tree are wider by instancePad times the
// greatest coordinate of the ray's origin, plus instancePadAtOrigin (pack/instances.cpp). map: 1 + the
// environment map's index in the Texture array, `background` is then its factor; or 0. frameCount: of the
// ObjectFrame array, 0 or the number of objects.
#define GLINT_ENVIRONMENT_ROWS(V3F, V3U, U4, A)           \
    V3F(A, background, minContribution)                   \
    V3F(A, ambient, radianceBound)                        \
    U4(A, root, planeCount, lightCount, maxDepth)         \
    U4(A, eyeMedium0, eyeMedium1, eyeMedium2, eyeMedium3) \
    V3F(A, reserved0, instancePad)                        \
    V3F(A, reserved1, instancePadAtOrigin)                \
    U4(A, map, frameCount, reserved2, reserved3)

// One sample of all pixels (pack/pack_samples.h). Its place on the film and on the lens are numbers of [0, 1)
// in units of 2^-32, to be scattered by `scatter`, one of kScatter... below, with random numbers hashed from
// pixel, `key` and `seed`; `width`: the cells of a jittered sample. tableX, tableY: the filter tables that
// turn the place on the film into the distance from the pixel's centre. weight: the same in all channels,
// where the path's throughput starts. Sums of weights over a pixel's samples are their number.
#define GLINT_SAMPLE_ROWS(V3F, V3U, U4, A)        \
    U4(A, x, y, lensX, lensY)                     \
    U4(A, widthX, widthY, widthLensX, widthLensY) \
    U4(A, tableX, tableY, scatter, key)           \
    V3U(A, weight, seed)

// One corner of the box of a child of an 8-wide node: see packetTree (src/bvh/packet_tree.h).
#define GLINT_PACKET_CORNER_ROWS(V3F, V3U, U4, A) V3U(A, corner, child)

// X(binding, array, Struct, ROWS): every array of the device, and the struct that it is made of. `array`: the
// field of PackedScene, where that has one. Binding 0 is the counters, 1 the path state.
#define GLINT_SCENE_ARRAYS(X)                                             \
    X(2, nodes, Node, GLINT_NODE_ROWS)                                    \
    X(3, triangles, Triangle, GLINT_TRIANGLE_ROWS)                        \
    X(6, spheres, Sphere, GLINT_SPHERE_ROWS)                              \
    X(7, planes, Plane, GLINT_PLANE_ROWS)                                 \
    X(12, discs, Disc, GLINT_DISC_ROWS)                                   \
    X(13, polygons, Polygon, GLINT_POLYGON_ROWS)                          \
    X(15, quadrics, Quadric, GLINT_QUADRIC_ROWS)                          \
    X(16, instances, Instance, GLINT_INSTANCE_ROWS)                       \
    X(24, cuboids, Cuboid, GLINT_CUBOID_ROWS)                             \
    X(4, triangleSurfaces, TriangleSurface, GLINT_TRIANGLE_SURFACE_ROWS)  \
    X(5, vertexNormals, VertexNormals, GLINT_VERTEX_NORMALS_ROWS)         \
    X(8, materials, Material, GLINT_MATERIAL_ROWS)                        \
    X(9, lights, Light, GLINT_LIGHT_ROWS)                                 \
    X(10, environment, Environment, GLINT_ENVIRONMENT_ROWS)               \
    X(11, camera, Camera, GLINT_CAMERA_ROWS)                              \
    X(14, polygonVertices, PolygonVertex, GLINT_POLYGON_VERTEX_ROWS)      \
    X(17, packetCorners, PacketCorner, GLINT_PACKET_CORNER_ROWS)          \
    X(18, textures, Texture, GLINT_TEXTURE_ROWS)                          \
    X(19, texels, Texel, GLINT_TEXEL_ROWS)                                \
    X(20, vertexAttributes, VertexAttribute, GLINT_VERTEX_ATTRIBUTE_ROWS) \
    X(21, objectFrames, ObjectFrame, GLINT_OBJECT_FRAME_ROWS)             \
    X(22, samples, Sample, GLINT_SAMPLE_ROWS)                             \
    X(23, optics, Optics, GLINT_OPTICS_ROWS)

// Specialization constant: true if one storage buffer holds all arrays but the samples (storage.glsl). The
// bindings are then counters, path state, that buffer, samples.
#define GLINT_ARRAYS_TOGETHER 84
#define GLINT_FEW_BINDINGS 4

#define GLINT_ONE_ARRAY(binding, array, Struct, ROWS) +1
#define GLINT_BINDING_COUNT (2 GLINT_SCENE_ARRAYS(GLINT_ONE_ARRAY))

// ---- The C++ side ----

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
namespace glint::shared {
#define GLINT_CPP_V3F(A, a, b) \
    glm::vec3 a{0};            \
    float b = 0;
#define GLINT_CPP_V3U(A, a, b) \
    glm::vec3 a{0};            \
    uint32_t b = 0;
#define GLINT_CPP_U4(A, a, b, c, d) uint32_t a = 0, b = 0, c = 0, d = 0;
#define GLINT_CPP_STRUCT(binding, array, Name, ROWS)        \
    struct alignas(16) Name {                               \
        ROWS(GLINT_CPP_V3F, GLINT_CPP_V3U, GLINT_CPP_U4, 0) \
    };                                                      \
    static_assert(sizeof(Name) % 16 == 0 && alignof(Name) == 16);
GLINT_SCENE_ARRAYS(GLINT_CPP_STRUCT)
#undef GLINT_CPP_STRUCT
#define GLINT_CONST_UINT(name, value) inline constexpr uint32_t name = value
#define GLINT_CONST_FLOAT(name, value) inline constexpr float name = value
#else
#define GLINT_CONST_UINT(name, value) const uint name = value
#define GLINT_CONST_FLOAT(name, value) const float name = value
#endif

// ---- Constants ----

GLINT_CONST_UINT(kSamplesBinding, 22u);  // in GLINT_SCENE_ARRAYS
GLINT_CONST_UINT(kNone, 0xffffffffu);
// A ray's interval that has no far end holds this: the largest float, so that no infinity enters the
// arithmetic.
GLINT_CONST_FLOAT(kInfinity, 3.402823466e38f);

// A child is the index of a node, kNone for no child, or a leaf: kLeafFlag | kind << kLeafKindShift | (count
// - 1) << kLeafCountShift | first, where `first` indexes the kind's array in leaf order. A leaf holds one
// kind.
GLINT_CONST_UINT(kLeafFlag, 0x80000000u);

// In the id of a primitive: it is a dielectric. Of surfaces in one place the lowest id is hit, so an opaque
// one before any dielectric.
GLINT_CONST_UINT(kDielectricRank, 0x80000000u);
GLINT_CONST_UINT(kLeafKindShift, 28u);
GLINT_CONST_UINT(kLeafKindMask, 7u);
GLINT_CONST_UINT(kLeafCountShift, 25u);
GLINT_CONST_UINT(kLeafCountMask, 7u);
GLINT_CONST_UINT(kLeafFirstMask, 0x01ffffffu);  // 2^25 = 33.5 million primitives of a kind
GLINT_CONST_UINT(kMaxLeafSize, 8u);             // what kLeafCountMask can say

// A primitive is kind << kPrimitiveKindShift | index into the kind's array (leaf order); kNone for none.
GLINT_CONST_UINT(kPrimitiveKindShift, 28u);
GLINT_CONST_UINT(kPrimitiveIndexMask, 0x0fffffffu);
#define GLINT_KIND_CONSTANT(number, Kind, kinds, one, many) GLINT_CONST_UINT(kKind##Kind, number);
GLINT_PRIMITIVES(GLINT_KIND_CONSTANT, GLINT_KIND_CONSTANT)
#define GLINT_KIND_ONE(number, Kind, kinds, one, many) +1u
GLINT_CONST_UINT(kKindCount, 0u GLINT_PRIMITIVES(GLINT_KIND_ONE, GLINT_KIND_ONE));
#ifdef __cplusplus
// The same numbers for `switch`, which -Wswitch checks: no `default` over kinds.
#define GLINT_KIND_NAME(number, Kind, kinds, one, many) Kind = number,
enum class PrimitiveKind : uint8_t { GLINT_PRIMITIVES(GLINT_KIND_NAME, GLINT_KIND_NAME) };
#undef GLINT_KIND_NAME
static_assert(kKindCount <= kLeafKindMask + 1, "a leaf has three bits for its kind");
#endif

// For a solid with several surfaces, the primitive also holds the part that is hit, above the 25 bits that a
// leaf leaves to an index. A ray that starts on this part must not hit it again, but may hit the others.
GLINT_CONST_UINT(kPartShift, 25u);
GLINT_CONST_UINT(kPartMask, 7u);
// Parts and caps of a quadric:
GLINT_CONST_UINT(kPartSide, 0u);
GLINT_CONST_UINT(kPartLowerCap, 1u);
GLINT_CONST_UINT(kPartUpperCap, 2u);
GLINT_CONST_UINT(kCapLower, 1u);
GLINT_CONST_UINT(kCapUpper, 2u);
GLINT_CONST_UINT(kFromApex, 4u);
// A line meets a side twice at the most, each cap once.
GLINT_CONST_UINT(kQuadricHits, 4u);

GLINT_CONST_UINT(kLightPoint, 0u);
GLINT_CONST_UINT(kLightPointInverseSquare, 1u);
GLINT_CONST_UINT(kLightDirectional, 2u);
GLINT_CONST_UINT(kLightSpot, 3u);
GLINT_CONST_UINT(kLightSpotInverseSquare, 4u);

GLINT_CONST_UINT(kRankOfZero, 0x80000000u);
// Media that a ray can be inside of at a time; it does not notice the surface of one more.
GLINT_CONST_UINT(kMaxMedia, 4u);
// Branches of a path's tree that can wait to be followed; of one more and the one at hand, the lesser is
// dropped.
GLINT_CONST_UINT(kMaxWaiting, 16u);

GLINT_CONST_UINT(kTextureWrapRepeat, 0u);
GLINT_CONST_UINT(kTextureWrapClamp, 1u);
GLINT_CONST_UINT(kTextureWrapMirror, 2u);
GLINT_CONST_UINT(kTextureWrapMask, 3u);    // of u
GLINT_CONST_UINT(kTextureWrapVShift, 2u);  // of v: the next two bits
GLINT_CONST_UINT(kTextureNearest, 16u);    // else bilinear
GLINT_CONST_UINT(kTextureChecker, 32u);    // else an image
GLINT_CONST_UINT(kTextureSolid, 64u);      // a checker of cubes
// Greater texture coordinates, which have no digits left for a place within a texel, and NaN count as 0.
GLINT_CONST_FLOAT(kMaxTextureCoordinate, 1e9f);

// Texture coordinates of an object that is not a mesh: (U, V); the direction of the outward normal; that of
// (U, V, W); longitude by U and W, and V.
GLINT_CONST_UINT(kUvFlat, 0u);
GLINT_CONST_UINT(kUvNormal, 1u);
GLINT_CONST_UINT(kUvRound, 2u);
GLINT_CONST_UINT(kUvAxial, 3u);

GLINT_CONST_UINT(kAttributeUvs, 0x80000000u);
GLINT_CONST_UINT(kAttributeColors, 0x40000000u);
GLINT_CONST_UINT(kAttributeFirstMask, 0x3fffffffu);

GLINT_CONST_UINT(kScatterNone, 0u);    // the same place in all pixels
GLINT_CONST_UINT(kScatterJitter, 1u);  // at random in its cell
GLINT_CONST_UINT(kScatterOwen, 2u);    // scrambled, by other random numbers in each pixel
// The third word hashed for the shift of a pixel's jittered lens points; no sample has this key.
GLINT_CONST_UINT(kLensKey, 0xffffffffu);
// The samples' array begins with two filter tables, the inverse of a cumulative distribution each: for each
// of kFilterCells equal parts of [0, 1) the first and last distance from the pixel's centre, in units of
// 2^-kFilterBits pixels, between which it is linear. Two cells fill a row, four rows stand in for a Sample.
GLINT_CONST_UINT(kFilterCells, 1024u);
GLINT_CONST_UINT(kFilterCellShift, 22u);  // 2^32 / kFilterCells
GLINT_CONST_UINT(kFilterBits, 18u);
GLINT_CONST_UINT(kFilterRows, 512u);
GLINT_CONST_UINT(kFirstSample, 256u);  // two tables

// Levels of the BVH below the root that the builder may use, those of the world's tree and of a prototype's
// together; a traversal pushes at most one entry per level.
GLINT_CONST_UINT(kMaxBvhDepth, 48u);
// Infinite planes are tested one by one, outside the BVH; the bound keeps that loop far below the 65,535
// trips after which lavapipe ends every loop.
GLINT_CONST_UINT(kMaxPlanes, 1024u);
// The outline of a polygon is followed by so many edges in one loop trip, for as many trips at the most: with
// a leaf of 2^11 trips and 16 lanes lavapipe's 65,535 still leave a ray some 700 trips before it has to be
// resumed (path_limits.cpp).
GLINT_CONST_UINT(kPolygonEdgesPerTrip, 4u);
GLINT_CONST_UINT(kMaxPolygonTrips, 2048u);
// Invocations per workgroup; one workgroup traces one 8x8 tile. Vulkan guarantees 128.
GLINT_CONST_UINT(kWorkgroupSize, 64u);
GLINT_CONST_UINT(kTileSize, 8u);

// Children of a node of the packets' tree, and lanes of the subgroups that walk it.
GLINT_CONST_UINT(kPacketWidth, 8u);

// Rays of a lane in packet kernels; packets that a subgroup traces one after the other in those for any hits.
GLINT_CONST_UINT(kPacketRays, 4u);
GLINT_CONST_UINT(kPacketTurns, 8u);

#ifdef __cplusplus
}  // namespace glint::shared
#endif

#endif
