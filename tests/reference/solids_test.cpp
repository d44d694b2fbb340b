// Spheres, quadrics and boxes.
#include <gtest/gtest.h>

#include <cmath>

#include "pack/packed_scene.h"
#include "reference/intersect.h"
#include "support/packed_scene_maker.h"
#include "support/scene_maker.h"

namespace glint::reference::test::solids_test {

// Spheres, ordinary and anchored: answers from books, closed forms, and quadruple precision.

using namespace glint::test;

using glm::dvec3;
using glm::vec3;

std::optional<Hit> hitSphere(const vec3& center, float radius, const Ray& ray) {
    SceneMaker maker;
    maker.sphere(center, radius);
    return SceneTracer(maker).closest(ray);
}

// Tangents of integers at t = k / 7, which is no binary fraction: no partial result is exact but b^2 - a c,
// below 2^113.
TEST(ReferenceSphere, TangentsWithoutExactRoots) {
    for (int k = 1; k < 1 << 21; k += 1021) {
        const Ray ray = makeRay({-4.0 - 3.0 * k, 3.0 - 4.0 * k, 0}, {21, 28, 0});
        const auto hit = hitSphere(vec3(0), 5, ray);
        ASSERT_TRUE(hit) << k;
        EXPECT_DOUBLE_EQ(hit->t, k / 7.0);
        EXPECT_FALSE(hitSphere(vec3(0), std::nextafter(5.0f, 0.0f), ray)) << k;
    }
}

// A planet of radius 1e6 seen from height h, straight down: t = h, where c/q in fp32 gives 1.0158 for h = 1.
TEST(ReferenceSphere, GiantSphereFromClose) {
    for (const double h : {100.0, 1.0, 0.25, 0.0625, 1e-6}) {
        const Ray ray = makeRay({0, h, 0}, {0, -1, 0});
        const auto ordinary = hitSphere({0, -1e6f, 0}, 1e6f, ray);
        ASSERT_TRUE(ordinary);
        EXPECT_NEAR(ordinary->t, h, 1e6 * 0x1p-60);
        SceneMaker maker;
        maker.anchoredSphere(vec3(0), {0, 1, 0}, 1e6f);
        const auto anchored = SceneTracer(maker).closest(ray);
        ASSERT_TRUE(anchored);
        EXPECT_DOUBLE_EQ(anchored->t, h);
    }
}

// A ray that starts on the sphere hits it again at -2 b / a for any rounding of its start, or never.
TEST(ReferenceSphere, SourceHitsOnlyItsOtherSide) {
    SceneMaker maker;
    maker.sphere(vec3(0), 1);
    maker.anchoredSphere({100, 0, 0}, {0, 1, 0}, 1000);
    const SceneTracer tracer(maker);
    for (uint32_t i = 0; i < 2; ++i) {
        const uint32_t source = shared::kKindSphere << shared::kPrimitiveKindShift | i;
        const bool anchored = tracer.scene.spheres[i].anchorNormal != vec3(0);
        const dvec3 at = anchored ? dvec3(100, 0, 0) : dvec3(0, 1, 0);
        const double diameter = anchored ? 2000 : 2;
        for (const double error : {-1e-12, 0.0, 1e-12}) {
            const dvec3 start = at + dvec3(0, error, 0);
            const auto inward = tracer.closest(makeRay(start, {0, -1, 0}), source);
            ASSERT_TRUE(inward);
            EXPECT_NEAR(inward->t, diameter, 1e-11);
            // At 45 degrees the chord is 2 r cos 45.
            const auto slanted = tracer.closest(makeRay(start, glm::normalize(dvec3(1, -1, 0))), source);
            ASSERT_TRUE(slanted);
            EXPECT_NEAR(slanted->t, diameter * std::sqrt(.5), 1e-9);
            EXPECT_FALSE(tracer.closest(makeRay(start, {0, 1, 0}), source));
            EXPECT_FALSE(tracer.closest(makeRay(start, {1, 1e-9, 0}), source));
        }
    }
}

TEST(ReferenceSphere, SurfaceLiesOnTheSphere) {
    Random random(61);
    SceneMaker maker;
    maker.sphere({3, 4, 5}, 2.5f);
    maker.anchoredSphere({0, -50, 0}, {0, 1, 0}, 1e6f);
    const SceneTracer tracer(maker);
    int seen[2] = {0, 0};
    for (int i = 0; i < 2000; ++i) {
        const Ray ray =
            rayTowards(1e3 * (random.box(100) + dvec3(0, 130, 0)), dvec3(3, 4, 5) + random.box(5));
        const auto hit = tracer.closest(ray);
        ASSERT_TRUE(hit);
        const Surface surface = tracer.surfaceAt(ray, *hit);
        ++seen[surface.object];
        EXPECT_NEAR(glm::length(surface.geometricNormal), 1, 1e-15);
        EXPECT_EQ(surface.geometricNormal, surface.shadingNormal);
        const dvec3 y = surface.position - dvec3(0, -50, 0);
        const double error = surface.object == 0
                                 ? glm::length(surface.position - dvec3(3, 4, 5)) - 2.5
                                 : (glm::dot(y, y) + 2e6 * y.y) / (2 * glm::length(y + dvec3(0, 1e6, 0)));
        EXPECT_LE(std::abs(error), 16 * 0x1p-53 * (200 + glm::length(surface.position)));
        EXPECT_GT(glm::dot(surface.geometricNormal,
                           surface.position - (surface.object ? dvec3(0, -1e6, 0) : dvec3(3, 4, 5))),
                  0)
            << "outward";
    }
    EXPECT_GT(seen[0], 100);
    EXPECT_GT(seen[1], 100);
}

// Quadrics: published hits, hard quadratics, parts and sources.

PackedScene packed(const Shape& shape, std::optional<Affine> transform = {}) {
    Scene scene;
    scene.materials.resize(1);
    scene.camera.eye = {0, 0, 1e3};
    scene.objects.push_back({"/objects/0", shape, 0, transform});
    return packScene(scene);
}

// (t - 2)^2 - z^2 t^2 = 1, solved with 40 decimal digits for the directions (1, 0, z) as rounded to fp32.
TEST(ReferenceQuadric, HyperboloidAlongItsAsymptote) {
    const SceneTracer tracer(packed(generalQuadric({1, 1, -1, 0, 0, 0, 0, 0, 0, -1}, 0x1p25)));
    const std::pair<dvec3, double> rows[] = {{{1, 0, 1}, 0.75},
                                             {{1, 0, 1 + 0x1p-23}, 0.7499999664723883},
                                             {{-1, 0, -1 - 0x1p-23}, 16777215.750000026},
                                             {{1, 0, 1.001f}, 0.7497188071893966},
                                             {{-1, 0, -1.001f}, 1999.6567628648377}};
    for (const auto& [direction, t] : rows)
        EXPECT_NEAR(tracer.closest(makeRay({-2, 0, 0}, direction)).value().t, t, 1e-12 * t);
}

TEST(ReferenceQuadric, NormalsPointOutward) {
    const SceneTracer tracer(packed(CylinderShape{{0, 0, -1}, {0, 0, 2}, 0.5, true}));
    const auto normalAt = [&](const dvec3& o, const dvec3& d) {
        const Ray ray = makeRay(o, d);
        return tracer.surfaceAt(ray, tracer.closest(ray).value()).geometricNormal;
    };
    EXPECT_EQ(normalAt({0.25, 0, 9}, {0, 0, -1}), dvec3(0, 0, 1));
    EXPECT_EQ(normalAt({0.25, 0, -9}, {0, 0, 1}), dvec3(0, 0, -1));
    EXPECT_EQ(normalAt({9, 0, 0}, {-1, 0, 0}), dvec3(1, 0, 0));
    EXPECT_EQ(normalAt({0, 0, 0}, {0, 1, 0}), dvec3(0, 1, 0)) << "from inside";
    EXPECT_EQ(normalAt({0, 0, 0}, {0, 0, 1}), dvec3(0, 0, 1)) << "the cap from inside";
}

// A ray that leaves outward never hits a convex body again; an inward ray hits its other side. See pbrt's
// Reintersect tests (src/pbrt/shapes_test.cpp).
TEST(ReferenceQuadric, RaysThatLeaveDoNotComeBack) {
    Random random(7);
    for (int i = 0; i < 300; ++i) {
        const double size = std::pow(10, random.uniform(-4, 4));
        const dvec3 base = random.box(1) * std::pow(10, random.uniform(-2, 3)), axis = random.direction();
        const Shape shapes[] = {EllipsoidShape{base, size * dvec3(1, random.uniform(0.2, 1), 3)},
                                CylinderShape{base, base + size * axis, 0.7 * size, true},
                                ConeShape{base, base + size * axis, 0.7 * size, 0.2 * size, true}};
        const SceneTracer tracer(packed(shapes[i % 3]));
        const Ray ray = rayTowards(base + 20 * size * random.direction(), base + 0.3 * size * axis);
        const auto hit = tracer.closest(ray);
        if (!hit) continue;
        const Surface s = tracer.surfaceAt(ray, *hit);
        for (int k = 0; k < 30; ++k) {
            const dvec3 out = glm::normalize(s.geometricNormal + 0.999 * random.direction());
            EXPECT_FALSE(tracer.closest(makeRay(s.position, out), hit->primitive)) << i << ' ' << k;
            const auto inner = tracer.closest(makeRay(s.position, -out), hit->primitive);
            ASSERT_TRUE(inner) << i << ' ' << k;
            EXPECT_GT(inner->t, 0);
        }
    }
}

// As a device's rays do: errors do not add up along a chain of reflections.
TEST(ReferenceQuadric, RaysThatStartOffTheSideEndOnIt) {
    const dvec3 radii(7, 6.7, 17.6);
    const SceneTracer tracer(packed(EllipsoidShape{{0, 0, 0}, radii}));
    Random random(11);
    for (int i = 0; i < 200; ++i) {
        const Ray ray = rayTowards(random.box(1), 100.0 * random.direction());
        const Hit hit = tracer.closest(ray).value();
        const Surface near = tracer.surfaceAt(ray, hit);
        const dvec3 in = glm::normalize(-near.geometricNormal + 0.5 * random.direction());
        const Ray next = makeRay(near.position - 3e-5 * near.geometricNormal, in);
        const dvec3 far = tracer.surfaceAt(next, tracer.closest(next, hit.primitive).value()).position;
        EXPECT_NEAR(glm::length(far / radii), 1, 1e-7) << i;  // packing rounds the coefficients
    }
}

// Hits of rays with the noise of 100 seeds.
int hitsOf100(const SceneTracer& tracer, Ray ray, double step) {
    int hits = 0;
    for (uint64_t seed = 1; seed <= 100; ++seed) {
        ray.noise = {seed, step * 0x1p-24};
        hits += tracer.closest(ray).has_value();
    }
    return hits;
}

// A line at distance h from the axis has the discriminant 1 - h^2, a sum of magnitudes 2: fp32 errs by 18
// units, and the device takes misses by 18 units for tangents.
TEST(ReferenceQuadric, NoiseMovesTheLimbWithinItsRounding) {
    const SceneTracer tracer(packed(CylinderShape{{0, 0, -1}, {0, 0, 1}, 1, true}));
    // units: by which h^2 exceeds 1
    const auto hitsAt = [&](double units, double step) {
        return hitsOf100(tracer, makeRay({-5, std::sqrt(1 + units * 0x1p-24), 0}, {1, 0, 0}), step);
    };
    EXPECT_EQ(hitsAt(0.01, 0), 0);
    for (const double step : {1, 34}) {
        EXPECT_EQ(hitsAt(0, step), 100);
        EXPECT_LT(hitsAt(9, step), 100);
        EXPECT_NEAR(hitsAt(18, step), 50, 30);
        EXPECT_GT(hitsAt(27, step), 0);
        EXPECT_EQ(hitsAt(36.01, step), 0);
    }
}

// From the centre of a unit sphere, the ray hits the side at t = 1 with n.d = 1, and the plane z = 0.5 with
// d.z = 0.5. The side's t errs by 18 units, the plane by 5: together 14 units of z. The rim of a cap stays
// closed.
TEST(ReferenceQuadric, NoiseMovesOpenRimsWithinTheirRounding) {
    QuadricShape open = generalQuadric({1, 1, 1, 0, 0, 0, 0, 0, 0, -1}, 1);
    open.hi.z = 0.5;
    const SceneTracer sphere(packed(open)), cylinder(packed(CylinderShape{{0, 0, -1}, {0, 0, 1}, 1, true}));
    const auto hitsAt = [](const SceneTracer& tracer, double z, double step) {
        return hitsOf100(tracer, makeRay({0, 0, 0}, {std::sqrt(1 - z * z), 0, z}), step);
    };
    const auto hitsBeyond = [&](double units, double step) {
        return hitsAt(sphere, 0.5 + units * 0x1p-24, step);
    };
    EXPECT_EQ(hitsBeyond(-0.01, 0), 100);
    EXPECT_EQ(hitsBeyond(0.01, 0), 0);
    for (const double step : {1, 34}) {
        EXPECT_EQ(hitsBeyond(-14.1, step), 100);
        EXPECT_NEAR(hitsBeyond(0, step), 50, 20);
        EXPECT_NEAR(hitsBeyond(7, step), 25, 20);
        EXPECT_EQ(hitsBeyond(14.1, step), 0);
        for (const double units : {-1, 0, 1})
            EXPECT_EQ(hitsAt(cylinder, std::sqrt(0.5) * (1 + units * 0x1p-24), step), 100);
    }
}

// The ellipsoid that a sphere becomes is that ellipsoid.
TEST(ReferenceQuadric, TransformedSphereIsAnEllipsoid) {
    Affine stretch;
    stretch.linear = glm::dmat3(2, 0, 0, 0, 0.5, 0, 0, 0, 1);
    stretch.offset = {1, 2, 3};
    const PackedScene a = packed(EllipsoidShape{{0, 0, 0}, dvec3(1)}, stretch),
                      b = packed(EllipsoidShape{{1, 2, 3}, {2, 0.5, 1}});
    Random random(3);
    for (int i = 0; i < 200; ++i) {
        const Ray ray =
            rayTowards(dvec3(1, 2, 3) + 9.0 * random.direction(), dvec3(1, 2, 3) + random.box(0.4));
        const auto hitA = Tracer(a).closest(ray), hitB = Tracer(b).closest(ray);
        ASSERT_TRUE(hitA && hitB);
        EXPECT_NEAR(hitA->t, hitB->t, 1e-12);
        EXPECT_LT(glm::distance(Tracer(a).surfaceAt(ray, *hitA).geometricNormal,
                                Tracer(b).surfaceAt(ray, *hitB).geometricNormal),
                  1e-12);
    }
}

// Boxes: exact truth by whole numbers.

// The slabs' bounds are fractions of whole numbers, whose cross products are exact in 64 bits.
struct Fraction {
    int64_t over, under;  // under > 0
    bool operator<(const Fraction& o) const { return over * o.under < o.over * under; }
};

std::optional<double> exactHit(const int (&o)[3], const int (&d)[3], const int (&low)[3],
                               const int (&high)[3]) {
    std::optional<Fraction> enter, leave;
    for (int i = 0; i < 3; ++i) {
        if (d[i] == 0) {
            if (o[i] < low[i] || o[i] > high[i]) return std::nullopt;
            continue;
        }
        const int sign = d[i] < 0 ? -1 : 1;
        const Fraction a{sign * ((sign > 0 ? low[i] : high[i]) - o[i]), sign * d[i]};
        const Fraction b{sign * ((sign > 0 ? high[i] : low[i]) - o[i]), sign * d[i]};
        if (!enter || *enter < a) enter = a;
        if (!leave || b < *leave) leave = b;
    }
    if (!enter || *leave < *enter || leave->over <= 0) return std::nullopt;
    const Fraction& hit = enter->over > 0 ? *enter : *leave;
    return static_cast<double>(hit.over) / static_cast<double>(hit.under);
}

TEST(ReferenceCuboid, WholeNumbersExactly) {
    Random random(6);
    const auto whole = [&](int most) {
        return static_cast<int>(std::floor(random.uniform(-most, most + 1)));
    };
    size_t hits = 0, touches = 0;
    for (int k = 0; k < 300; ++k) {
        int low[3], high[3];
        for (int i = 0; i < 3; ++i) {
            low[i] = whole(4);
            high[i] = low[i] + 1 + std::abs(whole(3));
        }
        const SceneTracer tracer(packed(BoxShape{{low[0], low[1], low[2]}, {high[0], high[1], high[2]}}));
        for (int r = 0; r < 100; ++r) {
            int o[3], d[3];
            for (int i = 0; i < 3; ++i) o[i] = whole(9), d[i] = whole(6);
            if (d[0] == 0 && d[1] == 0 && d[2] == 0) continue;
            // Coordinates may be counted from near the box, by whole numbers.
            const Ray ray{dvec3(o[0], o[1], o[2]) - tracer.scene.origin, {d[0], d[1], d[2]}};
            const auto truth = exactHit(o, d, low, high);
            const auto hit = tracer.closest(ray);
            ASSERT_EQ(hit.has_value(), truth.has_value()) << k << " " << r;
            EXPECT_EQ(hit, closestOfAll(tracer, ray));
            if (!truth) continue;
            ++hits;
            EXPECT_EQ(hit->t, *truth);
            const dvec3 at = tracer.scene.origin + ray.origin + hit->t * ray.direction;
            int sides = 0;
            for (int i = 0; i < 3; ++i) sides += at[i] == low[i] || at[i] == high[i];
            touches += sides > 1;
        }
    }
    EXPECT_GT(hits, 400u);
    EXPECT_GT(touches, 20u) << "edges and corners are among them";
}

// A ray that starts on a face leaves the box for good, or hits the face through which it leaves.
TEST(ReferenceCuboid, TheSourceIsNeverMetAgain) {
    const SceneTracer tracer(packed(BoxShape{{-1, -1, -1}, {1, 1, 1}}));
    const auto hit = tracer.closest({{0.25, 5, 0.5}, {0, -1, 0}});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->primitive >> shared::kPartShift & shared::kPartMask, 3u) << "the upper face across y";
    const dvec3 on(0.25, 1, 0.5);
    EXPECT_FALSE(tracer.closest({on, {0.5, 1, 0}}, sourceOf(*hit)));
    EXPECT_FALSE(tracer.closest({on - dvec3(0, 1e-9, 0), {0.5, 1e-3, 0}}, sourceOf(*hit))) << "from below";
    const auto through = tracer.closest({on + dvec3(0, 1e-9, 0), {0, -1, 0}}, sourceOf(*hit));
    ASSERT_TRUE(through) << "from above";
    EXPECT_NEAR(through->t, 2, 1e-8);
    EXPECT_EQ(through->primitive >> shared::kPartShift & shared::kPartMask, 2u);
    EXPECT_NEAR(tracer.closest({on, {1, -0.5, 0}}, sourceOf(*hit))->t, 0.75, 1e-12) << "the side";
}

