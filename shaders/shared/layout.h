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

// Two children of a BVH node, two rows each. child: see kLeafFlag below. `escape` is the slot (2 * node +
// side) at which a traversal in depth-first order continues once both children are done, kNone at the end.
#define GLINT_NODE_ROWS(V3F, V3U, U4, A) \
    V3U(A, lo0, child0)                  \
    V3U(A, hi0, reserved)                \
    V3U(A, lo1, child1)                  \
    V3U(A, hi1, escape)

// Shading data of a triangle. normal: unit, outward by winding, computed in double from the rounded vertices.
// vertexNormals: index, or kNone. attributes: the triangle's first VertexAttribute, with the flags
// kAttribute...; 0 for none.
#define GLINT_TRIANGLE_SURFACE_ROWS(V3F, V3U, U4, A) \
    V3U(A, normal, object)                           \
    U4(A, primitive, material, vertexNormals, attributes)

// Unit vertex normals of one triangle.
#define GLINT_VERTEX_NORMALS_ROWS(V3F, V3U, U4, A) \
    V3F(A, n0, reserved0)                          \
    V3F(A, n1, reserved1)                          \
    V3F(A, n2, reserved2)

#define GLINT_POLYGON_VERTEX_ROWS(V3F, V3U, U4, A) V3F(A, position, reserved)

// ...Texture: 1 + the index of a Texture, or 0. alphaCutoff: below it, the diffuse texture's alpha is a hole.
// medium: 1 + the index of the material's Optics, which also identifies it in lists of media, or 0.
#define GLINT_MATERIAL_ROWS(V3F, V3U, U4, A) \
    V3F(A, ambient, shininess)               \
    V3F(A, diffuse, alphaCutoff)             \
    V3F(A, specular, reserved1)              \
    V3U(A, mirror, medium)                   \
    U4(A, ambientTexture, diffuseTexture, specularTexture, mirrorTexture)

// Dielectrics. density: -ln(transmission), so that light through many surfaces is the exponential of a sum.
// attenuation: per unit length. rank: the priority as an unsigned number of the same order.
#define GLINT_OPTICS_ROWS(V3F, V3U, U4, A) \
    V3F(A, transmission, ior)              \
    V3U(A, attenuation, rank)              \
    V3U(A, density, transmissionTexture)

// An image, whose texels are stored from firstTexel on by rows from the top, a checker of two colours, or the
// environment map. flags: kTexture... Coordinates are (u, v) * scale + place; of a solid checker, `place` is
// a corner of its cubes, whose edge is 1 / scaleU, in the coordinates of object frames.
#define GLINT_TEXTURE_ROWS(V3F, V3U, U4, A) \
    U4(A, flags, width, height, firstTexel) \
    V3F(A, place, scaleU)                   \
    V3F(A, colorA, scaleV)                  \
    V3F(A, colorB, reserved)

#define GLINT_TEXEL_ROWS(V3F, V3U, U4, A) V3F(A, color, alpha)

// A triangle has, with kAttributeUvs, (u0 u1 u2), (v0 v1 v2); then with kAttributeColors three linear
// colours.
#define GLINT_VERTEX_ATTRIBUTE_ROWS(V3F, V3U, U4, A) V3F(A, value, reserved)

// Frame of an object (src/pack/pack_textures.h). The object's coordinates of a local position p are
// toObjectX.p + offsetX, ... Texture coordinates follow, by uvKind (kUv...), from U = toU.p + offsetU, V and
// W.
#define GLINT_OBJECT_FRAME_ROWS(V3F, V3U, U4, A) \
    V3F(A, toObjectX, offsetX)                   \
    V3F(A, toObjectY, offsetY)                   \
    V3F(A, toObjectZ, offsetZ)                   \
    V3F(A, toU, offsetU)                         \
    V3F(A, toV, offsetV)                         \
    V3F(A, toW, offsetW)                         \
    U4(A, uvKind, reserved0, reserved1, reserved2)

// kind: kLight..., with or without kLightFades. position: of a directional light, the unit vector towards it.
// axis: unit, the way that the light of a spot travels. inner <= outer: 1 - cos of the angles at which its
// full light and all light end; as differences from 1 they keep a narrow cone's digits.
#define GLINT_LIGHT_ROWS(V3F, V3U, U4, A) \
    V3U(A, position, kind)                \
    V3F(A, intensity, inner)              \
    V3F(A, axis, outer)

// The ray of the film point (x, y), in pixels from the centre, has origin = eye + x originStepX +
// y originStepY and direction = normalize(center + x stepX + y stepY), with nearT < t <= farT. A perspective
// camera has no origin steps, a parallel one no direction steps. Through the point (a, b) of a thin lens, a
// unit disc, the origin moves by m = a lensX + b lensY and the direction by -m inverseFocus, so that all rays
// of a film point meet at the focus distance.
#define GLINT_CAMERA_ROWS(V3F, V3U, U4, A) \
    V3F(A, eye, nearT)                     \
    V3F(A, center, farT)                   \
    V3F(A, stepX, halfWidth)               \
    V3F(A, stepY, halfHeight)              \
    V3F(A, originStepX, reserved0)         \
    V3F(A, originStepY, reserved1)         \
    V3F(A, lensX, inverseFocus)            \
    V3F(A, lensY, reserved2)

