// Scenes and rays at the ends of what double and fp32 hold: what is answered are numbers, and what is sure is
// right.
#include <cmath>
#include <glm/glm.hpp>
#include <vector>

#include "support.h"

namespace glint::library::test {
namespace {

struct NearestHits {
    std::vector<uint8_t> hit, sure;
    std::vector<double> t, lower, upper;
    std::vector<glm::dvec3> normals, points;
};

class LibraryExtremes : public LibraryTest {
  protected:
    // Nearest hits; `sure` and bounds where they are certified.
    NearestHits answers(const std::vector<D3>& origins, const std::vector<D3>& directions,
                        bool certified = true) {
        const size_t count = origins.size();
        NearestHits all;
        for (auto* flags : {&all.hit, &all.sure}) flags->resize(count);
        for (auto* numbers : {&all.t, &all.lower, &all.upper}) numbers->resize(count);
        std::vector<D3> normals(count), points(count);
        glint_rays rays = raysFrom(origins, directions);
        GLINT_INIT(glint_hits, hits);
        hits.hit = outOf(all.hit);
        hits.t = outOf(all.t);
        hits.normal = outOf(normals);
        hits.point = outOf(points);
        if (certified) {
            hits.sure = outOf(all.sure);
            hits.t_lower = outOf(all.lower);
            hits.t_upper = outOf(all.upper);
        }
        EXPECT_EQ(glint_query_closest(scene(), &rays, &hits, nullptr), GLINT_OK) << glint_last_error();
        for (const D3& v : normals) all.normals.emplace_back(v[0], v[1], v[2]);
        for (const D3& v : points) all.points.emplace_back(v[0], v[1], v[2]);
        return all;
    }
};

bool isNumber(const glm::dvec3& v) {
    return std::isfinite(v.x + v.y + v.z);
}

// Directions whose squares double cannot hold: a sphere is not missed for sure.
TEST_F(LibraryExtremes, SpheresAreMetByDirectionsOfAnyLength) {
    addJson(scene(), R"({"objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}]})");
    commit();
    const std::vector<double> lengths = {1, 1e-100, 1e100, 1e-200, 1e155, 1e200, 1e253, 1e-280, 1e307};
    std::vector<D3> origins, directions;
    for (const double length : lengths) {
        origins.push_back({0.25, 0, 5});
        origins.push_back({1.25, 0, 5});
        directions.insert(directions.end(), 2, {0, 0, -length});
    }
    const NearestHits all = answers(origins, directions);
    for (size_t i = 0; i < lengths.size(); ++i) {
        const double t = (5 - std::sqrt(1 - 0.0625)) / lengths[i];
        EXPECT_EQ(all.hit[2 * i], 1) << lengths[i];
        EXPECT_NEAR(all.t[2 * i] / t, 1, 1e-6) << lengths[i];
        EXPECT_EQ(all.sure[2 * i], 1) << lengths[i];
        EXPECT_TRUE(all.lower[2 * i] <= t && t <= all.upper[2 * i]) << lengths[i];
        EXPECT_EQ(all.hit[2 * i + 1], 0) << lengths[i];
    }
}

// A needle whose far corner comes first, so that its width is lost beside its length, and two of which the
// first or the second edge is the longest, told in double.
TEST_F(LibraryExtremes, NeedlesHaveNormals) {
    for (const D3& far : {D3{3e13, 6e14, 2e15}, D3{1e8, 0, 0}}) {
        for (const double along : {-0.25, 0.25}) {
            useScene(nullptr);
            const glm::dvec3 tip(far[0], far[1], far[2]);
            const glm::dvec3 wide = far[1] == 0 ? glm::dvec3(along, 0.125, 0) : glm::dvec3(-1e-10, 2e-10, 0);
            addMesh<double>({far, {0, 0, 0}, {wide.x, wide.y, wide.z}});
            commit();
            const glm::dvec3 normal = glm::normalize(glm::cross(-tip, wide));
            const glm::dvec3 from = (wide + 1e-17 * tip) / 3.0 + normal;
            const NearestHits all = answers({{from.x, from.y, from.z}}, {{-normal.x, -normal.y, -normal.z}});
            ASSERT_EQ(all.hit[0], 1) << tip.x << " " << along;
            EXPECT_LT(glm::length(all.normals[0] - normal), 1e-6) << tip.x << " " << along;
            EXPECT_TRUE(isNumber(all.points[0]));
        }
    }
}

// From where squares of coordinates overflow: no points that are no numbers.
TEST_F(LibraryExtremes, RaysFromBeyondAllScenesMiss) {
    addSpheres(scene(), {{0, 0, -4}}, {1});
    commit();
    std::vector<D3> origins, directions;
    for (const double far : {1e151, 1e160, 1e200, 1e293}) {
        origins.push_back({far, 2 * far, 3 * far});
        directions.push_back({-far, -2 * far, -3 * far});
    }
    for (const bool certified : {false, true}) {
        const NearestHits all = answers(origins, directions, certified);
        for (size_t i = 0; i < origins.size(); ++i) {
            EXPECT_EQ(all.hit[i], 0) << origins[i][0];
            EXPECT_TRUE(isNumber(all.points[i]) && isNumber(all.normals[i])) << origins[i][0];
        }
    }
}

// Too short for any t: certified or not, on whichever device.
TEST_F(LibraryExtremes, DirectionsThatAreTooShortAreNone) {
    addMesh<double>({{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}});
    commit();
    const std::vector<D3> origins(3, D3{0, 0, 5}),
        directions = {{0, 0, -1e-289}, {0, 0, -1e-300}, {0, 0, -5e-324}};
    std::vector<uint8_t> any(3);
    glint_rays rays = raysFrom(origins, directions);
    const glint_out anyOut = outOf(any);
    ASSERT_EQ(glint_query_any(scene(), &rays, &anyOut, nullptr), GLINT_OK) << glint_last_error();
    EXPECT_EQ(any, (std::vector<uint8_t>{1, 0, 0}));
    for (const bool certified : {false, true}) {
        const NearestHits all = answers(origins, directions, certified);
        EXPECT_EQ(all.hit, (std::vector<uint8_t>{1, 0, 0})) << certified;
        EXPECT_NEAR(all.t[0] / 5e289, 1, 1e-6) << certified;
        if (certified) {
            EXPECT_EQ(all.sure, (std::vector<uint8_t>{1, 1, 1}));
        }
    }
}

}  // namespace
}  // namespace glint::library::test
