// Layouts, limits and lists that the host and the shaders must agree on, written once and included by both.
// Algorithms are never shared (docs/design/architecture.md).
//
// Every struct is a list of 16-byte rows, so that std430, std140 and C++ agree without padding:
//   V3F(a, b)  vec3 a, float b      V3U(a, b)  vec3 a, uint b      U4(a, b, c, d)  four uints
// GLSL loads a struct with loadX(index), generated from the same list (shaders/storage.glsl).
#ifndef GLINT_SHARED_LAYOUT_H
#define GLINT_SHARED_LAYOUT_H

// ---- Structs ----

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
// vertices. vertexNormals: index into the VertexNormals array, or kNone. attributes: the first of the
// triangle's rows in the VertexAttribute array, with the flags kAttribute... in its upper bits; 0: it has
// none.
#define GLINT_TRIANGLE_SURFACE_ROWS(V3F, V3U, U4) \
    V3U(normal, object)                           \
    U4(primitive, material, vertexNormals, attributes)

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

// What of the surface y.Qy + 2 linear.y + constant = 0, y = T (x - point), lies in the box lo <= y <= hi. T
// has the rows toLocal0..2 and makes a length of about 1 of the surface's own size, so that no square leaves
// fp32's range. Q: squares on the diagonal, products beside it (yz, xz, xy: each stands there twice). Inside
// is where the left side is negative; `caps` closes it where it leaves the box through y.z = lo.z (kCapLower)
// or hi.z (kCapUpper). The box then has room on its other sides. Where the eye is close to a surface of
// little curvature, `point` lies on it, and constant vanishes.
#define GLINT_QUADRIC_ROWS(V3F, V3U, U4) \
    V3U(point, id)                       \
    V3F(toLocal0, constant)              \
    V3U(toLocal1, object)                \
    V3U(toLocal2, primitive)             \
    V3U(squares, material)               \
    V3U(products, caps)                  \
    V3F(linear, reserved0)               \
    V3F(lo, reserved1)                   \
    V3F(hi, reserved2)
// A prototype, a tree of its own whose primitives have their own coordinates, ids from 0 and a material that
// counts if the instance's is kNone. A point x of the world is W (x - place) there, W having the rows
// toObject; the rows toWorld are those of the inverse of W as rounded. idBase: what the ids are counted from.
// mirrored: 1 if the transform turns windings around, so that the second and third corner of triangles, and
// with them u and v of a hit, are exchanged; else 0. wideRoot: as root, among the nodes of the wide tree, if
// there is one (bvh/wide_tree.h); filled in for the device.
#define GLINT_INSTANCE_ROWS(V3F, V3U, U4) \
    V3U(place, root)                      \
    V3U(toObjectX, idBase)                \
    V3U(toObjectY, object)                \
    V3U(toObjectZ, material)              \
    V3U(toWorldX, mirrored)               \
    V3U(toWorldY, wideRoot)               \
    V3F(toWorldZ, reserved2)

// ...Texture: 1 + the index into the Texture array, or 0 for none. Where the diffuse texture's alpha is below
// alphaCutoff the surface is not there. medium: 0, or 1 + the material's index in the optics array; the
// number that stands for the material in lists of media.
#define GLINT_MATERIAL_ROWS(V3F, V3U, U4) \
    V3F(ambient, shininess)               \
    V3F(diffuse, alphaCutoff)             \
    V3F(specular, reserved1)              \
    V3U(mirror, medium)                   \
    U4(ambientTexture, diffuseTexture, specularTexture, mirrorTexture)

// What a dielectric material has besides. density: -ln(transmission), so that the light which passes many
// surfaces is the exponential of a sum; attenuation: per unit length; rank: the priority as an unsigned
// number of the same order (kRankOfZero is priority 0).
#define GLINT_OPTICS_ROWS(V3F, V3U, U4) \
    V3F(transmission, ior)              \
    V3U(attenuation, rank)              \
    V3U(density, transmissionTexture)

// flags: kTexture... below. An image's texels stand from firstTexel on, by rows from the top. Its coordinates
// are (u, v) * scale + offset; a checker's colours are colorA and colorB. `place`: offset, or, of a solid
// checker, a corner of its cubes in object space, whose edge is 1 / scaleU. The environment map is a texture
// too.
#define GLINT_TEXTURE_ROWS(V3F, V3U, U4) \
    U4(flags, width, height, firstTexel) \
    V3F(place, scaleU)                   \
    V3F(colorA, scaleV)                  \
    V3F(colorB, reserved)

#define GLINT_TEXEL_ROWS(V3F, V3U, U4) V3F(color, alpha)

// Rows of a triangle: with kAttributeUvs (u0 u1 u2), (v0 v1 v2); then, with kAttributeColors, the linear
// colours of its three vertices.
#define GLINT_VERTEX_ATTRIBUTE_ROWS(V3F, V3U, U4) V3F(value, reserved)

// Of an object: its own coordinates of a local position p are toObjectX.p + offsetX, ... What texture
// coordinates are made of, by uvKind (kUv... below), are U = toU.p + offsetU, V and W.
#define GLINT_OBJECT_FRAME_ROWS(V3F, V3U, U4) \
    V3F(toObjectX, offsetX)                   \
    V3F(toObjectY, offsetY)                   \
    V3F(toObjectZ, offsetZ)                   \
    V3F(toU, offsetU)                         \
    V3F(toV, offsetV)                         \
    V3F(toW, offsetW)                         \
    U4(uvKind, reserved0, reserved1, reserved2)

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
// Thin lens: the ray through the point (a, b) of the unit disc starts a lensX + b lensY beside the eye and
// its direction, before it is normalised, is less by inverseFocus times that; inverseFocus is 1 over the
// focus distance, so that all rays of a film point meet there. Without a lens all three are 0.
#define GLINT_CAMERA_ROWS(V3F, V3U, U4) \
    V3F(eye, nearT)                     \
    V3F(center, farT)                   \
    V3F(stepX, halfWidth)               \
    V3F(stepY, halfHeight)              \
    V3F(originStepX, reserved0)         \
    V3F(originStepY, reserved1)         \
    V3F(lensX, inverseFocus)            \
    V3F(lensY, reserved2)

