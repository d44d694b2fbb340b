// The checks of the stability suite: each puts hard cases to a subject and returns what went wrong. The tests
// run them on the device and on the reference and demand nothing wrong; mutants_test.cpp runs the same ones
// on shaders with a known defect and demands that something is.
#pragma once

#include <string>
#include <vector>

#include "../oracle/tally.h"
#include "probe.h"
#include "scene/scene.h"

namespace glint::stability {

constexpr double kUnit = 0x1p-24;

// arithmetic: against the truth on the fp32 numbers that the subject was given. withInputs: against the truth
// on the doubles that these were rounded from, so that the rounding of the inputs is in it as well.
struct Judged {
    oracle::Tally arithmetic, withInputs;
    std::string text() const;
};

// ---- single primitives ----

// Triangles of this size, standing off from the origin on all axes, the third corner `height` sizes above the
// middle of the base (1: corners at random). Rays from ten sizes away aim by turns at the inside, an edge and
// a corner.
struct TriangleFamily {
    double size = 1, offset = 0, height = 1;
};
// Outside the band of 64 u (docs/design/numerics.md 3) no answer may be wrong.
Judged judgeTriangles(const Subject& subject, const TriangleFamily& family, size_t count, uint32_t seed);

// Rays that leave a surface beside a triangle `size` long and `width` sizes wide, up to `offset` from the
// origin of coordinates, at 0.5 to 3 degrees of its plane, or if `lengthwise` along its longest side, at 1e-5
// to 1e-3 of a radian and by up to 1e-4 askew, from `lift` units of 2^-24 of the coordinates
// above it, and from as much below. By exact signs: how many are met by the triangle's test though it lies
// behind, how many of these a ray that leaves a surface counts too, how many lie ahead by more than twice the
// bound of the rule for such rays, and how many of those it does not count.
struct SliverFamily {
    double size = 1, width = 1, offset = 0, lift = 8;
    bool lengthwise = false;
};
struct SliverCount {
    size_t rays = 0, ahead = 0, beyond = 0, metBehind = 0, left = 0, lost = 0;
};
SliverCount judgeSlivers(const Subject& subject, const SliverFamily& family, size_t count, uint32_t seed);

// Rays that meet slivers of a family, from 0.2 to 2 sizes away, as they are shaded: how far their points lie
// from where they meet the plane, in units of what rounding may take there (`worst`; settled_checks.cpp).
// slid: hits that were farther off than eight such units before they were settled; outside: points that are
// not of the triangle.
struct SettledCount {
    size_t hits = 0, slid = 0, outside = 0, lost = 0;
    double worst = 0;
};
SettledCount judgeSettled(const Subject& subject, const SliverFamily& family, bool exchanged, size_t count,
                          uint32_t seed);
// Of rays that aim at the line of a sliver's longest side, a twentieth to two of its lengths beyond its ends,
// how many are found to meet it.
size_t countMetBeyondEnds(const Subject& subject, const SliverFamily& family, size_t count, uint32_t seed);
// Spheres of this radius seen from `distance` radii off, by rays across 1.2 times the disc that they appear
// as, or within a thousandth of its rim.
struct SphereFamily {
    double radius = 1, distance = 3, offset = 0;
    bool atLimb = false;
};
// The band is 1e-3 of the squared radius (docs/design/numerics.md 2.4). At the limb, and farther than 8000
// radii away, it is 16 u distance / radius where that is more: float arithmetic moves o by u distance.
Judged judgeSpheres(const Subject& subject, const SphereFamily& family, size_t count, uint32_t seed);
// A planet of radius 1e6 seen from `height` above its surface, downwards.
Judged judgePlanet(const Subject& subject, double height, size_t count, uint32_t seed);

struct FlatFamily {
    double size = 1, offset = 0;
};
Judged judgePlanes(const Subject& subject, const FlatFamily& family, size_t count, uint32_t seed);
Judged judgeDiscs(const Subject& subject, const FlatFamily& family, size_t count, uint32_t seed);
Judged judgePolygons(const Subject& subject, const FlatFamily& family, size_t count, uint32_t seed);

// The quadric of an object, rounded and clipped as it is packed, seen from `distance` sizes off by rays that
// aim by turns anywhere across it, within a thousandth of its silhouette, and at `target` (a cone's apex).
// beyond: t farther off than its bound, derived in quadric_checks.cpp; worst: the greatest share of the
// bound.
struct QuadricFamily {
    Shape shape;
    glm::dvec3 target{0};
    double size = 1, distance = 3;
};
struct QuadricCount {
    size_t rays = 0, hits = 0, inBand = 0, wrong = 0, beyond = 0;
    double worst = 0;
};
QuadricCount judgeQuadric(const Subject& subject, const QuadricFamily& family, size_t count, uint32_t seed);

// Device only. Rays from outside, a hundredth of the way above the side of a quadric around the origin in the
// direction `from`, as near to its limb as rounding allows: those that meet it, and see its inside.
struct GrazingCount {
    size_t hits = 0, insides = 0;
};
GrazingCount judgeGrazing(const Subject& subject, const Shape& shape, const glm::dvec3& from, size_t count,
                          uint32_t seed);

// Boxes up to `thickness` thick on one axis, rays aimed at their edges. widened: by an ulp on all sides, as
// src/bvh stores them, which also lets rays in that run in a side.
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
// `any`: by the any-hit kernel, which shadow rays use; that of a mutant is sound.
LeakCount countLeaks(const Subject& subject, const LeakCase& leakCase, Aim aim, size_t count, uint32_t seed,
                     bool any = false);

struct PixelCount {
    size_t seen = 0, wrong = 0;
};
enum class Kind { Plane, Sphere, Mesh };
// Pixels of a convex object that are in its own shadow, against the reference's picture. moved: the packing
// may move the origin to the object.
PixelCount countSelfShadowed(const Subject& subject, Kind kind, double offset, double size, bool moved);
// A body of each kind that is convex and none of the above: ellipsoid, capped cylinder and cone, disc,
// polygon, and two placements of one mesh, turned and stretched. Seen along the light, so that nothing that
// is seen lies in shadow: for each the pixels that do.
std::vector<PixelCount> countDarkAlongTheLight(const Subject& subject, double offset, double size,
                                               bool moved);
// Lit pixels of a floor under a lid `gap` above it, the floor at this height.
PixelCount countLitUnderLid(const Subject& subject, double height, double gap);

}  // namespace glint::stability
