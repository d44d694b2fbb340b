// The plane of a polygon, and when there is none.
#include "scene/polygon_plane.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace glint::test::polygon_plane_test {

using glm::dvec3;

const std::vector<dvec3> kL = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};

TEST(PolygonPlane, ConcaveReversedAndFarAway) {
    const auto plane = polygonPlane(kL);
    ASSERT_TRUE(plane);
    EXPECT_EQ(plane->normal, dvec3(0, 0, 1));
    EXPECT_EQ(plane->deviation, 0);
    EXPECT_NEAR(glm::length(plane->point - dvec3(1, 1, 0)), 0, 1e-15);  // sums 6 and 6 over 6 vertices
    EXPECT_EQ(polygonPlane(std::vector<dvec3>(kL.rbegin(), kL.rend()))->normal, dvec3(0, 0, -1));
    std::vector<dvec3> far = kL;
    for (dvec3& v : far) v += dvec3(1e12, -1e12, 3);
    EXPECT_EQ(polygonPlane(far)->normal, dvec3(0, 0, 1));
}

// Collinear and repeated vertices add nothing to the sum.
TEST(PolygonPlane, NeedlessVerticesChangeNothing) {
    const std::vector<dvec3> more = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0},
                                     {1, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}};
    EXPECT_EQ(polygonPlane(more)->normal, dvec3(0, 0, 1));
}

// Points of a line as decimals: none of them lies on it in binary.
TEST(PolygonPlane, NoneWithoutArea) {
    for (const double scale : {1e-9, 1.0, 1e9}) {
        for (const dvec3& offset : {dvec3(0), dvec3(100.1, -0.3, 1e7)}) {
            std::vector<dvec3> line;
            for (const double t : {0.1, 0.3, 0.7, 0.2, 0.9})
                line.push_back(scale * (offset + t * dvec3(0.1, 0.7, -0.3)));
            EXPECT_FALSE(polygonPlane(line)) << scale;
            line.back() += scale * dvec3(1e-3, 0, 0);
            EXPECT_TRUE(polygonPlane(line)) << scale;
        }
    }
    EXPECT_FALSE(polygonPlane(std::vector<dvec3>{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}));
}

// Newell's sum vanishes, or rounding is all that is left of it, or it is so small that its direction says
// little: the plane is that of three corners all the same.
TEST(PolygonPlane, BowTies) {
    const std::vector<dvec3> bow = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
    EXPECT_EQ(polygonPlane(bow)->normal, dvec3(0, 0, 1)) << "at its first vertex it turns left";
    EXPECT_EQ(polygonPlane(std::vector<dvec3>(bow.rbegin(), bow.rend()))->normal, dvec3(0, 0, -1));
    const dvec3 u(0.6, 0.48, 0.64), v(-0.8, 0.36, 0.48), n = glm::cross(u, v);
    for (const double size : {1e-3, 1.0, 1e3}) {
        for (const double more : {0.0, 1e-12, 1e-7, 1e-3}) {  // by how much the right half is larger
            std::vector<dvec3> tilted, single;
            for (const glm::dvec2 p :
                 {glm::dvec2(-1, -1), glm::dvec2(1, 1 + more), glm::dvec2(1, -1), glm::dvec2(-1, 1)}) {
                tilted.push_back(size * (dvec3(0.1, 0.7, -0.3) + p.x * u + p.y * v));
                single.push_back(dvec3(glm::vec3(tilted.back())));
            }
            for (const auto& vertices : {tilted, single}) {
                const auto plane = polygonPlane(vertices);
                ASSERT_TRUE(plane);
                EXPECT_LE(plane->deviation, planarTolerance(vertices)) << size << ' ' << more;
                const double front = more > 1e-5 ? -1 : 1;  // what is on the right is clockwise
                EXPECT_GT(front * glm::dot(plane->normal, n), 1 - 1e-9) << size << ' ' << more;
            }
        }
    }
    // Four points in space whose sum vanishes are no polygon: the plane of three leaves the fourth far off.
    const std::vector<dvec3> skew = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 1}};
    EXPECT_GT(polygonPlane(skew)->deviation, 0.1);
}

// A regular ring with one vertex raised by h: its plane is off by no more than h there, and the raised vertex
// is the farthest one from it.
TEST(PolygonPlane, DeviationNamesTheVertex) {
    std::vector<dvec3> ring;
    for (int i = 0; i < 12; ++i)
        ring.emplace_back(std::cos(i * std::numbers::pi / 6), std::sin(i * std::numbers::pi / 6), 0);
    ring[7].z = 0.01;
    const auto plane = polygonPlane(ring);
    EXPECT_EQ(plane->farthest, 7u);
    EXPECT_GT(plane->deviation, 0.005);
    EXPECT_LT(plane->deviation, 0.01);
}

// A tilted polygon in fp32 or with six decimals passes, one that is bent by 1e-4 does not.
TEST(PolygonPlane, ToleranceCoversRoundedCoordinates) {
    for (const double size : {1e-3, 1.0, 1e3}) {
        std::vector<dvec3> exact, single, decimal;
        for (int i = 0; i < 40; ++i) {
            const double a = i * std::numbers::pi / 20;
            exact.push_back(size * (dvec3(3, -2, 5) + std::cos(a) * dvec3(0.6, 0.48, 0.64) +
                                    std::sin(a) * dvec3(-0.8, 0.36, 0.48)));
            single.push_back(dvec3(glm::vec3(exact.back())));
            dvec3 d = exact.back();
            for (int k = 0; k < 3; ++k) {
                char text[32];
                std::snprintf(text, sizeof(text), "%g", d[k]);
                d[k] = std::atof(text);
            }
            decimal.push_back(d);
        }
        EXPECT_LT(polygonPlane(exact)->deviation, 1e-14 * size);
        EXPECT_LT(polygonPlane(single)->deviation, planarTolerance(single));
        EXPECT_LT(polygonPlane(decimal)->deviation, planarTolerance(decimal));
        exact[3] += 1e-4 * size * dvec3(0, 0.8, -0.6);
        EXPECT_GT(polygonPlane(exact)->deviation, planarTolerance(exact));
    }
}

}  // namespace glint::test::polygon_plane_test
