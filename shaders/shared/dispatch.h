// Interface of host and kernels: bindings, specialization constants, push constants, and the rows of the path
// state.
#ifndef GLINT_SHARED_DISPATCH_H
#define GLINT_SHARED_DISPATCH_H

#include "shared/layout.h"

// X(constant id, GLSL name FEATURE_..., C++ field of SceneFeatures)
#define GLINT_FEATURES(X)                                                                                   \
    GLINT_PRIMITIVE_FEATURES(X)                                                                             \
    X(2, ANCHORED_SPHERES, anchoredSpheres)                                                                 \
    X(4, VERTEX_NORMALS, vertexNormals)                                                                     \
    X(5, POINT_LIGHTS, pointLights)                                                                         \
    X(6, DIRECTIONAL_LIGHTS, directionalLights)                                                             \
    X(7, SPECULAR, specular) /* some material has a highlight */                                            \
    X(8, MIRRORS, mirrors)   /* some material reflects, and maxDepth is above 0 */                          \
    X(9, SPOT_LIGHTS, spotLights)                                                                           \
    X(10, PARALLEL_CAMERA, parallelCamera) /* the origin of camera rays moves with the pixel */             \
    X(15, TRANSMISSION, transmission)      /* some material lets light through */                           \
    X(16, COLORED_SHADOWS, coloredShadows) /* dielectrics colour shadows */                                 \
    X(17, ATTENUATION, attenuation)        /* light fades inside some dielectric */                         \
    X(18, TEXTURES, textures)              /* some material has an image */                                 \
    X(19, ENVIRONMENT_MAP, environmentMap)                                                                  \
    X(20, VERTEX_COLORS, vertexColors)                                                                      \
    X(21, UVS, uvs)                        /* some triangles have texture coordinates of their own */       \
    X(22, CHECKERS, checkers)              /* some material has a checker */                                \
    X(24, THIN_LENS, thinLens)             /* the origin of camera rays moves with the sample */            \
    X(31, ALPHA_MASK, alphaMask)           /* some material's image cuts holes */                           \
    X(32, SPLIT_TRIANGLES, splitTriangles) /* some triangles stand in the BVH more than once */             \
    X(40, SLIVERS, slivers)                /* some triangles are long and narrow (src/pack/features.cpp) */ \
    X(41, OPEN_PLANES, openPlanes)         /* some plane has a mask, or is a dielectric */                  \
    X(42, TEXTURED_GLASS, texturedGlass)   /* some material's transmission has a texture */

// X(constant id, GLSL name, C++ field of TraceModes)
#define GLINT_MODES(X)                                                                              \
    X(64, AOVS, aovs)             /* writes the rows kRowAov... */                                  \
    X(65, COST, cost)             /* counts boxes and primitives */                                 \
    X(66, RESUME, resume)         /* continues unfinished rays without a stack */                   \
    X(67, SHADOWLESS, shadowless) /* lights shine through everything; only the window has it */     \
    X(72, LEDGER, ledger)         /* records branches not followed; cuts by minContribution */      \
    X(73, SCATTERED, scattered)   /* samples from their array, not from the push constants */       \
    X(74, ADAPTIVE, adaptive)     /* pixels stop when samples agree (adapt.comp); SCATTERED, too */ \
    X(79, TALLY, tally)           /* counts rays by class; traces Dispatch::rayClass alone */       \
    X(82, GIVEN, given)           /* rays of a caller: no source, no hit; tMax in place of those */ \
    X(76, LEAVES, leaves)         /* given rays start on surfaces, which are not named */           \
    X(75, LIST, list)             /* count.comp also stores where rays cross surfaces */

// Not a mode but the device's: all lanes leave the loops of a traversal together (traversal/lanes.glsl).
#define GLINT_CONVERGENT_ID 83

