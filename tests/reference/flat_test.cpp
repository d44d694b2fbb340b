// Triangles, discs and polygons.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "support/packed_scene_maker.h"

namespace glint::reference::test::flat_test {

using namespace glint::test;

using glm::dvec3;
using glm::vec3;

// Triangles: answers from books, from other projects' tests, and from quadruple precision.

std::optional<Hit> hitTriangle(const vec3& a, const vec3& b, const vec3& c, const Ray& ray) {
    SceneMaker maker;
    maker.triangle(a, b, c);
    return SceneTracer(maker).closest(ray);
}

// Embree's TriangleHit test and others use this one.
std::optional<Hit> hitUnitTriangle(const Ray& ray) {
    return hitTriangle(vec3(0), vec3(1, 0, 0), vec3(0, 1, 0), ray);
}

TEST(ReferenceTriangle, EdgesAndVerticesCount) {
    for (const dvec3 p : {dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(0, 1, 0), dvec3(.5, 0, 0), dvec3(0, .5, 0),
                          dvec3(.5, .5, 0)}) {
        EXPECT_TRUE(hitUnitTriangle(rayTowards({.3, .4, -2}, p)));
        EXPECT_TRUE(hitUnitTriangle(makeRay(p - dvec3(0, 0, 1), {0, 0, 1})));
    }
    EXPECT_FALSE(hitUnitTriangle(makeRay({0x1p-60, -0x1p-60, -1}, {0, 0, 1})));
    EXPECT_FALSE(hitUnitTriangle(makeRay({.5 + 0x1p-50, .5, -1}, {0, 0, 1})));
}

TEST(ReferenceTriangle, IntervalExcludesItsStartAndIncludesItsEnd) {
    Ray ray = makeRay({.25, .25, -1}, {0, 0, 1});
    ray.tMax = 1;
    EXPECT_TRUE(hitUnitTriangle(ray));
    ray.tMax = std::nextafter(1, 0);
    EXPECT_FALSE(hitUnitTriangle(ray));
    ray.tMax = 2;
    ray.tMin = 1;
    EXPECT_FALSE(hitUnitTriangle(ray));
    ray.tMin = std::nextafter(1, 0);
    EXPECT_TRUE(hitUnitTriangle(ray));
    EXPECT_FALSE(hitUnitTriangle(makeRay({.25, .25, 0}, {0, 0, 1}))) << "t = 0 is excluded";
    EXPECT_FALSE(hitUnitTriangle(makeRay({.25, .25, 1}, {0, 0, 1}))) << "behind the origin";
    ray = makeRay({.25, .25, 1}, {0, 0, 1});
    ray.tMin = -5;
    EXPECT_FALSE(hitUnitTriangle(ray)) << "a negative tMin does not reach behind the origin";
}

// Embree issue 298: a ray in the plane misses, along an edge too.
TEST(ReferenceTriangle, RayInPlaneMisses) {
    EXPECT_FALSE(hitUnitTriangle(makeRay({-1, .5, 0}, {1, 0, 0})));
    EXPECT_FALSE(hitUnitTriangle(makeRay({-1, 0, 0}, {1, 0, 0})));
    EXPECT_FALSE(hitUnitTriangle(makeRay({-1, 2, 0}, {1, -1, 0})));
    // Tilted: x + y + z = 1, a direction with d.n = 0, towards the centroid.
    EXPECT_FALSE(hitTriangle({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, makeRay({2, -1, 0}, {-2.5, 2, .5})));
}

// Barely tilted it hits: at x = 0.25 if z falls by 1e-7 per unit and starts at 1.25e-7 above.
TEST(ReferenceTriangle, RayNearlyInPlaneHits) {
    const auto hit = hitUnitTriangle(makeRay({-1, .25, 1.25e-7}, {1, 0, -1e-7}));
    ASSERT_TRUE(hit);
    EXPECT_DOUBLE_EQ(hit->t, 1.25);
}

// pbrt-v4, shapes_test.cpp, Triangle.BadCases; and collinear and coincident vertices.
TEST(ReferenceTriangle, ZeroAreaIsNeverHit) {
    const float x = -1113.45459f, z = -56.2431908f;
    EXPECT_FALSE(
        hitTriangle({x, -79.049614f, z}, {x, -87.0922699f, z}, {x, -79.2090149f, z},
                    makeRay({-1081.47925, 99.9999542, 87.7701111}, {-32.1072998, -183.355865, -144.607635})));
    EXPECT_FALSE(hitTriangle({0, 0, 0}, {1, 0, 0}, {2, 0, 0}, makeRay({.5, 0, -1}, {0, 0, 1})));
    EXPECT_FALSE(hitTriangle(vec3(0), vec3(0), vec3(0), makeRay({0, 0, -1}, {0, 0, 1})));
    EXPECT_FALSE(hitTriangle(vec3(1), vec3(1), vec3(2), makeRay({0, 0, 1}, {1, 1, 0})));
}

// All the scales that fp32 holds.
TEST(ReferenceTriangle, ExtremeScales) {
    for (const float s : {1e-38f, 1e-30f, 1e-15f, 1e18f, 1e30f, 1e38f}) {
        const auto hit =
            hitTriangle({-s, -s, 0}, {s, -s, 0}, {0, s, 0}, makeRay(dvec3(0, 0, -3.0 * s), {0, 0, 1}));
        ASSERT_TRUE(hit) << s;
        EXPECT_DOUBLE_EQ(hit->t, 3.0 * s);
        EXPECT_FALSE(
            hitTriangle({-s, -s, 0}, {s, -s, 0}, {0, s, 0}, makeRay(dvec3(s, s, -3.0 * s), {0, 0, 1})));
    }
}

TEST(ReferenceTriangle, SourceNeverHitsItself) {
    SceneMaker maker;
    maker.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const SceneTracer tracer(maker);
    const Ray ray = makeRay({.25, .25, -1e-9}, {0, 0, 1});
    EXPECT_TRUE(tracer.closest(ray));
    EXPECT_FALSE(tracer.closest(ray, 0));
    EXPECT_FALSE(closestOfAll(tracer, ray, 0));
    EXPECT_TRUE(tracer.occluded(ray));
    EXPECT_FALSE(tracer.occluded(ray, 0));
}

// Straight through a corner of a cube, t = 9; and through points of its edges from many sides.
TEST(ReferenceWatertight, CubeCornersAndEdges) {
    SceneMaker maker;
    maker.cube(vec3(0), 1);
    const SceneTracer tracer(maker);
    for (int corner = 0; corner < 8; ++corner) {
        const dvec3 c(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        const auto hit = tracer.closest(makeRay(10.0 * c, -c));
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->t, 9);
    }
    Random random(19);
    for (int i = 0; i < 20000; ++i) {
        dvec3 at(random.uniform(-1, 1), random.below(2) ? 1 : -1, random.below(2) ? 1 : -1);
        at = i % 3 == 0 ? at : i % 3 == 1 ? dvec3(at.y, at.z, at.x) : dvec3(at.z, at.x, at.y);
        EXPECT_TRUE(tracer.closest(rayTowards(random.box(.9), at))) << "from inside, ray " << i;
    }
}

// Discs by formulas of their own: hits, the rim, sources.

// The closest hit, on which all queries agree.
std::optional<Hit> hitOnly(SceneMaker& maker, const Ray& ray) {
    const SceneTracer tracer(maker);
    const auto hit = tracer.closest(ray);
    EXPECT_EQ(hit, closestOfAll(tracer, ray));
    EXPECT_EQ(hit.has_value(), tracer.occluded(ray));
    return hit;
}

std::optional<Hit> hitDisc(const vec3& center, const vec3& normal, float radius, const Ray& ray) {
    SceneMaker maker;
    maker.disc(center, normal, radius);
    return hitOnly(maker, ray);
}

// A 3-4-5 triangle: (0.6, 0.8) is on the rim, but not as floats; (3, 4) of radius 5 is both.
TEST(ReferenceDisc, TheRimIsAHit) {
    const vec3 up(0, 0, 1);
    for (const dvec3 p : {dvec3(0, 0, 2), dvec3(3, 4, 2), dvec3(-4, 3, 2), dvec3(5, 0, 2)}) {
        const auto hit = hitDisc(vec3(0), up, 5, makeRay(p, {0, 0, -1}));
        ASSERT_TRUE(hit) << p.x;
        EXPECT_EQ(hit->t, 2);
        EXPECT_EQ(hit->u, 0);
    }
    const double outside = std::nextafter(4.0, 5.0);
    EXPECT_FALSE(hitDisc(vec3(0), up, 5, makeRay({3, outside, 2}, {0, 0, -1})));
    EXPECT_TRUE(hitDisc(vec3(0), up, 5, makeRay({3, std::nextafter(4.0, 0.0), 2}, {0, 0, -1})));
    // From afar and aslant: (3, 4, 0) = (3 + 2^20, 4, 2^20) - 2^20 (1, 0, 1).
    EXPECT_TRUE(hitDisc(vec3(0), up, 5, makeRay({3 + 0x1p20, 4, 0x1p20}, {-1, 0, -1})));
    EXPECT_FALSE(hitDisc(vec3(0), up, 5, makeRay({3 + 0x1p20, outside, 0x1p20}, {-1, 0, -1})));
}

TEST(ReferenceDisc, SurfaceAndSource) {
    SceneMaker maker;
    const uint32_t material = maker.material(vec3(0.5));
    maker.disc({0, 0, 0}, {0, 0, 1}, 2, material);
    maker.disc({0, 0, -1}, {0, 0, 1}, 2);
    const SceneTracer tracer(maker);
    const Ray ray = makeRay({1, 0.5, 3}, {0, 0, -1});
    const auto hit = tracer.closest(ray);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->id, 0u);
    const Surface surface = tracer.surfaceAt(ray, *hit);
    EXPECT_EQ(surface.position, dvec3(1, 0.5, 0));
    EXPECT_EQ(surface.geometricNormal, dvec3(0, 0, 1));
    EXPECT_EQ(surface.shadingNormal, dvec3(0, 0, 1));
    EXPECT_EQ(surface.material, material);
    // The ray that starts on a disc never hits it again, however far its start is off.
    const auto next = tracer.closest(ray, hit->primitive);
    ASSERT_TRUE(next);
    EXPECT_EQ(next->id, 1u);
}

// Polygons by formulas of their own: the even-odd rule, edges, planes.

const std::vector<vec3> kL = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
const std::vector<vec3> kDiamond = {{0, 1, 0}, {1, 0, 0}, {2, 1, 0}, {1, 2, 0}};

std::optional<Hit> hitPolygon(const std::vector<vec3>& vertices, const Ray& ray) {
    SceneMaker maker;
    maker.polygon(vertices);
    return hitOnly(maker, ray);
}

// Straight down from z = 5, and from below, from every start of the outline and both ways round.
void expectAt(std::vector<vec3> vertices, double x, double y, bool inside) {
    for (size_t turn = 0; turn < 2 * vertices.size(); ++turn) {
        std::rotate(vertices.begin(), vertices.begin() + 1, vertices.end());
        if (turn == vertices.size()) std::reverse(vertices.begin(), vertices.end());
        const auto above = hitPolygon(vertices, makeRay({x, y, 5}, {0, 0, -1}));
        ASSERT_EQ(above.has_value(), inside) << x << " " << y << " turn " << turn;
        EXPECT_EQ(hitPolygon(vertices, makeRay({x, y, -5}, {0, 0, 2})).has_value(), inside);
        if (above) {
            EXPECT_EQ(above->t, 5);
        }
    }
}

// tests/stability/cases.md T70 and T71: points level with vertices, on either axis.
TEST(ReferencePolygon, LevelWithVertices) {
    expectAt(kL, 1.5, 0.5, true);
    expectAt(kL, 1.5, 1.5, false);
    expectAt(kL, 0.5, 1, true);
    expectAt(kL, 1, 0.5, true);
    expectAt(kL, 3, 1, false);
    expectAt(kL, -1, 1, false);
    expectAt(kL, -1, 2, false);
    expectAt(kL, 1, 3, false);
    expectAt(kDiamond, 1, 1, true);
    expectAt(kDiamond, -1, 1, false);
    expectAt(kDiamond, 3, 1, false);
    expectAt(kDiamond, 1, -1, false);
    expectAt(kDiamond, 1, 3, false);
}

// A pentagram winds twice around its middle; a window is entered and left by the same bridge.
TEST(ReferencePolygon, EvenOdd) {
    std::vector<vec3> star;
    for (int i = 0; i < 5; ++i) {
        const double angle = std::numbers::pi / 2 + 4 * std::numbers::pi * i / 5;
        star.emplace_back(std::cos(angle), std::sin(angle), 0);
    }
    expectAt(star, 0, 0, false);
    expectAt(star, 0, 0.8, true);  // the tip
    expectAt(star, 0.9, 0.9, false);
    const std::vector<vec3> frame = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}, {-2, -2, 0},
                                     {-1, -1, 0}, {-1, 1, 0}, {1, 1, 0}, {1, -1, 0}, {-1, -1, 0}};
    expectAt(frame, 0, 0, false);
    expectAt(frame, 0.5, -0.25, false);
    expectAt(frame, 1.5, 0, true);
    expectAt(frame, -1.75, -1.5, true);  // beside the bridge, and on its other side
    expectAt(frame, -1.5, -1.75, true);
    expectAt(frame, 3, 0, false);
}

