// The checks of the stability suite: each runs hard cases on a subject and counts wrong answers. The tests
// run them on the device and on the reference and expect none; mutants_test.cpp runs them on shaders with a
// known defect and expects some.
#pragma once

#include <string>
#include <vector>

#include "../oracle/tally.h"
#include "probe.h"
#include "scene/scene.h"

namespace glint::stability {

constexpr double kUnit = 0x1p-24;

// arithmetic: against the truth on the subject's fp32 inputs. withInputs: against the truth on the doubles
// before rounding, so that it includes the rounding of the inputs.
struct Judged {
    oracle::Tally arithmetic, withInputs;
    size_t wrongEnds = 0;  // device only, see countWrongEnds
    std::string text() const;
};

// ---- single primitives ----

// Triangles of this size, `offset` from the origin on all axes, the third corner `height` sizes above the
// middle of the base (1: random corners). Rays from ten sizes away aim in turn at the inside, at edges and at
// corners.
struct TriangleFamily {
    double size = 1, offset = 0, height = 1;
};
// The band is 64 u (docs/design/numerics.md 3); the reference's is that of its quadruple precision.
Judged judgeTriangles(const Subject& subject, const TriangleFamily& family, size_t count, uint32_t seed);

// Rays that leave a surface beside a triangle `size` long and `width` sizes wide, up to `offset` from the
// origin of coordinates. They start `lift` units of 2^-24 of the coordinates above or below it, at 0.5 to 3
// degrees to its plane, or if `lengthwise` along its longest side, at 1e-5 to 1e-3 of a radian and up to 1e-4
// askew. Counts by exact signs. metBehind: hits of triangles behind the ray; left: those that a ray leaving a
// surface also hits. beyond: triangles ahead by more than twice the bound of the rule for such rays; lost:
// those that it misses.
struct SliverFamily {
    double size = 1, width = 1, offset = 0, lift = 8;
    bool lengthwise = false;
};
struct SliverCount {
    size_t rays = 0, ahead = 0, beyond = 0, metBehind = 0, left = 0, lost = 0;
};
SliverCount judgeSlivers(const Subject& subject, const SliverFamily& family, size_t count, uint32_t seed);

// Shaded hits of slivers from 0.2 to 2 sizes away. worst: the greatest distance between shaded point and
// exact hit, in units of the rounding error there (settled_checks.cpp). slid: hits off by more than eight
// units before settling; outside: points outside the triangle.
struct SettledCount {
    size_t hits = 0, slid = 0, outside = 0, lost = 0;
    double worst = 0;
};
SettledCount judgeSettled(const Subject& subject, const SliverFamily& family, bool exchanged, size_t count,
                          uint32_t seed);
// Counts hits of rays that aim at the line of a sliver's longest side, a twentieth to two of its lengths
// beyond its ends.
size_t countMetBeyondEnds(const Subject& subject, const SliverFamily& family, size_t count, uint32_t seed);
// Spheres of this radius from `distance` radii away, by rays across 1.2 times their disc, or near its rim:
// within 1e-3 on the device, 1e-7 in the reference.
struct SphereFamily {
    double radius = 1, distance = 3, offset = 0;
    bool atLimb = false;
};
// The band is 1e-3 of the squared radius (docs/design/numerics.md 2.4). At the limb, and farther than 8000
// radii away, it is at least 16 u distance / radius: float arithmetic moves o by u distance.
Judged judgeSpheres(const Subject& subject, const SphereFamily& family, size_t count, uint32_t seed);
// A planet of radius 1e6, from `height` above its surface downwards; in the reference half of the rays aim
// within 1e-6 of the horizon.
Judged judgePlanet(const Subject& subject, double height, size_t count, uint32_t seed);

struct FlatFamily {
    double size = 1, offset = 0;
};
Judged judgePlanes(const Subject& subject, const FlatFamily& family, size_t count, uint32_t seed);
Judged judgeDiscs(const Subject& subject, const FlatFamily& family, size_t count, uint32_t seed);
Judged judgePolygons(const Subject& subject, const FlatFamily& family, size_t count, uint32_t seed);

// The packed quadric of an object, from `distance` sizes away, by rays that aim in turn anywhere across it,
// within a thousandth of its silhouette, and at `target` (a cone's apex). beyond: values of t outside their
// bound, derived in quadric_checks.cpp; worst: the greatest share of the bound.
struct QuadricFamily {
    Shape shape;
    glm::dvec3 target{0};
    double size = 1, distance = 3;
};
struct QuadricCount {
    size_t rays = 0, hits = 0, inBand = 0, wrong = 0, beyond = 0, wrongEnds = 0;
    double worst = 0;
};
QuadricCount judgeQuadric(const Subject& subject, const QuadricFamily& family, size_t count, uint32_t seed);

// Device only. Rays from outside, a hundredth of the way above the side of a quadric around the origin in the
// direction `from`, as near to its limb as rounding allows. Counts hits, and hits of the inside.
struct GrazingCount {
    size_t hits = 0, insides = 0;
};
GrazingCount judgeGrazing(const Subject& subject, const Shape& shape, const glm::dvec3& from, size_t count,
                          uint32_t seed);

// Boxes up to `thickness` thick on one axis, rays aimed at their edges. widened: by an ulp on all sides, as
// in src/bvh, so that rays in a side hit.
struct BoxCount {
    size_t rays = 0, hits = 0, falseMisses = 0;
    size_t judgedHits = 0, falseHits = 0;  // of a sample
};
BoxCount judgeBoxes(const Subject& subject, double thickness, double offset, bool widened, size_t count,
                    uint32_t seed);

// ---- whole scenes, device only ----

enum class Mesh { Icosphere, Bumpy };
enum class Aim { Anywhere, Vertices, Edges };

// A closed mesh of about this size, its middle this far from the origin on all axes.
struct LeakCase {
    Mesh mesh = Mesh::Icosphere;
    double size = 1, offset = 0;
};
struct LeakCount {
    size_t rays = 0, leaks = 0;  // leaks: rays from the inside that miss, while the exact reference hits
    size_t notInside = 0;        // rays that miss in truth: their origin is not inside
};
// `any`: by the any-hit kernel of shadow rays, which mutants do not change.
LeakCount countLeaks(const Subject& subject, const LeakCase& leakCase, Aim aim, size_t count, uint32_t seed,
                     bool any = false);

struct PixelCount {
    size_t seen = 0, wrong = 0;
};
enum class Kind { Plane, Sphere, Mesh };
// Pixels of a convex object in its own shadow, against the reference's image. moved: packing may move the
// origin to the object.
PixelCount countSelfShadowed(const Subject& subject, Kind kind, double offset, double size, bool moved);
// Other convex bodies: ellipsoid, capped cylinder and cone, disc, polygon, and two placements of one mesh,
// turned and stretched. The camera looks along the light, so no visible point is in shadow. Counts for each
// body the pixels in shadow.
std::vector<PixelCount> countDarkAlongTheLight(const Subject& subject, double offset, double size,
                                               bool moved);
// Lit pixels of a floor under a lid `gap` above it, the floor at this height.
PixelCount countLitUnderLid(const Subject& subject, double height, double gap);

}  // namespace glint::stability