// root: 0, or kNone if no primitive is in the BVH. radianceBound: the most that a ray brings in any channel
// (kInfinity: unknown); rays that bring less than minContribution are not followed. eyeMedium...: the media
// around the eye, outermost first, then 0. instancePad: with instances, boxes of the world's BVH are wider by
// it times the greatest coordinate of the ray's origin, plus instancePadAtOrigin (src/pack/instances.cpp).
// map: 0, or 1 + the index of the environment's Texture, times `background`. frameCount: of object frames.
#define GLINT_ENVIRONMENT_ROWS(V3F, V3U, U4, A)           \
    V3F(A, background, minContribution)                   \
    V3F(A, ambient, radianceBound)                        \
    U4(A, root, planeCount, lightCount, maxDepth)         \
    U4(A, eyeMedium0, eyeMedium1, eyeMedium2, eyeMedium3) \
    V3F(A, reserved0, instancePad)                        \
    V3F(A, reserved1, instancePadAtOrigin)                \
    U4(A, map, frameCount, reserved2, reserved3)

// A sample of all pixels (src/pack/pack_samples.h). Its places on film and lens, in units of 2^-32, are
// scattered by `scatter` (kScatter...) with numbers hashed from pixel, `key` and `seed`, in cells of `width`.
// tableX, tableY: filter tables from places on the film to distances from the pixel's centre. weight: the
// throughput that the path starts with. Over a pixel's samples the weights sum to their number.
#define GLINT_SAMPLE_ROWS(V3F, V3U, U4, A)        \
    U4(A, x, y, lensX, lensY)                     \
    U4(A, widthX, widthY, widthLensX, widthLensY) \
    U4(A, tableX, tableY, scatter, key)           \
    V3U(A, weight, seed)

// One corner of the box of a child of an 8-wide node: see packetTree (src/bvh/packet_tree.h).
#define GLINT_PACKET_CORNER_ROWS(V3F, V3U, U4, A) V3U(A, corner, child)

// X(binding, array, Struct, ROWS) for every array of the device. `array`: the field of PackedScene, if it has
// one. Binding 0 is the counters, 1 the path state.
#define GLINT_SCENE_ARRAYS(X)                                             \
    X(2, nodes, Node, GLINT_NODE_ROWS)                                    \
    GLINT_PRIMITIVE_ARRAYS(X)                                             \
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

// ---- Constants ----

GLINT_CONST_UINT(kSamplesBinding, 22u);  // in GLINT_SCENE_ARRAYS
GLINT_CONST_UINT(kNone, 0xffffffffu);
// The end of a ray's interval without an end: the largest float, so that no infinity enters the arithmetic.
GLINT_CONST_FLOAT(kInfinity, 3.402823466e38f);

// A child is the index of a node, kNone for no child, or a leaf of one kind: kLeafFlag | kind <<
// kLeafKindShift | (count - 1) << kLeafCountShift | first, the first in the kind's array.
GLINT_CONST_UINT(kLeafFlag, 0x80000000u);
GLINT_CONST_UINT(kLeafKindShift, 28u);
GLINT_CONST_UINT(kLeafKindMask, 7u);
GLINT_CONST_UINT(kLeafCountShift, 25u);
GLINT_CONST_UINT(kLeafCountMask, 7u);
GLINT_CONST_UINT(kLeafFirstMask, 0x01ffffffu);  // 2^25 = 33.5 million primitives of a kind

// In the id of a dielectric primitive: of surfaces in one place the lowest id is hit, so an opaque one.
GLINT_CONST_UINT(kDielectricRank, 0x80000000u);

// A primitive is kind << kPrimitiveKindShift | index into the kind's array (leaf order); kNone for none.
GLINT_CONST_UINT(kPrimitiveKindShift, 28u);
GLINT_CONST_UINT(kPrimitiveIndexMask, 0x0fffffffu);

// Above the 25 bits of a leaf's index, a solid with several surfaces has the part that is hit. A ray that
// starts on this part must not hit it again, but may hit the others.
GLINT_CONST_UINT(kPartShift, 25u);
GLINT_CONST_UINT(kPartMask, 7u);
// Parts and caps of a quadric; of a ray's source, the bit of rays that start inwards:
GLINT_CONST_UINT(kStartsInwards, 0x08000000u);
GLINT_CONST_UINT(kPartSide, 0u);
GLINT_CONST_UINT(kPartLowerCap, 1u);
GLINT_CONST_UINT(kPartUpperCap, 2u);
GLINT_CONST_UINT(kCapLower, 1u);
GLINT_CONST_UINT(kCapUpper, 2u);
GLINT_CONST_UINT(kFromApex, 4u);