// X(constant id, GLSL name, C++ field of Methods): whole numbers, by the constants kTriangle..., kSphere...,
// kSlab... and kOffset... below.
#define GLINT_CHOICES(X)          \
    X(70, INTERSECTOR, triangles) \
    X(71, SPHERE_FORM, spheres)   \
    X(77, SLAB_PAD, slabs)        \
    X(78, ORIGIN_OFFSET, offsets)

// X(constant id, GLSL name, C++ field of OwnArithmetic): what the device does not round correctly by
// itself, so that shaders/arithmetic.glsl does.
#define GLINT_ARITHMETIC(X)         \
    X(80, OWN_QUOTIENTS, quotients) \
    X(81, OWN_ROOTS, roots)

// One dispatch covers `groups` tiles of a slice, one workgroup each. Workgroup w works on tile
// firstTile + (w mod run) * interleave + w / run, with run = groups / interleave: llvmpipe gives each of its
// threads an equal contiguous part of the workgroups, which interleaving spreads over the image.
//   region       the pixels wanted, in tiles by rows of ceil(regionWidth / 8)
//   capacity     paths in one row of the state
//   tripBudget   loop trips after which a ray is left unfinished for a resume dispatch
//   tripsOfPass  trips that a pass through the loops around a leaf counts, in scenes with instances
//   lightIndex   the first light of light.comp; lightEnd follows its last
//   threshold    of adapt.comp, where lastOfRound is 1 after the last sample of a round, else 0
//   listed       0, or how many paths the kernels run over: those in list `listRead` (0 or 1). shade.comp
//                writes those that go on to the other list.
//   bounce       rays before those at hand
//   mostFollowed of whole.comp: rays that it follows after the camera's
//   rayClass     with MODE_TALLY, the rays (kRay...) that intersect.comp traces
#define GLINT_DISPATCH_ROWS(V3F, V3U, U4, A)           \
    U4(A, firstTile, tileCount, interleave, run)       \
    U4(A, regionX, regionY, regionWidth, regionHeight) \
    U4(A, capacity, tripBudget, lightIndex, lightEnd)  \
    V3U(A, sampleOffset, sampleIndex)                  \
    V3U(A, threshold, lastOfRound)                     \
    U4(A, listed, listRead, bounce, rayClass)          \
    U4(A, tripsOfPass, mostFollowed, reserved0, reserved1)

// ---- Rows of the path state ----

// The path state is an array of rows of 16 bytes, row r of path p at r * capacity + p.

GLINT_CONST_UINT(kRowOrigin, 0u);      // origin, primitive the ray starts on (or kNone)
GLINT_CONST_UINT(kRowDirection, 1u);   // direction, tMin (kInfinity: the path has ended)
GLINT_CONST_UINT(kRowHit, 2u);         // t, u, v, primitive of the best hit; tMax, 0, 0, kNone before any
GLINT_CONST_UINT(kRowThroughput, 3u);  // rgb, path hash
// rgb, samples that hit anything: an uint, if scattered a float, the sum of their weights; summed over
// samples, if adaptive of the sample at hand
GLINT_CONST_UINT(kRowRadiance, 4u);
// slot where an unfinished ray goes on (kNone: finished), id of the best hit, cost, shadow bits
GLINT_CONST_UINT(kRowWalk, 5u);
// the light of an unfinished shadow ray; of another ray Hit::id, Traversal::nearest, Ray::tMax; 0
GLINT_CONST_UINT(kRowLight, 6u);
GLINT_CONST_UINT(kPathRows, 7u);
GLINT_CONST_UINT(kRowAovPosition, 7u);   // position (local), depth
GLINT_CONST_UINT(kRowAovNormal, 8u);     // outward shading normal, material
GLINT_CONST_UINT(kRowAovIndices, 9u);    // u, v, object, primitive
GLINT_CONST_UINT(kRowAovCounts, 10u);    // bounces, cost, shadow bits, path hash
GLINT_CONST_UINT(kRowAovGeometry, 11u);  // outward geometric normal, how far along it next rays begin
GLINT_CONST_UINT(kPathRowsWithAovs, 12u);
GLINT_CONST_UINT(kRowFilm, 12u);    // rgb, alpha: weighted sums over samples
GLINT_CONST_UINT(kRowMean, 13u);    // mean of the samples so far, unweighted; their number
GLINT_CONST_UINT(kRowSpread, 14u);  // sum of squared differences from that mean; 1: the pixel goes on, else 0
GLINT_CONST_UINT(kPathRowsAdaptive, 15u);

