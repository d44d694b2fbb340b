// Colours with closed forms, and paths with known hashes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/packed_scene_maker.h"
#include "support/support.h"

namespace glint::reference::test::shading_test {

using namespace glint::test;

using glm::dvec3;
using glm::vec3;
using shared::kLightDirectional;
using shared::kLightFades;
using shared::kLightPoint;

PixelRecord traceScene(const SceneMaker& maker, const Ray& ray, bool keepPath = false) {
    return SceneTracer(maker).trace(ray, {}, keepPath);
}

const Ray kDown = makeRay({0, 3, 0}, {0, -1, 0});

// J. Buck, The Ray Tracer Challenge, features/world.feature, "The color when a ray hits"; there is no visible
// highlight, so Blinn's and Phong's agree (N.H^200 = 3.7e-12 here).
TEST(ReferenceShading, RayTracerChallengeDefaultWorld) {
    SceneMaker maker;
    const vec3 color(0.8f, 1.0f, 0.6f);
    const uint32_t outer = maker.material(.7f * color, vec3(.2f), 200, vec3(0), .1f * color);
    maker.sphere(vec3(0), 1, outer);
    maker.sphere(vec3(0), .5f);
    maker.light(kLightPoint, {-10, 10, -10});
    maker.environment.ambient = vec3(1);
    const PixelRecord record = traceScene(maker, makeRay({0, 0, -5}, {0, 0, 1}));
    expectNear(record.color, {0.38066, 0.47583, 0.2855}, 5e-6);
    EXPECT_EQ(record.alpha, 1);
    EXPECT_EQ(record.shadowBits, 0u);
}

// Lambert: kd I cos; with inverse square falloff over the distance squared. 3-4-5: cos = 4/5 at distance 5.
TEST(ReferenceShading, LambertAndFalloff) {
    for (const uint32_t kind : {kLightPoint, kLightPoint | kLightFades}) {
        SceneMaker maker;
        const uint32_t grey = maker.material({.5f, .25f, 1});
        maker.plane(vec3(0), {0, 1, 0}, grey);
        maker.light(kind, {3, 4, 0}, {2, 4, 8});
        const double falloff = kind == kLightPoint ? 1 : 25;
        expectNear(traceScene(maker, kDown).color, dvec3(.8, .8, 6.4) / falloff, 1e-15);
    }
    SceneMaker maker;
    maker.plane(vec3(0), {0, 1, 0});
    maker.light(kLightDirectional, {.6f, .8f, 0}, vec3(3));
    expectNear(traceScene(maker, kDown).color, dvec3(3.0 * static_cast<double>(.8f)), 1e-7);
    EXPECT_EQ(traceScene(maker, makeRay({0, -3, 0}, {0, 1, 0})).color, dvec3(0))
        << "seen from the unlit side";
}

// Rounding decides whether a light at kLeastCosine counts. Both paths must allow for all of its diffuse
// light.
TEST(ReferenceShading, TheStepAtTheLeastCosineLiesWithinTheRounding) {
    const auto record = [](float change) {
        SceneMaker maker;
        maker.plane(vec3(0), {0, 1, 0});
        maker.light(kLightDirectional, {1, shared::kLeastCosine * change, 0}, vec3(1000));
        return traceScene(maker, kDown);
    };
    const PixelRecord dark = record(0.999f), lit = record(1.001f);
    EXPECT_EQ(dark.color.x, 0);
    EXPECT_NEAR(lit.color.x, 1000.0 * static_cast<double>(shared::kLeastCosine), 1e-5);
    EXPECT_GE(dark.rounding.x, lit.color.x);
    EXPECT_GE(lit.rounding.x, lit.color.x);
}

// View and light 45 degrees apart, the light along the normal: n.h = cos(pi/8), squared (2 + sqrt 2) / 4.
TEST(ReferenceShading, HighlightByHand) {
    SceneMaker maker;
    const uint32_t shiny = maker.material(vec3(0), {1, .5f, 0}, 2);
    maker.plane(vec3(0), {0, 1, 0}, shiny);
    maker.light(kLightDirectional, {0, 1, 0});
    const double square = (2 + std::sqrt(2.0)) / 4;
    expectNear(traceScene(maker, makeRay({-2, 2, 0}, {1, -1, 0})).color, {square, square / 2, 0}, 1e-15);
}

// At the mirror angle n.h = 1 whatever the exponent; an exponent of 0 is 1 everywhere the light falls.
TEST(ReferenceShading, HighlightExtremes) {
    for (const float exponent : {0.0f, 1.0f, 1e4f}) {
        SceneMaker maker;
        const uint32_t shiny = maker.material(vec3(0), vec3(.5f), exponent);
        maker.plane(vec3(0), {0, 1, 0}, shiny);
        maker.light(kLightPoint, {2, 2, 0});
        expectNear(traceScene(maker, makeRay({-2, 2, 0}, {1, -1, 0})).color, dvec3(.5), 1e-11);
        if (exponent == 0) {
            expectNear(traceScene(maker, makeRay({-9, 1, 3}, {9, -1, -3})).color, dvec3(.5), 1e-15);
        }
    }
}

// Seen from behind a tilted shading normal: s.l > 0 but s.(l + v) < 0, so that no power is taken.
TEST(ReferenceShading, NoHighlightBehindTheShadingNormal) {
    for (const float exponent : {0.0f, 1.0f, 2.0f}) {
        SceneMaker maker;
        const uint32_t shiny = maker.material(vec3(0), vec3(1), exponent);
        shared::VertexNormals normals;
        normals.n0 = normals.n1 = normals.n2 = {.8f, 0, .6f};
        maker.triangle({-9, -9, 0}, {9, -9, 0}, {0, 9, 0}, normals, shiny);
        maker.light(kLightDirectional, glm::normalize(vec3(-.5f, 0, .8f)));
        EXPECT_EQ(traceScene(maker, makeRay({-1, 0, .1}, {1, 0, -.1})).color, dvec3(0));
    }
}

// A light where the eye is: h = l = v.
TEST(ReferenceShading, LightAtTheEye) {
    SceneMaker maker;
    const uint32_t shiny = maker.material(vec3(0), vec3(1), 7);
    maker.plane(vec3(0), {0, 1, 0}, shiny);
    maker.light(kLightPoint, {0, 3, 0});
    expectNear(traceScene(maker, kDown).color, dvec3(1), 1e-15);
}

TEST(ReferenceShading, LightOnTheSurfaceAddsNothing) {
    SceneMaker maker;
    maker.plane(vec3(0), {0, 1, 0});
    maker.light(kLightPoint | kLightFades, {0, 0, 0});
    EXPECT_EQ(traceScene(maker, kDown).color, dvec3(0));
}

// A light that lies on another surface reaches this one: the shadow ray ends 2^-16 of its way short of it.
TEST(ReferenceShading, LightLyingOnACeilingIsNotBlockedByIt) {
    SceneMaker maker;
    maker.plane(vec3(0), {0, 1, 0});
    maker.plane({0, 4, 0}, {0, -1, 0});
    maker.light(kLightPoint, {0, 4, 0});
    expectNear(traceScene(maker, kDown).color, dvec3(1), 1e-15);
    SceneMaker blocked;
    blocked.plane(vec3(0), {0, 1, 0});
    blocked.plane({0, 3.999f, 0}, {0, -1, 0});
    blocked.light(kLightPoint, {0, 4, 0});
    const PixelRecord record = traceScene(blocked, kDown);
    EXPECT_EQ(record.color, dvec3(0));
    EXPECT_EQ(record.shadowBits, 1u);
}

// Vertex normals: shading by s, facing by n; against the winding they are turned first.
TEST(ReferenceShading, VertexNormals) {
    for (const float sign : {1.0f, -1.0f}) {
        SceneMaker maker;
        shared::VertexNormals normals;
        normals.n0 = normals.n1 = normals.n2 = sign * vec3(.6f, 0, .8f);
        maker.triangle({-9, -9, 0}, {9, -9, 0}, {0, 9, 0}, normals);   // outward: +z
        maker.light(kLightDirectional, {0, 0, 1});                     // s.l = .8
        maker.light(kLightDirectional, {-.8f, 0, .6f}, vec3(10));      // n.l > 0, s.l = 0 but for rounding
        maker.light(kLightDirectional, {-1, 0, 0}, vec3(100));         // behind s
        maker.light(kLightDirectional, {.96f, 0, -.28f}, vec3(1000));  // before s, behind n
        const double cosine = .8;
        expectNear(traceScene(maker, makeRay({0, 0, 5}, {0, 0, -1})).color, dvec3(cosine), 1e-6);
        const SceneTracer tracer(maker);
        const Ray ray = makeRay({0, 0, -5}, {0, 0, 1});
        const Surface surface = tracer.surfaceAt(ray, *tracer.closest(ray));
        EXPECT_EQ(surface.geometricNormal, dvec3(0, 0, 1)) << "outward also when seen from behind";
        expectNear(surface.shadingNormal, {.6, 0, .8}, 1e-7);
    }
}

// Different normals at the vertices: weights (1-u-v), u, v. At an edge's middle the sum is along z.
TEST(ReferenceShading, VertexNormalsInterpolate) {
    SceneMaker maker;
    shared::VertexNormals normals;
    normals.n0 = {.6f, 0, .8f};
    normals.n1 = {-.6f, 0, .8f};
    normals.n2 = {0, .6f, .8f};
    maker.triangle({0, 0, 0}, {4, 0, 0}, {0, 4, 0}, normals);
    const SceneTracer tracer(maker);
    const auto normalAt = [&](double x, double y) {
        const Ray ray = makeRay({x, y, 5}, {0, 0, -1});
        return tracer.surfaceAt(ray, *tracer.closest(ray)).shadingNormal;
    };
    expectNear(normalAt(2, 0), {0, 0, 1}, 1e-15);
    expectNear(normalAt(0, 4), {0, .6, .8}, 1e-7);
    expectNear(normalAt(2, 2), glm::normalize(dvec3(-.3, .3, .8)), 1e-7);
}

// Between two mirrors of reflectance 1/2, each adding 1: the geometric series 2 - 2^-N, and N + 1 hits.
TEST(ReferenceMirror, CorridorIsAGeometricSeries) {
    for (const uint32_t depth : {0u, 1u, 5u, 20u}) {
        SceneMaker maker;
        const uint32_t mirror = maker.material(vec3(0), vec3(0), 1, vec3(.5f), vec3(1));
        maker.plane(vec3(0), {0, 0, 1}, mirror);
        maker.plane({0, 0, 1}, {0, 0, -1}, mirror);
        maker.environment.ambient = {1, 2, 4};
        maker.environment.background = vec3(100);
        maker.environment.maxDepth = depth;
        const PixelRecord record = traceScene(maker, makeRay({0, 0, .5}, {0, 0, -1}), true);
        EXPECT_EQ(record.color, (2 - std::ldexp(1.0, -static_cast<int>(depth))) * dvec3(1, 2, 4));
        EXPECT_EQ(record.bounces, depth);
        ASSERT_EQ(record.path.size(), depth + 1);
        for (size_t i = 1; i < record.path.size(); ++i) EXPECT_NEAR(record.path[i].hit->t, 1, 1e-14);
    }
}

// A slanted corridor between two triangles, then the background; where it reflects follows by unfolding.
TEST(ReferenceMirror, SlantedCorridorLeavesWithTheBackground) {
    SceneMaker maker;
    const uint32_t mirror = maker.material(vec3(0), vec3(0), 1, vec3(.5f));
    maker.triangle({0, -1, -1}, {100, -1, -1}, {50, -1, 99}, mirror);
    maker.triangle({0, 1, -1}, {100, 1, -1}, {50, 1, 99}, mirror);
    maker.environment.background = vec3(1);
    maker.environment.maxDepth = 100;
    const PixelRecord record = traceScene(maker, makeRay({90, 0, 0}, {1, 1, 0}), true);
    // z = 0 lies within for |x - 50| <= 49.5: hits at x = 91, 93, 95, 97, 99.
    EXPECT_EQ(record.bounces, 5u);
    expectNear(record.color, dvec3(1.0 / 32), 1e-15);
    // Each start is moved off by 32 x 2^-53 x 100, and the path from it by as much: below 4e-12 in all.
    for (size_t i = 0; i < 5; ++i) {
        const dvec3 p = record.path[i].surface->position;
        expectNear(p, {91.0 + 2.0 * static_cast<double>(i), i % 2 ? -1 : 1, 0}, 4e-12);
    }
}

// Whitted's rule for tilted shading normals: about s, or about n where that would lead below the surface.
TEST(ReferenceMirror, ReflectionBelowTheSurfaceGoesAboutTheGeometricNormal) {
    SceneMaker maker;
    const uint32_t mirror = maker.material(vec3(0), vec3(0), 1, vec3(1));
    shared::VertexNormals normals;
    normals.n0 = normals.n1 = normals.n2 = {.8f, 0, .6f};
    maker.triangle({-9, -9, 0}, {9, -9, 0}, {0, 9, 0}, normals, mirror);
    // Straight down: r = d - 2 (d.s) s = (.96, 0, -.28), below; about n it returns: (0, 0, 1).
    const PixelRecord down = traceScene(maker, makeRay({0, 0, 5}, {0, 0, -1}), true);
    expectNear(down.path[1].ray.direction, {0, 0, 1}, 1e-15);
    // Along (-.8, 0, -.6) = -s: straight back.
    const PixelRecord back = traceScene(maker, makeRay({4, 0, 3}, {-.8, 0, -.6}), true);
    expectNear(back.path[1].ray.direction, {.8, 0, .6}, 1e-7);
}

// FNV-1a test vectors (Noll, Vo, Eastlake, draft-eastlake-fnv, appendix C): "\0" is 0x050c5d1f, "a"
// 0xe40c292c, "fo" 0x6222e842.
TEST(ReferencePathHash, KnownVectors) {
    SceneMaker maker;
    EXPECT_EQ(traceScene(maker, kDown).pathHash, 0x050c5d1fu);
    maker.setNextId('a' - 1);
    maker.plane(vec3(0), {0, 1, 0});
    EXPECT_EQ(traceScene(maker, kDown).pathHash, 0xe40c292cu);
    SceneMaker two;
    const uint32_t mirror = two.material(vec3(0), vec3(0), 1, vec3(1));
    two.setNextId('f' - 1);
    two.plane(vec3(0), {0, 1, 0}, mirror);
    two.setNextId('o' - 1);
    two.sphere({0, 10, 0}, 1);
    EXPECT_EQ(traceScene(two, makeRay({0, 3, 0}, {0, -1, 0})).pathHash, 0x6222e842u);
}

// The cost of a path is that of all its rays: camera ray and shadow ray each test the plane (and the shadow
// ray's source is not spared).
TEST(ReferencePathHash, CostAddsUp) {
    SceneMaker maker;
    maker.plane(vec3(0), {0, 1, 0});
    EXPECT_EQ(traceScene(maker, kDown).cost(), 1u);
    maker.light(kLightDirectional, {0, 1, 0});
    EXPECT_EQ(traceScene(maker, kDown).cost(), 2u);
}

// Spot lights: docs/reference/shading.md, "Spot light".

constexpr double kDegree = std::numbers::pi / 180;
SceneMaker lamp(double angle, double penumbra) {
    SceneMaker maker;
    maker.plane(vec3(0), {0, 1, 0});
    maker.spot({0, 2, 0}, {0, -1, 0}, angle, penumbra);
    return maker;
}

// Outside the cone there is no shadow ray: nothing is tested for it, and nothing is called occluded.
TEST(ReferenceSpot, NoShadowRayOutsideTheCone) {
    SceneMaker maker = lamp(20, 10);
    maker.sphere({0, 1.9f, 0}, .01f);  // blocks the lamp for all of the floor within 6 degrees
    const SceneTracer tracer(maker);
    const auto recordAt = [&](double theta) {
        const dvec3 point(2 * std::tan(theta * kDegree), 0, 0);
        return tracer.trace(rayTowards(point + dvec3(0, .5, 1), point), {}, true);
    };
    EXPECT_EQ(recordAt(1).shadowBits, 1u);
    EXPECT_EQ(recordAt(1).color, dvec3(0));
    const PixelRecord lit = recordAt(25), dark = recordAt(31);
    EXPECT_GT(lit.cost(), dark.cost());
    EXPECT_EQ(dark.color, dvec3(0));
    SceneMaker without;
    without.plane(vec3(0), {0, 1, 0});
    without.sphere({0, 1.9f, 0}, .01f);
    const PackedScene unlit = without.finish();
    const dvec3 point(2 * std::tan(31 * kDegree), 0, 0);
    EXPECT_EQ(dark.cost(), Tracer(unlit).trace(rayTowards(point + dvec3(0, .5, 1), point)).cost());
    // Blocked and outside the cone at once.
    SceneMaker aside;
    aside.plane(vec3(0), {0, 1, 0});
    aside.spot({0, 2, 0}, {1, 0, 0}, 20, 10);
    aside.sphere({0, 1.9f, 0}, .01f);
    const PackedScene turned = aside.finish();
    EXPECT_EQ(Tracer(turned).trace(rayTowards({0, .5, 1}, {0, 0, 0})).shadowBits, 0u);
}

// Rounding decides on the cone's sharp edge on the floor, but not a little aside of it.
TEST(ReferenceSpot, JitterFindsTheEdge) {
    const SceneMaker maker = lamp(45, 0);  // radius 2
    const SceneTracer tracer(maker);
    const auto lit = [&](double x) {
        int count = 0;
        for (uint64_t seed = 1; seed <= 64; ++seed)
            count += tracer.trace(rayTowards({x, 1, 1}, {x, 0, 0}), {seed, 4}).color.x > 0;
        return count;
    };
    EXPECT_EQ(lit(2 - 1e-4), 64);
    EXPECT_EQ(lit(2 + 1e-4), 0);
    const int edge = lit(2);
    EXPECT_GT(edge, 8);
    EXPECT_LT(edge, 56);
}

}  // namespace glint::reference::test::shading_test
