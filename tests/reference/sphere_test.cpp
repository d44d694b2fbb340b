// Spheres, ordinary and anchored: answers from books, closed forms, and quadruple precision.
#include <gtest/gtest.h>

#include "quad_truth.h"
#include "support/packed_scene_maker.h"

namespace glint::reference::test::sphere_test {
namespace {

using namespace glint::test;

using glm::dvec3;
using glm::vec3;

std::optional<Hit> hitScene(const SceneMaker& maker, const Ray& ray) {
    const PackedScene scene = maker.finish();
    return Tracer(scene).closest(ray);
}

std::optional<Hit> hitSphere(const vec3& center, float radius, const Ray& ray) {
    SceneMaker maker;
    maker.sphere(center, radius);
    return hitScene(maker, ray);
}

// Both roots in front of the origin, the second by starting beyond the first.
std::vector<double> rootsOf(const vec3& center, float radius, Ray ray) {
    std::vector<double> roots;
    while (const auto hit = hitSphere(center, radius, ray)) {
        roots.push_back(hit->t);
        ray.tMin = hit->t;
    }
    return roots;
}

// P. Shirley and S. Marschner, Fundamentals of Computer Graphics, ch. 4, exercise 1: t = 1 -+ 1/sqrt(3).
TEST(ReferenceSphere, ShirleyExercise) {
    const auto roots = rootsOf(vec3(0), 1, makeRay(dvec3(1), dvec3(-1)));
    ASSERT_EQ(roots.size(), 2u);
    EXPECT_DOUBLE_EQ(roots[0], 0.4226497308103742);
    EXPECT_DOUBLE_EQ(roots[1], 1.5773502691896257);
}

// J. Buck, The Ray Tracer Challenge, features/spheres.feature; roots behind the origin do not count here.
TEST(ReferenceSphere, RayTracerChallenge) {
    const dvec3 z(0, 0, 1);
    EXPECT_EQ(rootsOf(vec3(0), 1, makeRay({0, 0, -5}, z)), (std::vector<double>{4, 6}));
    EXPECT_EQ(rootsOf(vec3(0), 1, makeRay({0, 1, -5}, z)), (std::vector<double>{5}));
    EXPECT_TRUE(rootsOf(vec3(0), 1, makeRay({0, 2, -5}, z)).empty());
    EXPECT_EQ(rootsOf(vec3(0), 1, makeRay({0, 0, 0}, z)), (std::vector<double>{1}));
    EXPECT_TRUE(rootsOf(vec3(0), 1, makeRay({0, 0, 5}, z)).empty());
    EXPECT_EQ(rootsOf(vec3(0), 2, makeRay({0, 0, -5}, z)), (std::vector<double>{3, 7}));
    EXPECT_TRUE(rootsOf(vec3(5, 0, 0), 1, makeRay({0, 0, -5}, z)).empty());
}

// t = 10 - sqrt(1 - b^2); tangent at b = 1; a float beyond misses.
TEST(ReferenceSphere, GrazingAndTangent) {
    const float inside = 0.99999994f;
    const auto hit = hitSphere(vec3(0), 1, makeRay({inside, 0, -10}, {0, 0, 1}));
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->t, 9.999654733, 5e-10);
    const auto tangent = hitSphere(vec3(0), 1, makeRay({1, 0, -10}, {0, 0, 1}));
    ASSERT_TRUE(tangent);
    EXPECT_EQ(tangent->t, 10);
    EXPECT_FALSE(hitSphere(vec3(0), 1, makeRay({1.0000001f, 0, -10}, {0, 0, 1})));
}

// The lines (-4, 3) + k (3, 4) touch the circle of radius 5 at (-4, 3); all numbers are exact in fp32.
TEST(ReferenceSphere, ExactTangentsAtAnyDistance) {
    for (int k = 1; k < 1 << 21; k = k * 2 + 1) {
        const Ray ray = makeRay({-4.0 - 3.0 * k, 3.0 - 4.0 * k, 0}, {3, 4, 0});
        const auto hit = hitSphere(vec3(0), 5, ray);
        ASSERT_TRUE(hit) << k;
        EXPECT_EQ(hit->t, k);
        EXPECT_FALSE(hitSphere(vec3(0), std::nextafter(5.0f, 0.0f), ray)) << k;
    }
}

// The same lines with directions 7 times as long: the touching t = k / 7 is no binary fraction, so that no
// partial result is exact. Only b^2 - a c of the integers, below 2^113, is.
TEST(ReferenceSphere, TangentsWithoutExactRoots) {
    for (int k = 1; k < 1 << 21; k += 1021) {
        const Ray ray = makeRay({-4.0 - 3.0 * k, 3.0 - 4.0 * k, 0}, {21, 28, 0});
        const auto hit = hitSphere(vec3(0), 5, ray);
        ASSERT_TRUE(hit) << k;
        EXPECT_DOUBLE_EQ(hit->t, k / 7.0);
        EXPECT_FALSE(hitSphere(vec3(0), std::nextafter(5.0f, 0.0f), ray)) << k;
    }
}

// Hearn and Baker's and pbrt's forms give up in fp32 beyond 8000 radii; the reference has to be right far
// beyond. Bound: the result's rounding; the shift to the nearest point and |shifted|^2 err by 32 x 2^-64 x D,
// over the half chord.
TEST(ReferenceSphere, FarSpheresAgreeWithTheTruth) {
    Random random(59);
    SceneMaker maker;
    maker.sphere(vec3(0), 1);
    const PackedScene scene = maker.finish();
    const Tracer tracer(scene);
    for (const double far : {1.5, 100.0, 400.0, 2000.0, 4100.0, 7500.0, 8000.0, 1e5, 1e6}) {
        int hits = 0;
        for (int i = 0; i < 20000; ++i) {
            const vec3 from(far * random.direction());
            const dvec3 at = 1.2 * std::sqrt(random.uniform(0, 1)) * random.direction();
            const Ray ray = makeRay(from, vec3(glm::normalize(at - dvec3(from))));
            const auto truth = sphereTruth(dvec3(0), 1, ray);
            const auto hit = tracer.closest(ray);
            ASSERT_EQ(hit.has_value(), truth.has_value()) << far << " ray " << i;
            if (!hit) continue;
            ++hits;
            const double halfChord = std::max(static_cast<double>(truth->halfChord), 1e-9);
            ASSERT_LE(distance(truth->t0, hit->t), 0x1p-52 * hit->t + 0x1p-59 * far / halfChord) << far;
        }
        EXPECT_GT(hits, 5000);
    }
}

// Straight at the centre: t = D - r, to 4 u.
TEST(ReferenceSphere, TinyAndFar) {
    const double sizes[][2] = {{1e-3, 1e3}, {1, 1e6}, {1e-6, 1}};
    for (const auto& [size, far] : sizes) {
        const auto radius = static_cast<float>(size);
        const auto hit = hitSphere(vec3(0), radius, makeRay({0, 0, -far}, {0, 0, 1}));
        ASSERT_TRUE(hit);
        EXPECT_DOUBLE_EQ(hit->t, far - static_cast<double>(radius));
    }
}

TEST(ReferenceSphere, DirectionLengthScalesT) {
    for (const double s : {1e-15, 1e15, 0.25, 3.0}) {
        const auto hit = hitSphere(vec3(0), 1, makeRay({0, 0, -5}, {0, 0, s}));
        ASSERT_TRUE(hit);
        EXPECT_DOUBLE_EQ(hit->t, 4 / s);
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
        const auto anchored = hitScene(maker, ray);
        ASSERT_TRUE(anchored);
        EXPECT_DOUBLE_EQ(anchored->t, h);
    }
}

// An anchored sphere is |x - p|^2 + 2 r n.(x - p) = 0: the sphere about p - r n of radius r |n|.
TEST(ReferenceSphere, AnchoredAgreesWithTheTruth) {
    Random random(60);
    for (const float radius : {1.0f, 1e3f, 6.371e6f}) {
        const vec3 point(12.5f, -3.25f, 7), normal(glm::normalize(dvec3(1, 2, 3)));
        SceneMaker maker;
        maker.anchoredSphere(point, normal, radius);
        const PackedScene scene = maker.finish();
        const Tracer tracer(scene);
        int hits = 0, misses = 0;
        for (int i = 0; i < 20000; ++i) {
            const double height = std::pow(10.0, random.uniform(-2, 2));
            const dvec3 from = dvec3(point) + height * dvec3(normal) + random.box(height);
            const Ray ray =
                makeRay(from, glm::normalize(random.direction() - dvec3(normal) * random.uniform(0, 1)));
            // In the frame of the anchor, where nothing cancels: a t^2 + 2 b t + c = 0.
            const QuadVec w = QuadVec(ray.origin) - QuadVec(point), d(ray.direction),
                          n = QuadVec(normal) * radius;
            const Quad a = d.dot(d), b = w.dot(d) + n.dot(d), c = w.dot(w) + 2 * n.dot(w),
                       disc = b * b - a * c;
            const Quad s = squareRoot(disc);
            const Quad q = b > 0 ? -b - s : -b + s;
            std::optional<Quad> truth;
            if (disc >= 0 && q != 0) {
                const Quad t0 = c / q, t1 = q / a;
                for (const Quad t : {t0, t1}) {
                    if (t > 0 && (!truth || t < *truth)) truth = t;
                }
            }
            const auto hit = tracer.closest(ray);
            ASSERT_EQ(hit.has_value(), truth.has_value()) << radius << " ray " << i;
            if (!hit) {
                ++misses;
                continue;
            }
            ++hits;
            const double steepness = std::max(static_cast<double>(s) / radius, 1e-9);
            EXPECT_LE(distance(*truth, hit->t), 0x1p-52 * hit->t + 0x1p-58 * (height + hit->t) / steepness);
        }
        EXPECT_GT(hits, 1000);
        EXPECT_GT(misses, 1000);
    }
}

// A ray that starts on the sphere meets it again at -2 b / a, however its start was rounded, or never.
TEST(ReferenceSphere, SourceHitsOnlyItsOtherSide) {
    SceneMaker maker;
    maker.sphere(vec3(0), 1);
    maker.anchoredSphere({100, 0, 0}, {0, 1, 0}, 1000);
    const PackedScene scene = maker.finish();
    const Tracer tracer(scene);
    for (uint32_t i = 0; i < 2; ++i) {
        const uint32_t source = shared::kKindSphere << shared::kPrimitiveKindShift | i;
        const bool anchored = scene.spheres[i].anchorNormal != vec3(0);
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
    const PackedScene scene = maker.finish();
    const Tracer tracer(scene);
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

}  // namespace
}  // namespace glint::reference::test::sphere_test
