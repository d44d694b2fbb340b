// A split is right if its triangles keep the polygon's winding, add up to its area, use its corners only, and
// do not overlap: for a simple polygon, positive areas that add up to the shoelace area leave no room for an
// overlap.
#include "import/mesh_builder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace glint::polygon_split_test {

using Points = std::vector<glm::dvec3>;
using Triangles = std::vector<std::array<uint32_t, 3>>;

const Points kPentagram = {{0, 1, 0}, {-0.59, -0.81, 0}, {0.95, 0.31, 0}, {-0.95, 0.31, 0}, {0.59, -0.81, 0}};
const Points kBowTie = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};

Triangles split(const Points& points) {
    Triangles triangles;
    splitPolygon(points, triangles);
    return triangles;
}

bool isWhole(const Points& points) {
    Triangles triangles;
    return splitPolygon(points, triangles);
}

double areaOf(const Points& p, const std::array<uint32_t, 3>& t) {
    return 0.5 * glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]).z;
}

double shoelace(const Points& p) {
    double area = 0;
    for (size_t i = 0; i < p.size(); i++) {
        const auto& q = p[(i + 1) % p.size()];
        area += 0.5 * (p[i].x * q.y - p[i].y * q.x);
    }
    return area;
}

// For polygons in the xy plane, counter-clockwise.
void expectTiling(const Points& points) {
    const Triangles triangles = split(points);
    EXPECT_TRUE(isWhole(points));
    ASSERT_EQ(triangles.size(), points.size() - 2);
    double sum = 0;
    for (const auto& t : triangles) {
        for (const uint32_t corner : t) ASSERT_LT(corner, points.size());
        EXPECT_GE(areaOf(points, t), 0);
        sum += areaOf(points, t);
    }
    EXPECT_NEAR(sum, shoelace(points), 1e-12 * std::abs(shoelace(points)));
}

Points comb(int teeth) {
    Points points;
    for (int i = 0; i < teeth; i++) {
        points.push_back({2.0 * i, 0, 0});
        points.push_back({2.0 * i + 1, -10, 0});
    }
    points.push_back({2.0 * teeth, 0, 0});
    points.push_back({2.0 * teeth, 1, 0});
    points.push_back({0, 1, 0});
    return points;
}

// A band wound inwards: the hard case for a search of ears, which are only at its two ends.
Points spiral(int steps) {
    Points outer, inner;
    for (int i = 0; i < steps; i++) {
        const double angle = 0.1 * i, radius = 1 + 0.05 * angle;
        outer.push_back({(radius + 0.1) * std::cos(angle), (radius + 0.1) * std::sin(angle), 0});
        inner.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
    }
    outer.insert(outer.end(), inner.rbegin(), inner.rend());
    return outer;
}

TEST(PolygonSplit, ConvexPolygonsBecomeFans) {
    const Points quad = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    EXPECT_EQ(split(quad), (Triangles{{0, 1, 2}, {0, 2, 3}}));
    const Points pentagon = {{0, 0, 0}, {2, 0, 0}, {3, 1, 0}, {1, 3, 0}, {-1, 1, 0}};
    EXPECT_EQ(split(pentagon), (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
}

TEST(PolygonSplit, ConcaveQuadIsCutAtItsReflexCorner) {
    // An arrowhead with its notch at corner 3 (and, turned round, at corner 0): the only inner diagonal joins
    // 1 and 3.
    const Points arrow = {{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {0.5, 1, 0}};
    expectTiling(arrow);
    for (const auto& t : split(arrow)) {
        EXPECT_TRUE(std::find(t.begin(), t.end(), 1u) != t.end());
        EXPECT_TRUE(std::find(t.begin(), t.end(), 3u) != t.end());
    }
    expectTiling({{0.5, 1, 0}, {0, 0, 0}, {2, 1, 0}, {0, 2, 0}});
}

TEST(PolygonSplit, ConcavePolygonsTile) {
    expectTiling({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}});  // L
    expectTiling({{0, 0, 0}, {4, 0, 0}, {2, 1, 0}, {4, 4, 0}, {0, 4, 0}});             // concave 5-gon
    expectTiling(comb(20));
    expectTiling(spiral(200));
}

TEST(PolygonSplit, CornersOnStraightEdges) {
    expectTiling({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}});
    expectTiling({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}});
}

