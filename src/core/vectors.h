// Sizes of vectors.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace glint {

// The greatest magnitude among the coordinates.
inline double greatestMagnitude(const glm::dvec3& v) {
    return std::max(std::max(std::abs(v.x), std::abs(v.y)), std::abs(v.z));
}

inline bool isFinite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace glint
