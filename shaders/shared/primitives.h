// The one list of primitives. The host, the shaders and the reference generate code from it or check
// themselves against it (docs/design/how-to-add.md).
#ifndef GLINT_SHARED_PRIMITIVES_H
#define GLINT_SHARED_PRIMITIVES_H

// C++ has its own (src/core/device_layout.h).
#ifndef GLINT_CONST_UINT
#define GLINT_CONST_UINT(name, value) const uint name = value
#define GLINT_CONST_FLOAT(name, value) const float name = value
#endif

// ---- Rows (see layout.h) ----

// id: the global primitive number (objects in file order, faces in file order), the tie-break for equal t.
#define GLINT_TRIANGLE_ROWS(V3F, V3U, U4, A) \
    V3U(A, v0, id)                           \
    V3U(A, v1, reserved1)                    \
    V3U(A, v2, reserved2)

// point: the centre; anchorNormal: 0. An anchored sphere, whose radius is so much greater than its distance
// from the eye that they would cancel, has a `point` of its surface, with the unit outward normal n, and
// consists of the points x with |x - point|^2 + 2 radius n.(x - point) = 0.
#define GLINT_SPHERE_ROWS(V3F, V3U, U4, A) \
    V3F(A, point, radius)                  \
    V3U(A, anchorNormal, id)               \
    U4(A, object, primitive, material, reserved)

// normal: unit.
#define GLINT_PLANE_ROWS(V3F, V3U, U4, A) \
    V3U(A, point, id)                     \
    V3U(A, normal, object)                \
    U4(A, primitive, material, reserved0, reserved1)

// normal: unit. The disc is what of the plane through `center` lies no farther than `radius` from it.
#define GLINT_DISC_ROWS(V3F, V3U, U4, A) \
    V3U(A, center, id)                   \
    V3F(A, normal, radius)               \
    U4(A, object, primitive, material, reserved)

// normal: unit; point: in the plane. The outline's vertices are stored from firstVertex on; the first one is
// repeated at the end until there are `trips` times kPolygonEdgesPerTrip edges.
#define GLINT_POLYGON_ROWS(V3F, V3U, U4, A) \
    V3U(A, point, id)                       \
    V3U(A, normal, object)                  \
    U4(A, primitive, material, firstVertex, trips)

// The part of the surface y.Qy + 2 linear.y + constant = 0, y = T (x - point), in the box lo <= y <= hi. T
// has the rows toLocal0..2. It scales a length of the surface's own size to about 1, so that no square leaves
// fp32's range. Q has the squares on the diagonal and the products beside it (yz, xz, xy: each stands there
// twice).
// The left side is negative inside. `caps` closes the solid where it leaves the box through y.z = lo.z
// (kCapLower) or hi.z (kCapUpper); the box then has room on its other sides. If the eye is close to a surface
// of little curvature, `point` lies on the surface, and constant vanishes. For a cone with a tip that is
// close (kFromApex in `caps`), `linear` is y - y', y' = T (x - apex), and y'.Qy' = 0 is its equation;
// `constant` is that of y.
#define GLINT_QUADRIC_ROWS(V3F, V3U, U4, A) \
    V3U(A, point, id)                       \
    V3F(A, toLocal0, constant)              \
    V3U(A, toLocal1, object)                \
    V3U(A, toLocal2, primitive)             \
    V3U(A, squares, material)               \
    V3U(A, products, caps)                  \
    V3F(A, linear, reserved0)               \
    V3F(A, lo, reserved1)                   \
    V3F(A, hi, reserved2)

// A prototype placed in the world. It has a BVH, coordinates, ids from 0, and materials, which count if the
// instance's is kNone. A point x of the world is W (x - place) there, with the rows toObject of W; toWorld is
// the inverse of the rounded W. idBase: added to the ids. mirrored: 1 if the transform reverses windings, so
// that the second and third corner of triangles, and u and v of hits, are exchanged.
#define GLINT_INSTANCE_ROWS(V3F, V3U, U4, A) \
    V3U(A, place, root)                      \
    V3U(A, toObjectX, idBase)                \
    V3U(A, toObjectY, object)                \
    V3U(A, toObjectZ, material)              \
    V3U(A, toWorldX, mirrored)               \
    V3F(A, toWorldY, reserved1)              \
    V3F(A, toWorldZ, reserved2)

