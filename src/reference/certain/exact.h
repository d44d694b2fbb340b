// Which of several triangles and planes a ray meets first, in whole numbers: nothing is rounded but the
// bounds of the answer, outwards.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "scene/scene.h"
#include "trace/ray_batch.h"

namespace glint::reference::certain {

struct ExactSurface {
    std::array<glm::dvec3, 3> corners{};  // of a triangle
    const Affine* place = nullptr;        // from their coordinates to the world
    const PlaneShape* plane = nullptr;    // if it is one
    uint32_t id = 0;                      // of surfaces met at the same t, the one with the lowest is taken
};

struct ExactHit {
    size_t surface = 0;           // of those given
    double lower = 0, upper = 0;  // neighbouring doubles, or the same, with the exact t between them
    double u = 0, v = 0;
};

// The first within max(tMin, 0) < t <= tMax, or nothing. A triangle is met in its edges and corners too, and
// by no ray that runs in its plane, as a plane is by none that is parallel. All numbers must be finite but
// tMax, and the direction not zero.
std::optional<ExactHit> nearestExactly(const WorldRay& ray, std::span<const ExactSurface> surfaces);

}  // namespace glint::reference::certain