// With instances one more row follows, rowInstance() in storage.glsl: instance of the best hit, instance the
// ray starts on, instance an unfinished ray is in, slot where it goes on in the world's tree; kNone for none.

// Then, with mirrors or transmission, two lists of the paths that go on. Entry i, in the column of path i:
// the path; 0, 0, 0.
GLINT_CONST_UINT(kListRows, 2u);

// Then, with MODE_LEDGER or transmission: sums of what the dropped branches could have added at most: cut,
// beyond the depth limit, without room in the stack; 0
GLINT_CONST_UINT(kTreeRowLost, 0u);
GLINT_CONST_UINT(kTreeRowLostCounts, 1u);  // their numbers; media that found no room in the list
GLINT_CONST_UINT(kLedgerRows, 2u);
// Then, with transmission:
GLINT_CONST_UINT(kTreeRowMedia, 2u);   // the media that the ray is in, oldest first, 0 after the last
GLINT_CONST_UINT(kTreeRowBranch, 3u);  // rays before this one from the eye; branches waiting; kRay... or 0; 0
GLINT_CONST_UINT(kTreeRowShadow, 4u);  // Passage of an unfinished shadow ray: depth, terms
GLINT_CONST_UINT(kTreeRowAround, 5u);  // around; 0
GLINT_CONST_UINT(kTreeRowWaiting, 6u);     // the waiting branches, each with the rows kWaiting...:
GLINT_CONST_UINT(kWaitingOrigin, 0u);      // origin, primitive the ray starts on
GLINT_CONST_UINT(kWaitingDirection, 1u);   // direction, rays before this one | class << kWaitingKindShift
GLINT_CONST_UINT(kWaitingThroughput, 2u);  // rgb, instance the ray starts on
GLINT_CONST_UINT(kWaitingMedia, 3u);       // as in kTreeRowMedia
GLINT_CONST_UINT(kWaitingRows, 4u);
GLINT_CONST_UINT(kWaitingKindShift, 30u);  // a depth is far smaller

// ---- Values of the specialization constants ----

GLINT_CONST_UINT(kTriangleWatertight, 0u);
GLINT_CONST_UINT(kTriangleBarycentric, 1u);
GLINT_CONST_UINT(kTriangleProjection, 2u);
GLINT_CONST_UINT(kTrianglePlanar3d, 3u);
GLINT_CONST_UINT(kSphereRobust, 0u);
GLINT_CONST_UINT(kSphereAlgebraic, 1u);
GLINT_CONST_UINT(kSphereGeometric, 2u);
GLINT_CONST_UINT(kSlabGamma3, 1u);
GLINT_CONST_UINT(kSlabPlain, 2u);
GLINT_CONST_UINT(kOffsetFixed, 1u);
GLINT_CONST_UINT(kOffsetNone, 2u);

// ---- Classes of rays and counters ----

GLINT_CONST_UINT(kRayMirrored, 1u);
GLINT_CONST_UINT(kRayRefracted, 2u);

GLINT_CONST_UINT(kCounterUnfinished, 0u);  // rays that ran out of trips in this submission
GLINT_CONST_UINT(kCounterAlive, 1u);       // paths that go on after shading, which are listed
GLINT_CONST_UINT(kCounterFlagged, 2u);     // pixels that take a further round of samples
GLINT_CONST_UINT(kCounterShadow, 3u);      // with MODE_TALLY: shadow rays
GLINT_CONST_UINT(kCounterRefracted, 4u);   // with MODE_TALLY: refracted rays that come next
GLINT_CONST_UINT(kCounterCount, 8u);

#endif
