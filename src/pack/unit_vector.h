#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <optional>

namespace glint {

// v / |v|, for any finite vector but 0: scaled first, so that its square neither overflows nor vanishes.
inline std::optional<glm::dvec3> unitVector(const glm::dvec3& v) {
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) return std::nullopt;
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (largest == 0) return std::nullopt;
    const glm::dvec3 scaled = v / largest;
    return scaled / glm::length(scaled);
}

}  // namespace glint
