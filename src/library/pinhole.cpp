// Rays of a pinhole camera that is given by matrices, as computer vision has it.
#include <array>
#include <cmath>
#include <glm/glm.hpp>

#include "library/status.h"
#include "library/views.h"

using namespace glint::library;

// The inverse of the upper triangular matrix of the lens, and the transposed rotation.
glint_status glint_pinhole_rays(const double intrinsics[9], const double extrinsics[12], uint32_t width,
                                uint32_t height, double origin[3], const glint_out* directions) {
    return guarded([&] {
        require(intrinsics != nullptr && extrinsics != nullptr, "glint_pinhole_rays: a matrix is NULL");
        require(directions != nullptr, "glint_pinhole_rays: directions is NULL");
        const auto [fx, skew, cx] = std::array{intrinsics[0], intrinsics[1], intrinsics[2]};
        const double fy = intrinsics[4], cy = intrinsics[5];
        require(std::isfinite(1 / fx) && std::isfinite(1 / fy), "glint_pinhole_rays: a focal length is 0");
        require(intrinsics[3] == 0 && intrinsics[6] == 0 && intrinsics[7] == 0 && intrinsics[8] == 1,
                "glint_pinhole_rays: intrinsics is not [fx, skew, cx; 0, fy, cy; 0, 0, 1]");
        const Output out(*directions, Output::Kind::Real, 3, uint64_t{width} * height, "directions");
        // Rows of the rotation are its transpose's columns.
        glm::dmat3 toWorld;
        glm::dvec3 shift;
        for (int row = 0; row < 3; ++row) {
            toWorld[row] = {extrinsics[4 * row], extrinsics[4 * row + 1], extrinsics[4 * row + 2]};
            shift[row] = extrinsics[4 * row + 3];
        }
        const glm::dvec3 place = -(toWorld * shift);
        for (int axis = 0; origin != nullptr && axis < 3; ++axis) origin[axis] = place[axis];
        for (uint32_t y = 0; y < height && out.wanted(); ++y) {
            const double down = (y + 0.5 - cy) / fy;
            for (uint32_t x = 0; x < width; ++x)
                out.put(uint64_t{y} * width + x,
                        toWorld * glm::dvec3((x + 0.5 - cx - skew * down) / fx, down, 1));
        }
    });
}
