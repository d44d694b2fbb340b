// Scenes and rays at the ends of what double and fp32 hold: what is answered are numbers, and what is sure is
// right.
#include <cmath>
#include <glm/glm.hpp>
#include <vector>

#include "support.h"

namespace glint::library::test {
namespace {

class LibraryExtremes : public LibraryTest {};

// Directions whose squares double cannot hold: a sphere is not missed for sure.
TEST_F(LibraryExtremes, SpheresAreMetByDirectionsOfAnyLength) {
    ASSERT_EQ(glint_scene_add_json(scene(),
                                   R"({"objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}]})",
                                   nullptr, nullptr, nullptr),
              GLINT_OK)
        << glint_last_error();
    commit();
    const std::vector<double> lengths = {1, 1e-100, 1e100, 1e-200, 1e155, 1e200, 1e253, 1e-280, 1e307};
    std::vector<D3> origins, directions;
    for (const double length : lengths) {
        origins.push_back({0.25, 0, 5});
        origins.push_back({1.25, 0, 5});
        directions.insert(directions.end(), 2, {0, 0, -length});
    }
    std::vector<uint8_t> hit(origins.size()), sure(origins.size());
    std::vector<double> ts(origins.size()), lower(origins.size()), upper(origins.size());
    GLINT_INIT(glint_rays, rays);
    rays.origins = viewOf(origins);
    rays.directions = viewOf(directions);
    GLINT_INIT(glint_hits, hits);
    hits.hit = outOf(hit);
    hits.sure = outOf(sure);
    hits.t = outOf(ts);
    hits.t_lower = outOf(lower);
    hits.t_upper = outOf(upper);
    ASSERT_EQ(glint_query_closest(scene(), &rays, &hits, nullptr), GLINT_OK) << glint_last_error();
    for (size_t i = 0; i < lengths.size(); ++i) {
        const double t = (5 - std::sqrt(1 - 0.0625)) / lengths[i];
        EXPECT_EQ(hit[2 * i], 1) << lengths[i];
        EXPECT_NEAR(ts[2 * i] / t, 1, 1e-6) << lengths[i];
        EXPECT_EQ(sure[2 * i], 1) << lengths[i];
        EXPECT_TRUE(lower[2 * i] <= t && t <= upper[2 * i]) << lengths[i];
        EXPECT_EQ(hit[2 * i + 1], 0) << lengths[i];
    }
}

// Needles whose far corner comes first, and a ray from beyond the squares that double can hold: normals and
// points are numbers.
TEST_F(LibraryExtremes, NothingThatIsAnsweredIsNoNumber) {
    const std::vector<D3> needle = {{3e13, 6e14, 2e15}, {0, 0, 0}, {-1e-10, 2e-10, 0}};
    addMesh<double>(needle);
    GLINT_INIT(glint_spheres, spheres);
    const std::vector<D3> centers = {{0, 0, -4}};
    const std::vector<double> radii = {1};
    spheres.centers = viewOf(centers);
    spheres.radii = viewOf(radii);
    ASSERT_EQ(glint_scene_add_spheres(scene(), &spheres, nullptr), GLINT_OK) << glint_last_error();
    commit();
    const glm::dvec3 far = glm::dvec3(needle[0][0], needle[0][1], needle[0][2]),
                     wide = glm::dvec3(needle[2][0], needle[2][1], needle[2][2]);
    const glm::dvec3 normal = glm::normalize(glm::cross(-far, wide)), middle = (wide + 1e-17 * far) / 3.0;
    const glm::dvec3 from = middle + normal;
    const std::vector<D3> origins = {{from.x, from.y, from.z}, {4e293, 6e293, 8e293}};
    const std::vector<D3> directions = {{-normal.x, -normal.y, -normal.z}, {-4e293, -6e293, -8e293}};
    std::vector<uint8_t> hit(2), sure(2);
    std::vector<D3> normals(2), points(2);
    GLINT_INIT(glint_rays, rays);
    rays.origins = viewOf(origins);
    rays.directions = viewOf(directions);
    GLINT_INIT(glint_hits, hits);
    hits.hit = outOf(hit);
    hits.sure = outOf(sure);
    hits.normal = outOf(normals);
    hits.point = outOf(points);
    ASSERT_EQ(glint_query_closest(scene(), &rays, &hits, nullptr), GLINT_OK) << glint_last_error();
    for (int i = 0; i < 2; ++i)
        EXPECT_TRUE(std::isfinite(normals[i][0] + normals[i][1] + normals[i][2] + points[i][0] +
                                  points[i][1] + points[i][2]))
            << i;
    ASSERT_EQ(hit[0], 1);
    EXPECT_LT(glm::length(glm::cross(glm::dvec3(normals[0][0], normals[0][1], normals[0][2]), normal)), 1e-6);
    EXPECT_EQ(hit[1], 0);
}

// Too short for any t: certified or not, on whichever device.
TEST_F(LibraryExtremes, DirectionsThatAreTooShortAreNone) {
    addMesh<double>({{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}});
    commit();
    const std::vector<D3> origins(3, D3{0, 0, 5}),
        directions = {{0, 0, -1e-289}, {0, 0, -1e-300}, {0, 0, -5e-324}};
    std::vector<uint8_t> hit(3), sure(3), any(3);
    std::vector<double> t(3);
    GLINT_INIT(glint_rays, rays);
    rays.origins = viewOf(origins);
    rays.directions = viewOf(directions);
    GLINT_INIT(glint_hits, hits);
    hits.hit = outOf(hit);
    hits.t = outOf(t);
    const glint_out anyOut = outOf(any);
    ASSERT_EQ(glint_query_any(scene(), &rays, &anyOut, nullptr), GLINT_OK) << glint_last_error();
    EXPECT_EQ(any, (std::vector<uint8_t>{1, 0, 0}));
    for (const bool certified : {false, true}) {
        if (certified) hits.sure = outOf(sure);
        ASSERT_EQ(glint_query_closest(scene(), &rays, &hits, nullptr), GLINT_OK) << glint_last_error();
        EXPECT_EQ(hit, (std::vector<uint8_t>{1, 0, 0})) << certified;
        EXPECT_NEAR(t[0] / 5e289, 1, 1e-6) << certified;
    }
    EXPECT_EQ(sure, (std::vector<uint8_t>{1, 1, 1}));
}

}  // namespace
}  // namespace glint::library::test
