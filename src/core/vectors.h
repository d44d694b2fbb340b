// Sizes and directions of vectors.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <optional>

namespace glint {

// The greatest magnitude among the coordinates.
inline double greatestMagnitude(const glm::dvec3& v) {
    return std::max(std::max(std::abs(v.x), std::abs(v.y)), std::abs(v.z));
}

inline bool isFinite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// The box around points, axis by axis.
struct BoundingBox {
    glm::dvec3 lo{std::numeric_limits<double>::infinity()};
    glm::dvec3 hi{-std::numeric_limits<double>::infinity()};

    bool empty() const { return lo.x > hi.x; }
    void include(const glm::dvec3& point) {
        lo = glm::min(lo, point);
        hi = glm::max(hi, point);
    }
};

// v / |v|, for any finite vector but 0: scaled first, so that its square neither overflows nor vanishes.
inline std::optional<glm::dvec3> unitVector(const glm::dvec3& v) {
    const double largest = greatestMagnitude(v);
    if (!isFinite(v) || largest == 0) return std::nullopt;
    const glm::dvec3 scaled = v / largest;
    return scaled / glm::length(scaled);
}

}  // namespace glint