// Everything else that is the same for all rays. root: kNone when no primitive is in the BVH, else 0.
// radianceBound: no ray of the tree brings more, in any channel (kInfinity: not known); minContribution: what
// brings less to the pixel is not followed. eyeMedium0..3: the media around the eye, outermost first, 0 where
// the list has ended. With instances the boxes of the world's tree are wider by instancePad times the
// greatest coordinate of the ray's origin, plus instancePadAtOrigin (pack/instances.cpp). map: 1 + the
// environment map's index in the Texture array, `background` is then its factor; or 0. frameCount: of the
// ObjectFrame array, 0 or the number of objects.
#define GLINT_ENVIRONMENT_ROWS(V3F, V3U, U4)           \
    V3F(background, minContribution)                   \
    V3F(ambient, radianceBound)                        \
    U4(root, planeCount, lightCount, maxDepth)         \
    U4(eyeMedium0, eyeMedium1, eyeMedium2, eyeMedium3) \
    V3F(reserved0, instancePad)                        \
    V3F(reserved1, instancePadAtOrigin)                \
    U4(map, frameCount, reserved2, reserved3)

// One sample of all pixels (pack/pack_samples.h). Its place on the film and on the lens are numbers of [0, 1)
// in units of 2^-32, to be scattered by `scatter`, one of kScatter... below, with random numbers hashed from
// pixel, `key` and `seed`; `width`: the cells of a jittered sample. tableX, tableY: the filter tables that
// turn the place on the film into the distance from the pixel's centre. weight: the same in all channels,
// where the path's throughput starts. Sums of weights over a pixel's samples are their number.
#define GLINT_SAMPLE_ROWS(V3F, V3U, U4)        \
    U4(x, y, lensX, lensY)                     \
    U4(widthX, widthY, widthLensX, widthLensY) \
    U4(tableX, tableY, scatter, key)           \
    V3U(weight, seed)

// One corner of the box of a child of an 8-wide node: see packetTree (src/bvh/packet_tree.h).
#define GLINT_PACKET_CORNER_ROWS(V3F, V3U, U4) V3U(corner, child)

// A row of a wide node, or four words for leaves: see wideTree (src/bvh/wide_tree.h).
#define GLINT_WIDE_ROW_ROWS(V3F, V3U, U4) U4(x, y, z, w)

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
    X(Quadric, GLINT_QUADRIC_ROWS)                  \
    X(Instance, GLINT_INSTANCE_ROWS)                \
    X(Material, GLINT_MATERIAL_ROWS)                \
    X(Optics, GLINT_OPTICS_ROWS)                    \
    X(Light, GLINT_LIGHT_ROWS)                      \
    X(Camera, GLINT_CAMERA_ROWS)                    \
    X(Environment, GLINT_ENVIRONMENT_ROWS)          \
    X(Texture, GLINT_TEXTURE_ROWS)                  \
    X(Texel, GLINT_TEXEL_ROWS)                      \
    X(VertexAttribute, GLINT_VERTEX_ATTRIBUTE_ROWS) \
    X(ObjectFrame, GLINT_OBJECT_FRAME_ROWS)         \
    X(Sample, GLINT_SAMPLE_ROWS)                    \
    X(PacketCorner, GLINT_PACKET_CORNER_ROWS)       \
    X(WideRow, GLINT_WIDE_ROW_ROWS)

// ---- The C++ side ----

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

// ---- Constants ----

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
GLINT_CONST_UINT(kKindQuadric, 5u);
GLINT_CONST_UINT(kKindInstance, 6u);  // of leaves, which hold a single one; never of a primitive that is hit
GLINT_CONST_UINT(kKindCount, 7u);

// Of a quadric, the part that is hit stands in the primitive too, above the 25 bits that a leaf leaves to an
// index: a ray that starts there must not meet that part again, but may meet the others.
GLINT_CONST_UINT(kQuadricPartShift, 26u);
GLINT_CONST_UINT(kQuadricPartMask, 3u);
GLINT_CONST_UINT(kPartSide, 0u);
GLINT_CONST_UINT(kPartLowerCap, 1u);
GLINT_CONST_UINT(kPartUpperCap, 2u);
GLINT_CONST_UINT(kCapLower, 1u);
GLINT_CONST_UINT(kCapUpper, 2u);
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
// Loop trips that asking a material for holes may cost a primitive test, within that of the primitive: three
// loops of one trip, twice for a sphere. Counted for every test of a scene that has such materials.
GLINT_CONST_UINT(kMaskTrips, 6u);
// Of the loops around textures outside the traversal.
GLINT_CONST_UINT(kTextureTrips, 16u);
// Invocations per workgroup; one workgroup traces one 8x8 tile. Vulkan guarantees 128.
GLINT_CONST_UINT(kWorkgroupSize, 64u);
GLINT_CONST_UINT(kTileSize, 8u);

// Children of a node of the packets' tree, and lanes of the subgroups that walk it.
GLINT_CONST_UINT(kPacketWidth, 8u);

// Rows of a node of four children, and of a compressed one of eight.
GLINT_CONST_UINT(kFourRows, 8u);
GLINT_CONST_UINT(kCompressedRows, 5u);

#ifdef __cplusplus
}  // namespace glint::shared
#endif

#endif
