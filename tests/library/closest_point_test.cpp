// Closest points: closed forms, and brute force by a formula that neither tracer uses.
#include <algorithm>

#include "closed_meshes.h"

namespace glint::library::test {
namespace {

using glm::dvec3;

// Distance to the segment, or the plane where the point's foot is within the triangle.
double distanceToTriangle(const dvec3& p, const dvec3 (&corner)[3]) {
    const dvec3 n = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
    double least = std::numeric_limits<double>::infinity();
    bool within = true;
    for (int i = 0; i < 3; ++i) {
        const dvec3 a = corner[i], edge = corner[(i + 1) % 3] - a;
        const double part = std::clamp(glm::dot(p - a, edge) / glm::dot(edge, edge), 0.0, 1.0);
        least = std::min(least, glm::length(p - a - part * edge));
        within = within && glm::dot(glm::cross(n, edge), p - a) >= 0;
    }
    return within ? std::abs(glm::dot(p - corner[0], n)) / glm::length(n) : least;
}

class LibraryClosestPoint : public LibraryTest {
  protected:
    // t is the distance.
    Found closest(const std::vector<D3>& points) {
        Found found;
        glint_hits hits = found.outputs(points.size());
        hits.origin = {};
        const glint_view given = viewOf(points);
        EXPECT_OK(glint_query_closest_point(scene(), &given, &hits, nullptr));
        return found;
    }
    static std::vector<D3> pointsAbout(double center, double reach, size_t count) {
        Random random(11);
        std::vector<D3> points(count);
        for (D3& p : points) {
            const D3 unit = {random.uniform(), random.uniform(), random.uniform()};
            p = center + reach * (2.0 * unit - 1.0);
        }
        return points;
    }
    // Error bound of a device for coordinates of this size.
    static double slack(double size) { return kOnDevice ? 0x1p-20 * size : 0x1p-45 * size; }
};

// Faces, edges, corners, inside and far away.
TEST_F(LibraryClosestPoint, IsRightOnACube) {
    const Closed cube = gridCube(3);
    addMesh(cube.vertices, cube.corners);
    commit();
    std::vector<D3> points = {{0, 0, 0}, {1, 1, 1}, {1, 0.3, 1}, {2, 2, 2}, {1e6, 3, -0.2}, {1, 5, -1}};
    for (const double reach : {1.5, 100.0})
        for (const D3& p : pointsAbout(0, reach, 500)) points.push_back(p);
    const Found found = closest(points);
    for (size_t i = 0; i < points.size(); ++i) {
        const dvec3 p = points[i], onCube = glm::clamp(p, dvec3(-1), dvec3(1));
        const double inside = 1 - std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        const double expected = inside > 0 ? inside : glm::length(p - onCube);
        EXPECT_NEAR(found.t[i], expected, slack(glm::length(p) + 2)) << i;
        EXPECT_NEAR(glm::length(found.point[i] - p), found.t[i], 1e-12 * (1 + expected));
        if (inside < 0) {
            EXPECT_LE(glm::length(found.point[i] - onCube), slack(8 * glm::length(p))) << i;
        }
    }
}

// Rounding decides where in a triangle this thin the foot lies, but not how far away.
TEST_F(LibraryClosestPoint, IsRightOnANeedle) {
    addMesh<F3>({{-0.747425318f, -0.685778677f, -0.0796350986f},
                 {0.942118704f, 0.723072708f, 0.977566719f},
                 {-0.316627562f, -0.326551557f, 0.189928859f}},
                {{0, 1, 2}});
    commit();
    EXPECT_NEAR(closest({{0.236269922f, 0.256795378f, 1.25504672f}}).t[0], 0.6213997933345172, slack(2));
}

TEST_F(LibraryClosestPoint, IsRightOnSpheres) {
    addSpheres(scene(), {{0, 0, 0}, {5, 0, 0}}, {1, 2});
    commit();
    std::vector<D3> points = pointsAbout(2, 5, 500);
    points.push_back({0, 0, 0});
    const Found found = closest(points);
    for (size_t i = 0; i < points.size(); ++i) {
        const double a = std::abs(glm::length(points[i]) - 1);
        const double b = std::abs(glm::length(points[i] - dvec3(5, 0, 0)) - 2);
        EXPECT_NEAR(found.t[i], std::min(a, b), slack(8)) << i;
        if (std::abs(a - b) > slack(8)) {
            EXPECT_EQ(found.geometry[i], a < b ? 0u : 1u) << i;
        }
        EXPECT_NEAR(glm::length(found.normal[i]), 1, 1e-6);
    }
}

// A bumpy mesh, and once more as a mirrored and sheared instance, far from 0 as well.
TEST_F(LibraryClosestPoint, AgreesWithBruteForce) {
    const Closed mesh = bumpy();
    const double matrix[12] = {0.5, 0.2, 0, 9, 0, -0.7, 0.1, 3, 0.1, 0, 1.5, -4};
    for (const double place : {0.0, 1000.0}) {
        useScene(nullptr);
        const std::vector<D3> first = mesh.movedBy(place);
        const uint32_t geometry = addMesh(first, mesh.corners);
        ASSERT_OK(glint_scene_add_instance(scene(), geometry, matrix, nullptr));
        commit();
        std::vector<D3> vertices[2] = {first, {}};
        for (const D3& v : first) vertices[1].push_back(moved(matrix, v));
        std::vector<D3> points = pointsAbout(place, 12, 200);
        for (size_t i = 0; i < 40; ++i) points.push_back(first[i]);
        const Found found = closest(points);
        for (size_t i = 0; i < points.size(); ++i) {
            const auto distance = [&](size_t g, size_t triangle) {
                const U3& c = mesh.corners[triangle];
                return distanceToTriangle(points[i],
                                          {vertices[g][c[0]], vertices[g][c[1]], vertices[g][c[2]]});
            };
            double least = std::numeric_limits<double>::infinity();
            for (size_t g = 0; g < 2; ++g)
                for (size_t k = 0; k < mesh.corners.size(); ++k) least = std::min(least, distance(g, k));
            // Vertices are rounded to fp32 about the scene's own origin.
            const double rounding = 0x1p-20 * (place == 0 ? 20 : 2000);
            EXPECT_NEAR(found.t[i], least, rounding) << i << " at " << place;
            EXPECT_NEAR(distance(found.geometry[i] == geometry ? 0 : 1, found.primitive[i]), least, rounding);
        }
    }
}

// All triangles are about as far from the centre: more trips than a dispatch makes.
TEST_F(LibraryClosestPoint, IsRightWhereAllTrianglesCount) {
    const Closed cube = gridCube(80);
    std::vector<D3> vertices;
    for (const D3& v : cube.vertices) vertices.push_back(glm::normalize(v));
    addMesh(vertices, cube.corners);
    commit();
    double least = 1;
    for (const U3& c : cube.corners)
        least =
            std::min(least, distanceToTriangle(dvec3(0), {vertices[c[0]], vertices[c[1]], vertices[c[2]]}));
    EXPECT_NEAR(closest({{0, 0, 0}}).t[0], least, 0x1p-22);  // vertices are fp32
}

TEST_F(LibraryClosestPoint, HasLimitsThatItNames) {
    const Closed cube = gridCube(1);
    addMesh(cube.vertices, cube.corners);
    commit();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Found found = closest({{nan, 0, 0}, {1e19, 0, 0}, {1e17, 0, 0}});
    EXPECT_EQ(found.hit, (std::vector<uint8_t>{0, 0, 1}));
    EXPECT_EQ(found.primitive[0], GLINT_NONE);
    EXPECT_EQ(found.t[2], 1e17);
    addJson(scene(), R"({"materials": {"m": {}}, "objects": [{"type": "disc",
                                       "center": [0, 0, 0], "normal": [0, 1, 0], "radius": 1, "material": "m"}]})");
    commit();
    const std::vector<D3> points = {{0, 0, 0}};
    std::vector<double> t(1);
    GLINT_INIT(glint_hits, hits);
    hits.t = outOf(t);
    const glint_view given = viewOf(points);
    refused(glint_query_closest_point(scene(), &given, &hits, nullptr), "disc");
}

}  // namespace
}  // namespace glint::library::test