TEST(PolygonSplit, HoleWithABridge) {
    // A square ring cut open: corners 0 and 4 stand there twice.
    expectTiling({{0, 0, 0},
                  {4, 0, 0},
                  {4, 4, 0},
                  {0, 4, 0},
                  {0, 0, 0},
                  {1, 1, 0},
                  {1, 3, 0},
                  {3, 3, 0},
                  {3, 1, 0},
                  {1, 1, 0}});
}

TEST(PolygonSplit, WindingAndPlaneDoNotMatter) {
    const Points flat = {{0, 0, 0}, {4, 0, 0}, {2, 1, 0}, {4, 4, 0}, {0, 4, 0}};
    for (int axis = 0; axis < 3; axis++) {
        for (const bool reversed : {false, true}) {
            Points points;
            for (const auto& p : flat) {
                glm::dvec3 q;  // the polygon in another coordinate plane, far from the origin
                q[axis] = 1e9 + 0.25;
                q[(axis + 1) % 3] = p.x - 1e9;
                q[(axis + 2) % 3] = p.y + 1e9;
                points.push_back(q);
            }
            if (reversed) std::reverse(points.begin(), points.end());
            double sum = 0;
            for (const auto& t : split(points)) {
                const glm::dvec3 normal =
                    glm::cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]);
                EXPECT_GT(normal[axis] * (reversed ? -1 : 1), 0);
                sum += 0.5 * glm::length(normal);
            }
            EXPECT_DOUBLE_EQ(sum, 12);  // a square of 16 less a notch of base 4 and depth 2
        }
    }
}

TEST(PolygonSplit, ScaleDoesNotMatter) {
    for (const double scale : {1e-160, 1e-20, 1e17, 1e150}) {
        Points points = {{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {0.5, 1, 0}};
        const Triangles expected = split(points);
        for (auto& p : points) p *= scale;
        EXPECT_EQ(split(points), expected) << scale;
    }
}

TEST(PolygonSplit, BadPolygonsEndAndCoverSomething) {
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();
    const Points line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {1.5, 0, 0}};
    const Points point(6, glm::dvec3(1));
    const Points notFinite = {{0, 0, 0}, {nan, 0, 0}, {1, 1, 0}, {inf, 1, 0}, {0, 1, 0}};
    for (const Points& points : {kPentagram, kBowTie, line, point, notFinite}) {
        const Triangles triangles = split(points);
        EXPECT_EQ(triangles.size(), points.size() - 2);
        for (const auto& t : triangles)
            for (const uint32_t corner : t) EXPECT_LT(corner, points.size());
    }
    EXPECT_TRUE(isWhole(line));
    EXPECT_TRUE(isWhole(point));
    EXPECT_TRUE(isWhole(notFinite));
}

// Bow ties with halves of equal area, of which Newell's sum is zero, and of others; in any plane.
TEST(PolygonSplit, PolygonsThatCrossThemselvesAreNoticed) {
    const Points uneven = {{0, 0, 0}, {3, 1, 0}, {3, 0, 0}, {0, 0.1, 0}};
    for (const Points& flat : {kPentagram, kBowTie, uneven})
        for (int axis = 0; axis < 3; axis++) {
            Points points;
            for (const glm::dvec3& p : flat) {
                glm::dvec3 q;
                q[axis] = 0.3 * p.x - 0.7 * p.y;
                q[(axis + 1) % 3] = p.x;
                q[(axis + 2) % 3] = p.y;
                points.push_back(q);
            }
            EXPECT_FALSE(isWhole(points)) << flat.size() << axis;
            std::reverse(points.begin(), points.end());
            EXPECT_FALSE(isWhole(points)) << flat.size() << axis;
        }
}

// CTest ends a search that takes the square of the time.
TEST(PolygonSplit, LargePolygonsAreSplit) {
    expectTiling(spiral(2500));
    Points rays;  // every other corner is an ear, and those between lie about all of them
    for (int i = 0; i < 10000; i++) {
        const double angle = 2 * std::numbers::pi * i / 10000, radius = i % 2 ? 1 : 0.5;
        rays.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
    }
    for (int i = 0; i < 20; i++) expectTiling(rays);
    Points star;  // crosses itself everywhere
    for (int i = 0; i < 5000; i++) {
        const double angle = 2 * std::numbers::pi * 2399 * i / 5000;
        star.push_back({std::cos(angle), std::sin(angle), 0});
    }
    EXPECT_EQ(split(star).size(), star.size() - 2);
}

}  // namespace glint::polygon_split_test