TEST(ReferenceCuboid, AllHitsAreTwo) {
    const SceneTracer tracer(packed(BoxShape{{-1, -1, -1}, {1, 1, 1}}));
    const auto hits = tracer.allHits({{0.5, 0.25, 7}, {0, 0, -1}});
    ASSERT_EQ(hits.size(), 2u);
    EXPECT_EQ(hits[0].t, 6);
    EXPECT_EQ(hits[1].t, 8);
}

// docs/design/numerics.md, by hand: |a - o| + |t d| is (2, 0, 1), so the height is 1 (4 + 12) + 2 (4) + 4 (4
// + 6).
TEST(ReferenceSlip, CountsEachTermOfTheRule) {
    Ray ray{{1, 2, 3}, {1, 0, 0}};
    ray.ties = true;
    const dvec3 spread(1, 2, 4), anchor(2, 2, 2);
    const double unit = 0x1p-24;
    EXPECT_EQ(slipOfFlat(PreparedRay(ray), {2, 2, 4}, anchor, 1), (64 + 16) / 2.0 * unit);
    RoundRule rule(PreparedRay(ray), {2, 2, 4}, spread, anchor, 1, 3);
    EXPECT_EQ(rule.error, (64 + 12 * 3) * unit);
    rule.error = 100;
    EXPECT_EQ(rule.slip(PreparedRay(ray)), 50);
    rule.gradient = {0, 1, 0};
    EXPECT_EQ(rule.slip(PreparedRay(ray)), 100 / (0x1p-11 * 4)) << "tangent";
    ray.slips = 0;
    EXPECT_EQ(RoundRule(PreparedRay(ray), {2, 2, 4}, spread, anchor, 1, 3).error, 4 * (1 + 2 + 4) * unit);
}

}  // namespace glint::reference::test::solids_test
