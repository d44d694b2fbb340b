// The oracle must give published answers.
#include "oracle.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "dyadic.h"
#include "tally.h"

namespace glint::oracle::oracle_test {
using glm::dvec3;

constexpr double kUlp = 0x1p-51;  // of numbers near 1, twice: the oracle rounds towards zero

// Kahan, "On the Cost of Floating-Point Computation Without Extra-Precise Arithmetic", 2004: b^2 - a c is
// 1.890625, which double arithmetic takes for 0.
TEST(Dyadic, KahansDiscriminant) {
    const Dyadic a(94906265.625), b(94906267.0), c(94906268.375);
    EXPECT_EQ((b * b - a * c).approximate(), 1.890625);
    EXPECT_EQ(94906267.0 * 94906267.0 - 94906265.625 * 94906268.375, 0.0);
}

TEST(Dyadic, SpansTheWholeRangeOfDouble) {
    const Dyadic great(0x1p1023), tiny(0x1p-1074);
    EXPECT_EQ((great + tiny - great).approximate(), 0x1p-1074);
    EXPECT_EQ((great * tiny).approximate(), 0x1p-51);
    EXPECT_LT(-great, tiny);
    EXPECT_EQ(Dyadic(-0.0), Dyadic(0.0));
    EXPECT_THROW(static_cast<void>(Dyadic(std::numeric_limits<double>::infinity())), std::domain_error);
}

// Shirley and Marschner, Fundamentals of Computer Graphics.
TEST(Oracle, ShirleyExercises) {
    const Ray ray{{1, 1, 1}, {-1, -1, -1}};
    const Truth ball = sphere({0, 0, 0}, 1, ray);
    EXPECT_TRUE(ball.hit);
    EXPECT_NEAR(ball.t, 1 - 1 / std::sqrt(3.0), kUlp);
    EXPECT_NEAR(ball.normal.x, 1 / std::sqrt(3.0), kUlp);
    const Truth face = triangle({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, ray);
    EXPECT_TRUE(face.hit);
    EXPECT_NEAR(face.t, 2 / 3.0, kUlp);
    EXPECT_NEAR(face.u, 1 / 3.0, kUlp);
    EXPECT_NEAR(face.v, 1 / 3.0, kUlp);
    EXPECT_NEAR(face.normal.y, 1 / std::sqrt(3.0), kUlp);
}

// Buck, The Ray Tracer Challenge, features/spheres.feature.
TEST(Oracle, RayTracerChallengeSpheres) {
    const auto t = [](double y, double z) { return sphere(dvec3(0), 1, {{0, y, z}, {0, 0, 1}}); };
    EXPECT_EQ(t(0, -5).t, 4);
    EXPECT_TRUE(t(1, -5).hit);
    EXPECT_EQ(t(1, -5).t, 5);
    EXPECT_EQ(t(1, -5).margin, 0);
    EXPECT_FALSE(t(2, -5).hit);
    EXPECT_FALSE(t(1 + 0x1p-52, -5).hit);
    EXPECT_EQ(t(0, 0).t, 1);
    EXPECT_FALSE(t(0, 5).hit);
    EXPECT_FALSE(t(0, 1).hit);  // t = 0 and -2
    EXPECT_EQ(t(0, -1).t, 2);   // t = 0 and 2
}

// Corners and rays on a coarse grid, so that a third of them decide by exact zeros, moved by up to a few
// units of the last place, near the origin and far from it.
TEST(Oracle, HitsOfTrianglesAreThoseOfTheWholeAnswer) {
    std::mt19937 random(5);
    std::uniform_int_distribution<int> cell(-2, 2);
    int hits = 0, ties = 0;
    for (int i = 0; i < 40'000; ++i) {
        const double away = std::array{0.0, 1e3, 1e6}[static_cast<size_t>(i) % 3];
        const double scale = std::array{1.0, 0x1p-420, 0x1p90, 0x1p330}[static_cast<size_t>(i) / 8 % 4];
        const auto place = [&](double from) {
            dvec3 v;
            for (int k = 0; k < 3; ++k) {
                v[k] = from + cell(random);
                if (cell(random) == 2) v[k] = std::nextafter(v[k], 2.0 * cell(random) * (1 + away));
            }
            return scale * v;
        };
        const dvec3 a = place(away), b = place(away), c = place(away);
        const Ray ray{place(away), place(0)};
        const Truth truth = triangle(a, b, c, ray);
        ASSERT_EQ(hitsTriangle(a, b, c, ray), truth.hit) << "case " << i;
        hits += truth.hit ? 1 : 0;
        ties += truth.margin == 0 ? 1 : 0;
    }
    EXPECT_GT(hits, 1'000);
    EXPECT_GT(ties, 10'000);
}

// pbrt-v4, shapes_test.cpp, Triangle.BadCases: collinear vertices. And rays in the plane, edges and corners.
TEST(Oracle, TriangleLimits) {
    const float x = -1113.45459f, z = -56.2431908f;
    EXPECT_FALSE(
        triangle({x, -79.049614f, z}, {x, -87.0922699f, z}, {x, -79.2090149f, z},
                 {{-1081.47925f, 99.9999542f, 87.7701111f}, {-32.1072998f, -183.355865f, -144.607635f}})
            .hit);
    const auto hit = [](const dvec3& o, const dvec3& d) {
        return triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {o, d}).hit;
    };
    EXPECT_FALSE(hit({-1, .5, 0}, {1, 0, 0}));
    EXPECT_FALSE(hit({-1, 0, 0}, {1, 0, 0}));
    EXPECT_TRUE(hit({-1, .25, 1.25e-7}, {1, 0, -1e-7}));
    EXPECT_TRUE(hit({.5, 0, 1}, {0, 0, -1}));
    EXPECT_TRUE(hit({0, 0, 1}, {0, 0, -1}));
    EXPECT_FALSE(hit({.5, -0x1p-1074, 1}, {0, 0, -1}));
    EXPECT_FALSE(hit({.25, .25, 0}, {0, 0, -1}));  // t = 0
    EXPECT_TRUE(hit({.25, .25, 0x1p-1074}, {0, 0, -1}));
    EXPECT_FALSE(hit({.25, .25, 1}, {0, 0, 1}));
}

TEST(Oracle, PlanesAndDiscs) {
    EXPECT_NEAR(plane(dvec3(0), {0, 1, 0}, {{0, 1, 0}, {1, -1e-7f, 0}}).t, 9999999.883139, 1e-6);
    EXPECT_FALSE(plane(dvec3(0), {0, 1, 0}, {{0, 1, 0}, {1, 0, 0}}).hit);
    EXPECT_FALSE(plane(dvec3(0), {0, 1, 0}, {{0, 0, 0}, {1, -1, 0}}).hit);
    const auto rim = [](double x) { return disc({0, 0, 0}, {0, 0, 3}, 1, {{x, 0, 5}, {0, 0, -1}}); };
    EXPECT_TRUE(rim(1).hit);
    EXPECT_FALSE(rim(1 + 0x1p-52).hit);
    EXPECT_EQ(rim(0.5).t, 5);
    EXPECT_EQ(rim(0.5).normal, dvec3(0, 0, 1));
    EXPECT_EQ(rim(1).margin, 0);
}

// Haines, "Point in Polygon Strategies", Graphics Gems IV, 1994: rays level with vertices.
TEST(Oracle, PolygonsByParity) {
    const std::vector<dvec3> shape = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
    for (const dvec3& d : {dvec3(0, 0, -1), dvec3(0.5, 0.25, -1), dvec3(4, -1, -0.5), dvec3(-1, 8, -2)}) {
        const auto inside = [&](double x, double y) {
            return polygon(shape, dvec3(0), {0, 0, 1}, {dvec3(x, y, 0) - d, d}).hit;
        };
        EXPECT_TRUE(inside(1.5, .5));
        EXPECT_FALSE(inside(1.5, 1.5));
        EXPECT_TRUE(inside(.5, 1));
        EXPECT_TRUE(inside(.5, 1.5));
        EXPECT_FALSE(inside(3, 1));
        EXPECT_FALSE(inside(-1, 2));
    }
}

TEST(Oracle, Boxes) {
    const auto hit = [](const dvec3& o, const dvec3& d) { return box({0, 0, 0}, {1, 1, 1}, {o, d}); };
    EXPECT_TRUE(hit({0, .5, -1}, {0, 0, 1}));
    EXPECT_TRUE(hit({0, .5, -1}, {-0.0, 0, 1}));
    EXPECT_FALSE(hit({1.0000001, .5, -1}, {0, 0, 1}));
    EXPECT_TRUE(hit({.5, .5, .5}, {0, 0, 1e-300}));
    EXPECT_FALSE(hit({.5, .5, .5}, {0, 0, 0}));
    EXPECT_TRUE(hit({2, 2, 2}, {-1, -1, -1}));
    EXPECT_TRUE(hit({-1, 0, 1}, {1, 1, -1}));         // to the corner (0, 1, 0)
    EXPECT_FALSE(hit({-1, 0x1p-52, 1}, {1, 1, -1}));  // past it
    EXPECT_FALSE(hit({.5, .5, 2}, {0, 0, 1}));        // behind
    EXPECT_TRUE(box({0, 0, 0}, {1, 1, 0}, {{.5, .5, 1}, {0, 0, -1}}));
    EXPECT_FALSE(box({1, 1, 1}, {0, 0, 0}, {{.5, .5, 2}, {0, 0, -1}}));
}

// tests/stability/cases.md T50, T51, T54, T55: one root where A = 0, two far apart beside it.
TEST(Oracle, QuadricRoots) {
    const double hyperboloid[10] = {1, 1, -1, 0, 0, 0, 0, 0, 0, -1};
    const Roots one = quadric(hyperboloid, {{-2, 0, 0}, {1, 0, 1}});
    ASSERT_EQ(one.count, 1);
    EXPECT_EQ(one.t[0], 0.75);
    const Roots two = quadric(hyperboloid, {{-2, 0, 0}, {1, 0, 1 + 0x1p-23}});
    ASSERT_EQ(two.count, 2);
    EXPECT_NEAR(two.t[0], -16777215.75, 1e-2);
    EXPECT_NEAR(two.t[1], 0.749999966, 1e-9);
    const double trough[10] = {1, 0, 0, 0, 0, 0, 0, 0, -1, 0};  // x^2 = z
    EXPECT_EQ(quadric(trough, {{.5, 3, 10}, {0, 0, -1}}).t[0], 9.75);
    EXPECT_NEAR(quadric(trough, {{0, 0, 4}, {1, 0, -1}}).t[1], 1.5615528128088303, kUlp);
    const double doublePlane[10] = {1};
    EXPECT_EQ(quadric(doublePlane, {{-5, 0, 0}, {1, 0, 0}}).count, 1);
    EXPECT_EQ(quadric(doublePlane, {{-5, 0, 0}, {1, 0, 0}}).t[0], 5);
    const double imaginary[10] = {1, 1, 1, 0, 0, 0, 0, 0, 0, 1};
    EXPECT_EQ(quadric(imaginary, {{0, 0, 5}, {0, 0, -1}}).count, 0);
}

TEST(Tally, CountsAndQuantiles) {
    Tally tally;
    Truth hit, miss;
    hit.hit = true;
    hit.t = 2;
    hit.margin = miss.margin = 1;
    for (int i = 0; i < 100; ++i) tally.add(hit, 0.5, true, 2 + 2e-3 * i);
    tally.add(hit, 0.5, false, 0);
    tally.add(miss, 0.5, true, 1);
    miss.margin = 0.4;
    tally.add(miss, 0.5, true, 1);
    EXPECT_EQ(tally.rays, 103u);
    EXPECT_EQ(tally.hits, 101u);
    EXPECT_EQ(tally.wrong(), 2u);
    EXPECT_EQ(tally.inBand, 1u);
    EXPECT_EQ(tally.wrongInBand, 1u);
    EXPECT_NEAR(Tally::quantile(tally.tErrors, 0.5), 0.049, 1e-12);
    EXPECT_NEAR(Tally::quantile(tally.tErrors, 1), 0.099, 1e-12);
}

}  // namespace glint::oracle::oracle_test
