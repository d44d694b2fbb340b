// Scenes and rays at the ends of what double and fp32 hold: what is answered are numbers, and what is sure is
// right.
#include <cmath>
#include <glm/glm.hpp>
#include <vector>

#include "support.h"

namespace glint::library::test {
namespace {

class LibraryExtremes : public LibraryTest {};

bool isNumber(const D3& v) {
    return std::isfinite(v[0] + v[1] + v[2]);
}

// Directions whose squares double cannot hold: a sphere is not missed for sure.
TEST_F(LibraryExtremes, SpheresAreMetByDirectionsOfAnyLength) {
    addJson(scene(), R"({"objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}]})");
    commit();
    const std::vector<double> lengths = {1, 1e-100, 1e100, 1e-200, 1e155, 1e200, 1e253, 1e-280, 1e307};
    RayList rays;
    for (const double length : lengths) {
        rays.add({0.25, 0, 5}, {0, 0, -length});
        rays.add({1.25, 0, 5}, {0, 0, -length});
    }
    const Found all = closest(rays.rays(), true);
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
            const glm::dvec3 wide = far[1] == 0 ? glm::dvec3(along, 0.125, 0) : glm::dvec3(-1e-10, 2e-10, 0);
            addMesh<D3>({far, {0, 0, 0}, wide});
            commit();
            const glm::dvec3 normal = glm::normalize(glm::cross(-far, wide));
            const glm::dvec3 from = (wide + 1e-17 * far) / 3.0 + normal;
            const std::vector<D3> origins = {from}, directions = {-normal};
            const Found all = closest(raysFrom(origins, directions), true);
            ASSERT_EQ(all.hit[0], 1) << far.x << " " << along;
            EXPECT_LT(glm::length(all.normal[0] - normal), 1e-6) << far.x << " " << along;
            EXPECT_TRUE(isNumber(all.point[0]));
        }
    }
}

// From where squares of coordinates overflow: no points that are no numbers.
TEST_F(LibraryExtremes, RaysFromBeyondAllScenesMiss) {
    addSpheres(scene(), {{0, 0, -4}}, {1});
    commit();
    RayList rays;
    for (const double far : {1e151, 1e160, 1e200, 1e293})
        rays.add({far, 2 * far, 3 * far}, {-far, -2 * far, -3 * far});
    for (const bool certified : {false, true}) {
        const Found all = closest(rays.rays(), certified);
        for (size_t i = 0; i < rays.size(); ++i) {
            EXPECT_EQ(all.hit[i], 0) << rays.origins[i].x;
            EXPECT_TRUE(isNumber(all.point[i]) && isNumber(all.normal[i])) << rays.origins[i].x;
        }
    }
}

// Too short for any t: certified or not, on whichever device.
TEST_F(LibraryExtremes, DirectionsThatAreTooShortAreNone) {
    addMesh<D3>({{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}});
    commit();
    const std::vector<D3> origins(3, D3{0, 0, 5}),
        directions = {{0, 0, -1e-289}, {0, 0, -1e-300}, {0, 0, -5e-324}};
    EXPECT_EQ(any(raysFrom(origins, directions)), (std::vector<uint8_t>{1, 0, 0}));
    for (const bool certified : {false, true}) {
        const Found all = closest(raysFrom(origins, directions), certified);
        EXPECT_EQ(all.hit, (std::vector<uint8_t>{1, 0, 0})) << certified;
        EXPECT_NEAR(all.t[0] / 5e289, 1, 1e-6) << certified;
        if (certified) {
            EXPECT_EQ(all.sure, (std::vector<uint8_t>{1, 1, 1}));
        }
    }
}

}  // namespace
}  // namespace glint::library::test