GLINT_CONST_UINT(kLightPoint, 0u);
GLINT_CONST_UINT(kLightDirectional, 1u);
GLINT_CONST_UINT(kLightSpot, 2u);
GLINT_CONST_UINT(kLightKindMask, 15u);
GLINT_CONST_UINT(kLightFades, 16u);  // beside the kind: intensity / distance^2

GLINT_CONST_UINT(kMaxMedia, 4u);     // that a ray can be inside of; it ignores the surface of one more
GLINT_CONST_UINT(kMaxWaiting, 16u);  // branches of a path; beyond, the weaker of two is dropped

GLINT_CONST_UINT(kTextureWrapRepeat, 0u);
GLINT_CONST_UINT(kTextureWrapClamp, 1u);
GLINT_CONST_UINT(kTextureWrapMirror, 2u);
GLINT_CONST_UINT(kTextureWrapMask, 3u);    // of u
GLINT_CONST_UINT(kTextureWrapVShift, 2u);  // of v: the next two bits
GLINT_CONST_UINT(kTextureNearest, 16u);    // else bilinear
GLINT_CONST_UINT(kTextureChecker, 32u);    // else an image
GLINT_CONST_UINT(kTextureSolid, 64u);      // a checker of cubes
// Greater texture coordinates, which cannot resolve a texel, and NaN count as 0.
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

GLINT_CONST_UINT(kScatterNone, 0u);       // the same place in all pixels
GLINT_CONST_UINT(kScatterJitter, 1u);     // at random in its cell
GLINT_CONST_UINT(kScatterOwen, 2u);       // scrambled, by other random numbers in each pixel
GLINT_CONST_UINT(kLensKey, 0xffffffffu);  // shifts a pixel's jittered lens points; no sample has it
// The samples' array begins with two filter tables, inverse cumulative distributions: for each of
// kFilterCells equal parts of [0, 1), the first and last distance from the pixel's centre in units of
// 2^-kFilterBits pixels, linear between. A row holds two cells, a Sample four rows.
GLINT_CONST_UINT(kFilterCells, 1024u);
GLINT_CONST_UINT(kFilterCellShift, 22u);  // 2^32 / kFilterCells
GLINT_CONST_UINT(kFilterBits, 18u);
GLINT_CONST_UINT(kFilterRows, 512u);
GLINT_CONST_UINT(kFirstSample, 256u);  // two tables

// Levels of the BVH below the root, of the world's and a prototype's together: the stack's entries.
GLINT_CONST_UINT(kMaxBvhDepth, 48u);
GLINT_CONST_UINT(kPolygonEdgesPerTrip, 4u);
GLINT_CONST_UINT(kWorkgroupSize, 64u);  // one tile
GLINT_CONST_UINT(kTileSize, 8u);

GLINT_CONST_UINT(kPacketRays, 4u);   // rays of a lane
GLINT_CONST_UINT(kCountLeaves, 8u);  // leaves that a ray which counts crossings collects
GLINT_CONST_UINT(kPacketTurns, 8u);  // any-hit packets that a subgroup traces one after the other

// ---- The model of light and of samples (docs/reference/shading.md, docs/guide/sampling.md) ----

// A shadow ray ends at 1 - 2^-16 of the distance to a point light, so that the surface on which a light lies
// does not shade it.
GLINT_CONST_FLOAT(kShadowEnd, 0.9999847412109375f);
GLINT_CONST_FLOAT(kNearestLight, 1e-15f);  // closer lights are ignored: 1/d^2 would overflow
// Lights below this cosine (2^-20) are ignored, as rounding decides the sign of smaller ones.
GLINT_CONST_FLOAT(kLeastCosine, 9.5367431640625e-7f);
// The least normal float: branches of less throughput are ignored, as devices may flush them.
GLINT_CONST_FLOAT(kLeastThroughput, 1.17549435e-38f);
GLINT_CONST_UINT(kShadowBits, 32u);  // lights whose occlusion at the first hit a pixel records

// A path's hash: FNV-1a over words (G. Fowler, L. C. Noll, K.-P. Vo, 32 bits).
GLINT_CONST_UINT(kHashStart, 2166136261u);
GLINT_CONST_UINT(kHashPrime, 16777619u);

// The float below 1: the height of an upper cap. 1 would be the start of the next repeat of an image.
GLINT_CONST_FLOAT(kBelowOne, 0.999999940395355224609375f);
GLINT_CONST_FLOAT(kDarkestMean, 0.125f);  // adaptive sampling counts darker means as this bright
GLINT_CONST_UINT(kPairFilm, 0u);          // a sample's point in the pixel
GLINT_CONST_UINT(kPairLens, 1u);          // and on the lens

#endif