// The solid lo <= y <= hi for y = T (x - point). T has the rows toLocal0..2, unit normals of the faces.
// Without a transform T is the identity and point is 0, so that the faces are exactly at lo and hi. The part
// (kPartShift) of the face at hi is 2 axis + 1, at lo 2 axis.
#define GLINT_CUBOID_ROWS(V3F, V3U, U4, A) \
    V3U(A, point, id)                      \
    V3U(A, toLocal0, object)               \
    V3U(A, toLocal1, primitive)            \
    V3U(A, toLocal2, material)             \
    V3F(A, lo, reserved0)                  \
    V3F(A, hi, reserved1)

// ---- The list ----

// V(number, Kind, KINDS, kinds, one, many) for each kind that a ray can hit, I(...) for instances, which have
// a BVH of their own:
//   number     in leaves and primitive numbers (layout.h), ascending
//   Kind       the struct, and kKind<Kind>
//   KINDS      the feature, FEATURE_<KINDS>
//   kinds      the array of PackedScene, and the field of SceneFeatures
//   one, many  what the user calls it
#define GLINT_PRIMITIVES(V, I)                                \
    V(0, Triangle, TRIANGLES, triangles, triangle, triangles) \
    V(1, Sphere, SPHERES, spheres, sphere, spheres)           \
    V(2, Plane, PLANES, planes, plane, planes)                \
    V(3, Disc, DISCS, discs, disc, discs)                     \
    V(4, Polygon, POLYGONS, polygons, polygon, polygons)      \
    V(5, Quadric, QUADRICS, quadrics, quadric, quadrics)      \
    I(6, Instance, INSTANCES, instances, instance, instances) \
    V(7, Cuboid, CUBOIDS, cuboids, box, boxes)
// For lists without instances.
#define GLINT_NO_KIND(number, Kind, KINDS, kinds, one, many)
#define GLINT_KIND_CONSTANT(number, Kind, KINDS, kinds, one, many) GLINT_CONST_UINT(kKind##Kind, number);
GLINT_PRIMITIVES(GLINT_KIND_CONSTANT, GLINT_KIND_CONSTANT)
// Bits of the kinds whose hits have their own texture coordinates (other kinds use those of the object's
// frame), and of those that a ray may hit more than once.
GLINT_CONST_UINT(kOwnUvKinds, 1u << kKindTriangle | 1u << kKindCuboid);
GLINT_CONST_UINT(kFurtherHitKinds, 1u << kKindSphere | 1u << kKindQuadric | 1u << kKindCuboid);

// The primitives' part of GLINT_SCENE_ARRAYS (layout.h): X(binding, array, Struct, ROWS).
#define GLINT_PRIMITIVE_ARRAYS(X)                   \
    X(3, triangles, Triangle, GLINT_TRIANGLE_ROWS)  \
    X(6, spheres, Sphere, GLINT_SPHERE_ROWS)        \
    X(7, planes, Plane, GLINT_PLANE_ROWS)           \
    X(12, discs, Disc, GLINT_DISC_ROWS)             \
    X(13, polygons, Polygon, GLINT_POLYGON_ROWS)    \
    X(15, quadrics, Quadric, GLINT_QUADRIC_ROWS)    \
    X(16, instances, Instance, GLINT_INSTANCE_ROWS) \
    X(24, cuboids, Cuboid, GLINT_CUBOID_ROWS)

// The primitives' part of GLINT_FEATURES (dispatch.h): X(constant id, FEATURE, kinds).
#define GLINT_PRIMITIVE_FEATURES(X) \
    X(0, TRIANGLES, triangles)      \
    X(1, SPHERES, spheres)          \
    X(3, PLANES, planes)            \
    X(11, DISCS, discs)             \
    X(12, POLYGONS, polygons)       \
    X(13, QUADRICS, quadrics)       \
    X(14, INSTANCES, instances)     \
    X(33, CUBOIDS, cuboids)

#endif
