// The double-precision reference judged by the oracle, with rays that aim where decisions fall: edges,
// vertices, rims and tangents. It must be right everywhere but where quadruple precision cannot tell
// (src/reference/intersect.h), and then say "hit".
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "support/packed_scene_maker.h"
#include "tally.h"

namespace glint::oracle::reference_test {
using glint::test::Random;
using glint::test::SceneMaker;
using glm::dvec3;
using glm::vec3;

// 32 x 2^-113 of the terms, rounded up: below this the reference takes a side for zero.
constexpr double kBand = 0x1p-104;
// A root, a quotient and the rounding to double; long double inside.
constexpr double kTimeBar = 4 * 0x1p-53;

struct Aimed {
    vec3 origin, direction;
};

Aimed aimed(const dvec3& origin, const dvec3& target) {
    const vec3 from(origin);
    return {from, vec3(target - dvec3(from))};
}

void add(Tally& tally, const SceneMaker& maker, const Truth& truth, const Aimed& ray, double band = kBand) {
    const PackedScene scene = maker.finish();
    const reference::Tracer tracer(scene);
    const auto hit = tracer.closest({dvec3(ray.origin), dvec3(ray.direction)});
    tally.add(truth, band, hit.has_value(), hit ? hit->t : 0, hit ? hit->u : 0, hit ? hit->v : 0);
}

void expectRight(const Tally& tally, const std::string& what) {
    std::cout << what << ": " << tally.text() << '\n';
    EXPECT_EQ(tally.wrong(), 0u) << what;
    EXPECT_GT(tally.hits, tally.rays / 10) << what;
    EXPECT_LT(tally.hits, tally.rays) << what;
}

// Shapes from round to needles of 1e-8 (tests/stability/cases.md T30), near and far (T35), aimed all over.
TEST(ReferenceByOracle, Triangles) {
    Random random(301);
    for (const double offset : {0.0, 1e3, 1e7}) {
        for (const double height : {1.0, 1e-4, 1e-6, 1e-8}) {
            if (offset > 0 && height < 1) continue;  // they would collapse
            Tally tally;
            for (int i = 0; i < 4000; ++i) {
                const dvec3 base = dvec3(offset, -offset, offset);
                const vec3 v[3] = {vec3(base + random.box(1) * 8.0), vec3(base + 8.0 * dvec3(1, 0, 0)),
                                   vec3(base + 8.0 * dvec3(0.5, height, 0))};
                double u = random.uniform(-.3, 1.1), w = random.uniform(-.3, 1.1);
                if (i % 4 == 1) w = 0;
                if (i % 4 == 2) w = 1 - u;
                if (i % 4 == 3) u = i % 8 == 3, w = 0;
                const vec3 first = height < 1 ? vec3(base) : v[0];
                const dvec3 at = (1 - u - w) * dvec3(first) + u * dvec3(v[1]) + w * dvec3(v[2]);
                const Aimed ray = aimed(at + 10.0 * random.direction(), at);
                SceneMaker maker;
                maker.triangle(first, v[1], v[2]);
                add(tally, maker, triangle(first, v[1], v[2], {ray.origin, ray.direction}), ray);
            }
            expectRight(tally,
                        "triangles, offset " + std::to_string(offset) + ", height " + std::to_string(height));
            EXPECT_LE(Tally::quantile(tally.tErrors, 1), kTimeBar * 16);
        }
    }
}

// Centres near the eye and up to a million radii away, rays within a few ulp of the limb and all over.
TEST(ReferenceByOracle, Spheres) {
    Random random(302);
    for (const double distance : {1.2, 3.0, 400.0, 8000.0, 1e6}) {
        Tally tally;
        for (int i = 0; i < 6000; ++i) {
            const vec3 center(random.box(2));
            const float radius = static_cast<float>(random.uniform(.5, 1));
            const dvec3 from = dvec3(center) + distance * random.direction();
            const dvec3 side = glm::normalize(glm::cross(from - dvec3(center), random.direction()));
            const double rim = i % 2 ? 1 + random.uniform(-1, 1) * 1e-7 : 1.3 * random.uniform(0, 1);
            const Aimed ray = aimed(from, dvec3(center) + rim * radius * side);
            SceneMaker maker;
            maker.sphere(center, radius);
            add(tally, maker, sphere(center, radius, {ray.origin, ray.direction}), ray);
        }
        expectRight(tally, "spheres, distance " + std::to_string(distance));
        EXPECT_LE(Tally::quantile(tally.tErrors, 1), kTimeBar);
    }
}

TEST(ReferenceByOracle, AnchoredSpheres) {
    Random random(303);
    Tally tally;
    for (int i = 0; i < 6000; ++i) {
        const vec3 point(random.box(2)), normal(random.direction());
        const float radius = static_cast<float>(std::exp(random.uniform(5, 14)));
        const dvec3 from = dvec3(point) + dvec3(normal) * random.uniform(.01, 3) + random.box(1) * .1;
        // Half of them near the horizon, whose distance is sqrt(2 r h).
        const dvec3 along = glm::normalize(glm::cross(dvec3(normal), random.direction()));
        const double height = glm::dot(from - dvec3(point), dvec3(normal));
        const double dip = std::sqrt(2 * std::abs(height) / radius);
        const dvec3 d =
            i % 2 ? along - dip * (1 + random.uniform(-1, 1) * 1e-6) * dvec3(normal) : random.direction();
        const Aimed ray = {vec3(from), vec3(d)};
        SceneMaker maker;
        maker.anchoredSphere(point, normal, radius);
        add(tally, maker, anchoredSphere(point, normal, radius, {ray.origin, ray.direction}), ray);
    }
    expectRight(tally, "anchored spheres");
    // Near the horizon the root magnifies the rounding of long double.
    EXPECT_LE(Tally::quantile(tally.tErrors, 0.5), kTimeBar);
    EXPECT_LE(Tally::quantile(tally.tErrors, 1), 128 * kTimeBar);
}

TEST(ReferenceByOracle, PlanesAndDiscs) {
    Random random(304);
    Tally planes, discs;
    for (int i = 0; i < 6000; ++i) {
        const vec3 point(random.box(1e3)), normal(random.direction());
        const float radius = static_cast<float>(random.uniform(.1, 10));
        const dvec3 along = glm::normalize(glm::cross(dvec3(normal), random.direction()));
        const double rim = i % 2 ? 1 + random.uniform(-1, 1) * 1e-7 : 1.3 * random.uniform(0, 1);
        const dvec3 at = dvec3(point) + rim * radius * along;
        const dvec3 away = i % 3 ? random.direction() : along + 1e-6 * random.direction();
        Aimed ray = aimed(at + 10.0 * away, at);
        if (i % 5 == 0) ray.direction = -ray.direction;
        const Ray exact = {ray.origin, ray.direction};
        SceneMaker onePlane, oneDisc;
        onePlane.plane(point, normal);
        add(planes, onePlane, plane(point, normal, exact), ray);
        oneDisc.disc(point, normal, radius);
        add(discs, oneDisc, disc(point, normal, radius, exact), ray);
    }
    expectRight(planes, "planes");
    expectRight(discs, "discs");
    EXPECT_LE(Tally::quantile(planes.tErrors, 0.99), kTimeBar);
}

// Stars of 5 to 40 corners. On the outline itself either answer is right (the two shapes that meet there
// share it out), and the oracle's distance to it is good to double precision.
TEST(ReferenceByOracle, Polygons) {
    constexpr double kOutlineBand = 1e-13;
    Random random(305);
    Tally tally;
    for (int i = 0; i < 4000; ++i) {
        const uint32_t corners = 5 + random.below(36);
        const dvec3 normal = random.direction(), x = glm::normalize(glm::cross(normal, random.direction()));
        const dvec3 y = glm::cross(normal, x), center = random.box(5);
        std::vector<vec3> outline;
        for (uint32_t k = 0; k < corners; ++k) {
            const double angle = 6.283185307179586 * k / corners, r = random.uniform(.3, 2);
            outline.emplace_back(center + r * (std::cos(angle) * x + std::sin(angle) * y));
        }
        const dvec3 a(outline[0]), b(outline[1]);
        dvec3 at = center + random.uniform(-2, 2) * x + random.uniform(-2, 2) * y;
        if (i % 3 == 1) at = a + random.uniform(0, 1) * (b - a);
        if (i % 3 == 2) at = center + random.uniform(.9, 1.1) * (a - center);
        const Aimed ray = aimed(at + 4.0 * glm::normalize(normal + .9 * random.direction()), at);
        SceneMaker maker;
        maker.polygon(outline);
        const PackedScene scene = maker.finish();
        const shared::Polygon& packed = scene.polygons[0];
        add(tally, maker,
            polygon({outline.begin(), outline.end()}, packed.point, packed.normal,
                    {ray.origin, ray.direction}),
            ray, kOutlineBand);
    }
    expectRight(tally, "polygons");
}

}  // namespace glint::oracle::reference_test