// T74: doubled and collinear vertices change nothing.
TEST(ReferencePolygon, NeedlessVertices) {
    const std::vector<vec3> more = {{0, 0, 0},    {2, 0, 0}, {2, 1, 0},    {2, 1, 0},
                                    {1.5f, 1, 0}, {1, 1, 0}, {1, 1.5f, 0}, {1, 2, 0},
                                    {0, 2, 0},    {0, 2, 0}, {0, 1, 0},    {0, 0.5f, 0}};
    Random random(74);
    for (int i = 0; i < 500; ++i) {
        const Ray ray = rayTowards(dvec3(1, 1, 0) + 5.0 * random.direction(),
                                   {random.uniform(-1, 3), random.uniform(-1, 3), 0});
        const auto a = hitPolygon(kL, ray), b = hitPolygon(more, ray);
        ASSERT_EQ(a.has_value(), b.has_value());
        if (a) {
            EXPECT_NEAR(a->t, b->t, 1e-14);
        }
    }
}

// A ray through the edge where polygons meet, in one plane or not, hits exactly one of them.
TEST(ReferencePolygon, SharedEdges) {
    Random random(75);
    for (int i = 0; i < 300; ++i) {
        const vec3 p(random.box(1)), q(random.box(1));
        const vec3 left = p + vec3(2.0 * random.direction()), right = p + vec3(2.0 * random.direction());
        const dvec3 target = glm::mix(dvec3(p), dvec3(q), i % 4 == 0 ? 0.5 : random.uniform(0.01, 0.99));
        // From where the two lie on different sides of the edge.
        const dvec3 d = random.direction();
        const dvec3 side = glm::cross(d, dvec3(q) - dvec3(p));
        if (glm::dot(side, dvec3(left) - dvec3(p)) * glm::dot(side, dvec3(right) - dvec3(p)) > -1e-3)
            continue;
        const Ray ray = rayTowards(target - 5.0 * d, target);
        SceneMaker both;
        both.polygon({p, q, left});
        both.polygon({q, p, right});
        const PackedScene scene = both.finish();
        const auto hit = Tracer(scene).closest(ray);
        ASSERT_TRUE(hit) << i;
        EXPECT_FALSE(Tracer(scene).closest(ray, hit->primitive)) << i;
    }
}

TEST(ReferencePolygon, PlaneAndSource) {
    const Ray inPlane = makeRay({-1, 0.5, 0}, {1, 0, 0});
    EXPECT_FALSE(hitPolygon(kL, inPlane));
    EXPECT_FALSE(hitPolygon(kL, makeRay({0.5, 0.5, 0}, {0, 0, 1}))) << "t = 0";
    EXPECT_FALSE(hitPolygon(kL, makeRay({0.5, 0.5, 1}, {0, 0, 1}))) << "behind";
    SceneMaker maker;
    maker.polygon(kL);
    const SceneTracer tracer(maker);
    const Ray ray = makeRay({0.5, 0.25, 3}, {0, 0, -1});
    const auto hit = tracer.closest(ray);
    ASSERT_TRUE(hit);
    const Surface surface = tracer.surfaceAt(ray, *hit);
    EXPECT_EQ(surface.position, dvec3(0.5, 0.25, 0));
    EXPECT_EQ(surface.geometricNormal, dvec3(0, 0, 1));
    EXPECT_FALSE(tracer.closest(ray, hit->primitive));
}

}  // namespace glint::reference::test::flat_test
