// What the host tells a kernel: bindings, specialization constants, push constants, and the rows of the path
// state.
#ifndef GLINT_SHARED_DISPATCH_H
#define GLINT_SHARED_DISPATCH_H

#include "shared/layout.h"

// X(constant id, GLSL name FEATURE_..., C++ field of SceneFeatures)
#define GLINT_FEATURES(X)                       \
    X(0, TRIANGLES, triangles)                  \
    X(1, SPHERES, spheres)                      \
    X(2, ANCHORED_SPHERES, anchoredSpheres)     \
    X(3, PLANES, planes)                        \
    X(4, VERTEX_NORMALS, vertexNormals)         \
    X(5, POINT_LIGHTS, pointLights)             \
    X(6, DIRECTIONAL_LIGHTS, directionalLights) \
    X(7, SPECULAR, specular)                    \
    X(8, MIRRORS, mirrors)                      \
    X(9, SPOT_LIGHTS, spotLights)               \
    X(10, PARALLEL_CAMERA, parallelCamera)      \
    X(11, DISCS, discs)                         \
    X(12, POLYGONS, polygons)

// X(constant id, GLSL name, C++ field of TraceModes)
// aovs: write the rows kRowAov...; cost: count boxes and primitives; resume: go on with unfinished rays by
// the stackless walk. shadowless: lights shine through everything; no picture of `glint render` has it, the
// window may ask for it.
#define GLINT_MODES(X)    \
    X(64, AOVS, aovs)     \
    X(65, COST, cost)     \
    X(66, RESUME, resume) \
    X(67, SHADOWLESS, shadowless)

// X(binding, C++ field, GLSL struct or none). Binding 0 is the counters, 1 the path state.
#define GLINT_SCENE_ARRAYS(X)               \
    X(2, nodes, Node)                       \
    X(3, triangles, Triangle)               \
    X(4, triangleSurfaces, TriangleSurface) \
    X(5, vertexNormals, VertexNormals)      \
    X(6, spheres, Sphere)                   \
    X(7, planes, Plane)                     \
    X(8, materials, Material)               \
    X(9, lights, Light)                     \
    X(10, environment, Environment)         \
    X(11, camera, Camera)                   \
    X(12, discs, Disc)                      \
    X(13, polygons, Polygon)                \
    X(14, polygonVertices, PolygonVertex)   \
    X(22, packetCorners, PacketCorner)

#define GLINT_BINDING_COUNT 24

// One dispatch covers `groups` tiles of a slice, one workgroup each. Workgroup w works on tile
// firstTile + (w mod run) * interleave + w / run, with run = groups / interleave: llvmpipe gives each of its
// threads an equal contiguous part of the workgroups, which interleaving spreads over the picture. region:
// the pixels wanted, tiles are numbered by rows of ceil(regionWidth / 8). capacity: paths in one row of the
// state. tripBudget: loop trips after which a ray is left unfinished for a resume dispatch.
#define GLINT_DISPATCH_ROWS(V3F, V3U, U4)           \
    U4(firstTile, tileCount, interleave, run)       \
    U4(regionX, regionY, regionWidth, regionHeight) \
    U4(capacity, tripBudget, lightIndex, bounce)    \
    V3U(sampleOffset, sampleIndex)

#ifdef __cplusplus
namespace glint::shared {
struct alignas(16) Dispatch {
    GLINT_DISPATCH_ROWS(GLINT_CPP_V3F, GLINT_CPP_V3U, GLINT_CPP_U4)
};
static_assert(sizeof(Dispatch) <= 128, "Vulkan guarantees 128 bytes of push constants");
#endif

// The path state is an array of rows of 16 bytes, row r of path p at r * capacity + p.
GLINT_CONST_UINT(kRowOrigin, 0u);      // origin.xyz, primitive the ray starts on (or kNone)
GLINT_CONST_UINT(kRowDirection, 1u);   // direction.xyz, tMin (kInfinity: the path has ended)
GLINT_CONST_UINT(kRowHit, 2u);         // t, u, v, primitive of the best hit; tMax, 0, 0, kNone before any
GLINT_CONST_UINT(kRowThroughput, 3u);  // rgb, path hash
GLINT_CONST_UINT(kRowRadiance, 4u);    // rgb, number of samples that hit anything; summed over samples
GLINT_CONST_UINT(
    kRowWalk,
    5u);  // slot where an unfinished ray goes on (kNone: finished), id of the best hit, cost, shadow bits
GLINT_CONST_UINT(kPathRows, 6u);
GLINT_CONST_UINT(kRowAovPosition, 6u);   // position.xyz (local), depth
GLINT_CONST_UINT(kRowAovNormal, 7u);     // outward shading normal, material
GLINT_CONST_UINT(kRowAovIndices, 8u);    // u, v, object, primitive
GLINT_CONST_UINT(kRowAovCounts, 9u);     // bounces, cost, shadow bits, path hash
GLINT_CONST_UINT(kRowAovGeometry, 10u);  // outward geometric normal, 0
GLINT_CONST_UINT(kPathRowsWithAovs, 11u);

GLINT_CONST_UINT(kCounterUnfinished, 0u);  // rays that ran out of trips in this submission
GLINT_CONST_UINT(kCounterAlive, 1u);       // paths that go on after shading
GLINT_CONST_UINT(kCounterCount, 4u);

#ifdef __cplusplus
}  // namespace glint::shared
#endif

#endif
