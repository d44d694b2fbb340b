// Rays with known hits, by hand, from textbooks or from other projects' tests (TRTC: J. Buck, The Ray Tracer
// Challenge), on the device and in the reference.
#include <cmath>

#include "support.h"

namespace glint::render::test::analytic_test {
using glm::dvec3;
using glm::vec3;

constexpr float kUnit = 0x1p-24f;

class AnalyticTest : public RenderTest {
  protected:
    static Scene unitTriangle() { return sceneOf(TriangleShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}); }
};

// ---- published hits ----

constexpr double kMiss = -1;

// A ray, its hit after tMin, and the error that the device may make.
struct KnownHit {
    dvec3 origin, direction;
    double t, tolerance = 0;
    float tMin = 0;
};

struct KnownHits {
    const char* source;
    Shape shape;
    std::vector<KnownHit> hits;
};

const dvec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1), kSlanted = glm::normalize(dvec3(-0.5, -1, 1));
const double kRoot3 = std::sqrt(3.0), kNearOne = 0.99999994;
const std::vector<KnownHits> kKnownHits = {
    {"embree, issue 298: a ray in a triangle's plane; tilted out of it by 1e-7",
     TriangleShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
     {{{-1, 0.5, 0}, kX, kMiss},
      {{-1, 0, 0}, kX, kMiss},          // along an edge
      {{2, -1, 0}, {-1, 1, 0}, kMiss},  // along the long edge
      {{0.25, 0.25, 0}, {1, 2, 0}, kMiss},
      {{-1, 0.25, 1.25e-7}, {1, 0, -1e-7}, 1.25, 1.25e-5}}},
    {"the corner of a cube's side",
     TriangleShape{{dvec3(1), {-1, 1, 1}, {1, -1, 1}}},
     {{dvec3(10), dvec3(-1), 9}}},
    {"in the plane of a tilted triangle, towards its centroid",
     TriangleShape{{kX, kY, kZ}},
     {{{2, -1, 0}, {-2.5, 2, 0.5}, kMiss}}},
    {"TRTC, features/spheres.feature; Shirley and Marschner's diagonal; tangents; t = 0 is excluded",
     SphereShape{dvec3(0), 1},
     {{{0, 0, -5}, kZ, 4},
      {{0, 0, -5}, kZ, 6, 0, 5},
      {{0, 1, -5}, kZ, 5},
      {{0, 1, -5}, kZ, kMiss, 0, 5},
      {{0, 2, -5}, kZ, kMiss},
      {{0, 0, 0}, kZ, 1},
      {{0, 0, 5}, kZ, kMiss},
      {dvec3(1), dvec3(-1), 1 - 1 / kRoot3, 4 * kUnit},
      {dvec3(1), dvec3(-1), 1 + 1 / kRoot3, 4 * kUnit * 1.6, 1},
      {{kNearOne, 0, -10}, kZ, 10 - std::sqrt(1 - kNearOne * kNearOne), 4 * kUnit * 10},
      {{1, 0, -10}, kZ, 10},
      {{1.0000001, 0, -10}, kZ, kMiss},
      {{0, 0, 0.5}, kZ, 0.5},
      {{0, 0, 0.5}, -kZ, 1.5},
      {{0, 0, 1}, kZ, kMiss},
      {{0, 0, 1}, -kZ, 2}}},
    {"TRTC", SphereShape{dvec3(0), 2}, {{{0, 0, -5}, kZ, 3}, {{0, 0, -5}, kZ, 7, 0, 5}}},
    {"TRTC", SphereShape{{5, 0, 0}, 1}, {{{0, 0, -5}, kZ, kMiss}}},
    {"parallel to a plane, in it, at t = 0, behind, from below",
     PlaneShape{dvec3(0), kY},
     {{kY, kX, kMiss},
      {kY, {1, -0.0, 0}, kMiss},
      {{0, 0, 0}, kX, kMiss},
      {{0, 0, 0}, {1, -1, 0}, kMiss},
      {kY, {1, 1, 0}, kMiss},
      {-kY, {1, 1, 0}, 1}}},
    // Parallel to a ruling the book has 0.35355, which divides by 2 b for b: (0, 0.25, -0.75) is not on
    // the cone.
    {"TRTC, chapter 13: through the apex, two hits, parallel to a ruling",
     generalQuadric({1, -1, 1, 0, 0, 0, 0, 0, 0, 0}, 64),
     {{{0, 0, -5}, kZ, 5},
      {{1, 1, -5}, kSlanted, 4.55006, 1e-5},
      {{1, 1, -5}, kSlanted, 49.44994, 1e-4, 5},
      {-kZ, glm::normalize(kY + kZ), std::sqrt(0.5), 1e-6}}},
    {"along an asymptote",
     generalQuadric({1, 1, -1, 0, 0, 0, 0, 0, 0, -1}, 0x1p25),
     {{{-2, 0, 0}, {1, 0, 1}, 0.75},
      {{-2, 0, 0}, {1, 0, 1 + 0x1p-23}, 0.749999966, 2e-7},
      {{-2, 0, 0}, {-1, 0, -1 - 0x1p-23}, 16777215.75, 8},
      {{-2, 0, 0}, {1, 0, 1.001}, 0.749718807, 2e-7}}},
    {"parabolic cylinder",
     generalQuadric({1, 0, 0, 0, 0, 0, 0, 0, -1, 0}, 16),
     {{{0.5, 3, 10}, -kZ, 9.75}, {{0, 0, 4}, {1, 0, -1}, 1.5615528128088303, 4e-7}}},
    {"double plane, and in it",
     generalQuadric({1, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 8),
     {{{-5, 0, 0}, kX, 5}, {{0, -20, 0}, kY, kMiss}}},
    {"no quadratic part", generalQuadric({0, 0, 0, 0, 0, 0, 0, 2, 0, -2}, 8), {{{0, 5, 0}, -kY, 4}}},
    {"no real point", generalQuadric({1, 1, 1, 0, 0, 0, 0, 0, 0, 1}, 8), {{{0, 0, 20}, -kZ, kMiss}}},
    {"two planes, x = y and x = -y",
     generalQuadric({1, -1, 0, 0, 0, 0, 0, 0, 0, 0}, 8),
     {{{-5, 2, 0}, kX, 3}, {{-5, 2, 0}, kX, 7, 0, 4}}},
    {"along the axis of an open cylinder",
     CylinderShape{{0, 0, -8}, {0, 0, 0x1p20}, 1, false},
     {{{0.5, 0, -20}, kZ, kMiss}, {{0, 0, 0}, {1e-6, 0, 1}, 1e6, 1}}},
    {"along the axis of a capped one",
     CylinderShape{{0, 0, -8}, {0, 0, 8}, 1, true},
     {{{0.5, 0, -20}, kZ, 12},
      {{0.5, 0, -20}, kZ, 28, 0, 20},
      {{0.5, 0, 0}, kZ, 8},
      {{1.5, 0, -20}, kZ, kMiss}}}};

TEST_F(AnalyticTest, KnownHits) {
    for (const auto& [source, shape, hits] : kKnownHits) {
        SCOPED_TRACE(source);
        const PackedScene packed = packScene(sceneOf(shape));
        ASSERT_EQ(packed.origin, dvec3(0));
        std::vector<RayInput> rays;
        for (const KnownHit& known : hits) {
            rays.push_back(rayOf(vec3(known.origin), vec3(known.direction)));
            rays.back().tMin = known.tMin;
        }
        const std::vector<RayHit> found = hitsOfBoth(packed, rays);
        for (size_t i = 0; i < hits.size(); ++i)
            EXPECT_NEAR(found[i].hit ? found[i].t : kMiss, hits[i].t, hits[i].tolerance) << text(rays[i]);
    }
}

// Along the mirror image of a ruling the line touches the cone: the double root errs by the square root of
// rounding (TRTC).
TEST_F(AnalyticTest, TangentOfACone) {
    const PackedScene packed = packScene(sceneOf(generalQuadric({1, -1, 1, 0, 0, 0, 0, 0, 0, 0}, 64)));
    EXPECT_NEAR(hitsOf(packed, {rayOf({0, 0, -5}, glm::normalize(vec3(1)))})[0].t, 8.66025, 1e-2);
}

TEST_F(AnalyticTest, NormalOfADoublePlaneIsAgainstTheRay) {
    const Scene scene = sceneOf(generalQuadric({1, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 8));
    EXPECT_EQ(hitOf(scene, rayOf({-5, 0, 0}, {2, 0, 0})).data.geometricNormal, vec3(-1, 0, 0));
}

// Packed by hand because packing drops them. The first is pbrt-v4's Triangle.BadCases.
TEST_F(AnalyticTest, TrianglesWithoutAreaAreMissed) {
    SceneMaker bad;
    bad.triangle({-1113.45459f, -79.049614f, -56.2431908f}, {-1113.45459f, -87.0922699f, -56.2431908f},
                 {-1113.45459f, -79.2090149f, -56.2431908f});
    EXPECT_FALSE(hitOf(packedBy(bad), rayOf({-1081.47925f, 99.9999542f, 87.7701111f},
                                            {-32.1072998f, -183.355865f, -144.607635f}))
                     .hit);
    SceneMaker collinear;
    collinear.triangle({0, 0, 0}, {1, 0, 0}, {2, 0, 0});
    EXPECT_FALSE(hitOf(packedBy(collinear), rayOf({.5f, 0, -1}, {0, 0, 1})).hit);
    SceneMaker point;
    point.triangle({1, 2, 3}, {1, 2, 3}, {1, 2, 3});
    EXPECT_FALSE(hitOf(packedBy(point), rayOf({0, 0, 0}, {1, 2, 3})).hit);
}

// Rays along the sides of the triangle's box, in its edges, which belong to it: the distance to the side is 0
// and the inverse direction infinite, of either sign.
TEST_F(AnalyticTest, ZerosOfEitherSignMeetTheSidesOfABox) {
    for (const float zeroX : {0.0f, -0.0f}) {
        for (const float zeroY : {0.0f, -0.0f}) {
            for (const float z : {-1.0f, 1.0f}) {
                const vec3 d(zeroX, zeroY, -z);
                for (const glm::vec2 p :
                     {glm::vec2(0, .5f), {.5f, 0}, {0, 0}, {1, 0}, {0, 1}, {.25f, .25f}}) {
                    const RayHit hit = hitOf(unitTriangle(), rayOf({p, z}, d));
                    EXPECT_TRUE(hit.hit && hit.t == 1) << text(rayOf({p, z}, d));
                }
            }
        }
    }
}

TEST_F(AnalyticTest, DistantHorizon) {
    Scene scene = emptyScene();
    aim(scene.camera, {0, 1, 0}, {0, 1, -1});
    addPlane(scene, {0, 0, 0}, {0, 1, 0});
    const RayHit hit = hitOf(scene, rayOf({0, 1, 0}, {1, -1e-7f, 0}));
    ASSERT_TRUE(hit.hit);
    const double t = 1 / static_cast<double>(1e-7f);  // 9999999.883
    EXPECT_NEAR(hit.t, t, 4 * kUnit * t);
    EXPECT_EQ(hit.data.geometricNormal, vec3(0, 1, 0));
    EXPECT_NEAR(hit.data.position.y, 0, 1);  // x has an ulp of 1
}

TEST_F(AnalyticTest, RimSidesAndEdgeOfADisc) {
    const Scene scene = sceneOf(DiscShape{{0, 0, 0}, {0, 0, 3}, 5});
    const std::vector<RayInput> hit = {rayOf({0, 0, 2}, {0, 0, -1}), rayOf({3, 4, 2}, {0, 0, -1}),
                                       rayOf({-5, 0, 2}, {0, 0, -1}), rayOf({3, -4, -2}, {0, 0, 1})};
    const std::vector<RayInput> missed = {rayOf({3, std::nextafter(4.0f, 5.0f), 2}, {0, 0, -1}),
                                          rayOf({-9, 0, 0}, {1, 0, 0}),  // in its plane
                                          rayOf({1, 1, 0}, {0, 0, 1}),   // t = 0
                                          rayOf({1, 1, 1}, {0, 0, 1})};  // behind
    const PackedScene packed = packScene(scene);
    for (const RayHit& h : hitsOfBoth(packed, hit)) {
        ASSERT_TRUE(h.hit);
        EXPECT_EQ(h.t, 2);
        EXPECT_EQ(h.data.geometricNormal, vec3(0, 0, 1));
        EXPECT_EQ(h.data.u, 0);
    }
    EXPECT_EQ(missesOf(packed, missed), missed.size());
}

// ---- intervals, ties, invalid rays ----

// Surfaces that the ray (x, y, 4) + t (0, 0, -1) hits at exactly t = 4, without rounding.
std::vector<void (*)(Scene&)> surfacesAtFour() {
    return {[](Scene& s) {
                addTriangle(s, {-2, -2, 0}, {2, -2, 0}, {0, 2, 0});
            },
            [](Scene& s) {
                addSphere(s, {0, 0, -1}, 1);
            },
            [](Scene& s) {
                addPlane(s, {0, 0, 0}, {0, 0, 1});
            },
            [](Scene& s) {
                addDisc(s, {1, 0, 0}, {0, 0, 1}, 2);
            },
            [](Scene& s) {
                addPolygon(s, {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}, {-1, 0, 0}});
            }};
}

TEST_F(AnalyticTest, IntervalIsOpenBelowAndClosedAbove) {
    for (const auto add : surfacesAtFour()) {
        Scene scene = emptyScene();
        add(scene);
        const bool sphere = std::holds_alternative<SphereShape>(scene.objects[0].shape);
        const PackedScene packed = packScene(scene);
        const auto hitIn = [&](float tMin, float tMax) {
            RayInput ray = rayOf({0, 0, 4}, {0, 0, -1});
            ray.tMin = tMin;
            ray.tMax = tMax;
            const RayHit hit = hitOf(packed, ray);
            return hit.hit ? hit.t : 0.0f;
        };
        const float below = std::nextafter(4.0f, 0.0f);
        EXPECT_EQ(hitIn(0, shared::kInfinity), 4);
        EXPECT_EQ(hitIn(0, 4), 4);
        EXPECT_EQ(hitIn(0, below), 0);
        EXPECT_EQ(hitIn(below, 4), 4);
        EXPECT_EQ(hitIn(4, 5), 0);
        EXPECT_EQ(hitIn(4, 10), sphere ? 6 : 0);  // its far side
        EXPECT_EQ(hitIn(6, 10), 0);
        EXPECT_EQ(hitIn(5, 3), 0);  // empty
    }
}

TEST_F(AnalyticTest, EqualTGoesToTheFirstObject) {
    const auto surfaces = surfacesAtFour();
    std::vector<size_t> order = {0, 1, 2, 3, 4};
    do {
        Scene scene = emptyScene();
        for (const size_t i : order) surfaces[i](scene);
        const RayHit hit = hitOf(scene, rayOf({0, 0, 4}, {0, 0, -1}));
        EXPECT_EQ(hit.t, 4);
        EXPECT_EQ(hit.data.object, 0u) << order[0] << order[1] << order[2] << order[3] << order[4];
    } while (std::next_permutation(order.begin(), order.end()));
    for (const auto add : surfaces) {
        Scene scene = emptyScene();
        for (int i = 0; i < 9; ++i) add(scene);
        EXPECT_EQ(hitOf(scene, rayOf({0, 0, 4}, {0, 0, -1})).data.object, 0u);
    }
}

TEST_F(AnalyticTest, RaysThatAreNoneMiss) {
    Scene scene = emptyScene();
    for (const auto add : surfacesAtFour()) add(scene);
    addSphere(scene, {0, 0, 0}, 100);  // around everything
    const float nan = std::numeric_limits<float>::quiet_NaN(),
                infinity = std::numeric_limits<float>::infinity();
    std::vector<RayInput> rays = {rayOf({0, 0, 4}, {0, 0, 0}), rayOf({0, 0, 4}, {0, -0.0f, 0})};
    for (const float value : {nan, -nan, infinity, -infinity}) {
        for (int i = 0; i < 3; ++i) {
            rays.push_back(rayOf({0, 0, 4}, {0, 0, -1}));
            rays.back().origin[i] = value;
            rays.push_back(rayOf({0, 0, 4}, {0, 0, -1}));
            rays.back().direction[i] = value;
        }
        rays.push_back(rayOf(vec3(value), vec3(value)));
    }
    const PackedScene packed = packScene(scene);
    EXPECT_EQ(missesOf(packed, rays), rays.size());
    ASSERT_TRUE(hitOf(packed, rayOf({0, 0, 4}, {0, 0, -1})).hit);
}

// ---- sizes, distances and lengths of directions from one end of the supported range to the other ----
// (import/load.h: coordinates below 1e18)

class RangeTest : public RenderTest {
  protected:
    // A triangle and a sphere of this size and a plane that rays down the z axis hit at z = 0.
    static std::vector<Scene> surfaces(double size) {
        std::vector<Scene> scenes(3, emptyScene());
        addTriangle(scenes[0], {-size, -size, 0}, {size, -size, 0}, {0, size, 0});
        addSphere(scenes[1], {0, 0, -size}, size);
        addPlane(scenes[2], {0, 0, 0}, {0, 0, 1});
        for (Scene& scene : scenes) aim(scene.camera, {0, 0, 3 * size}, {0, 0, 0});
        return scenes;
    }
};

TEST_F(RangeTest, ScenesOfAnySizeAndDirectionsOfAnyLength) {
    const auto expectHit = [](double size, double length) {
        for (const Scene& scene : surfaces(size)) {
            const vec3 direction(0, 0, -length);
            const RayHit hit = hitOf(scene, rayOf(vec3(0, 0, 3 * size), direction));
            EXPECT_NEAR(hit.hit ? hit.t * -double{direction.z} / size : 0, 3, 8 * kUnit * 3)
                << scene.objects[0].shape.index() << " " << size << " " << length;
        }
    };
    for (const double length : {1e-15, 1e-9, 1e-6, 1e-3, 0.1, 1.0, 1e3, 1e6, 1e9, 1e15}) expectHit(1, length);
    for (const double size : {1e-12, 1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9, 1e12, 1e15, 3e17}) expectHit(size, 1);
    // As shadow rays towards a point light.
    for (const double size : {1e-13, 1e-12, 1e-9, 1e9, 1e12, 1e15, 3e17}) expectHit(size, size);
}

// Scaling scene and origin by a power of two changes only the exponent of t.
TEST_F(RangeTest, PowersOfTwoChangeNoDigit) {
    const PackedScene unit = packScene(surfaces(1)[0]);
    Random random(21);
    std::vector<RayInput> rays;
    for (int i = 0; i < 2000; ++i)
        rays.push_back(rayTowards(random.box(2) + dvec3(0, 0, 3),
                                  {random.uniform(-1, 1), random.uniform(-1, 1), 0}, true));
    const std::vector<RayHit> expected = hitsOf(unit, rays);
    EXPECT_GT(rays.size() - misses(expected), 500u);
    for (const int exponent : {-30, -20, -10, -1, 1, 10, 20, 30}) {
        const float scale = std::ldexp(1.0f, exponent);
        const PackedScene packed = packScene(surfaces(scale)[0]);
        std::vector<RayInput> scaled = rays;
        for (RayInput& ray : scaled) ray.origin *= scale;
        const std::vector<RayHit> hits = hitsOf(packed, scaled);
        for (size_t i = 0; i < rays.size(); ++i) {
            ASSERT_EQ(hits[i].hit, expected[i].hit) << exponent << ": " << text(scaled[i]);
            if (!hits[i].hit) continue;
            ASSERT_EQ(hits[i].t, expected[i].t * scale) << exponent;
            ASSERT_EQ(hits[i].data.u, expected[i].data.u) << exponent;
            ASSERT_EQ(hits[i].data.v, expected[i].data.v) << exponent;
        }
    }
}

// A bead of a thousandth and a triangle of a million in one scene.
TEST_F(RangeTest, GreatAndSmallTogether) {
    Scene scene = emptyScene();
    addTriangle(scene, {-1e6, -1e6, -1}, {1e6, -1e6, -1}, {0, 1e6, -1});
    addTriangle(scene, {-1e-3, -1e-3, 0}, {1e-3, -1e-3, 0}, {0, 1e-3, 0});
    const RayHit bead = hitOf(scene, rayOf({0, 0, 3}, {0, 0, -1}));
    EXPECT_EQ(bead.data.object, 1u);
    EXPECT_NEAR(bead.t, 3, 8 * kUnit * 3);
    const RayHit ground = hitOf(scene, rayOf({1, 0, 3}, {0, 0, -1}));
    EXPECT_EQ(ground.data.object, 0u);
    EXPECT_NEAR(ground.t, 4, 8 * kUnit * 4);
    // The far side of deep ground does not blur its top.
    Scene cube = emptyScene();
    addObject(cube, BoxShape{{-1e6, -1e6, -1e6}, {1e6, 0, 1e6}});
    addObject(cube, BoxShape{{-0.5, 0, -0.5}, {0.5, 1, 0.5}});
    aim(cube.camera, {0, 1.5, 5}, {0, 0.05, 0.5});
    EXPECT_EQ(draw(device(), makeCase(cube, 1, 1)).data.at(0).object, 1u);
    // From the weights of its corners a point of this triangle would err by 1e-2.
    Scene floor = emptyScene();
    addTriangle(floor, {-1e5, 0, -7e4}, {1e5, 0, 8e4}, {9e4, 0, -1e5});
    aim(floor.camera, {0, 1.5, 5}, {0.3, 0, 1});
    const dvec3 point = draw(device(), makeCase(floor, 1, 1)).data.at(0).position;
    EXPECT_NEAR(glm::distance(point, dvec3(0.3, 0, 1)), 0, 1e-5);
}

}  // namespace glint::render::test::analytic_test
