// Checks that the parts of the validation share; internal to it.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "core/text_file.h"
#include "scene/limits.h"
#include "scene/scene.h"
#include "scene/validate.h"

namespace glint {

inline std::string text(const glm::dvec3& v) {
    const std::string x = describe(v.x), y = describe(v.y), z = describe(v.z);
    return '[' + x + ", " + y + ", " + z + ']';
}

inline std::string got(const std::string& what) {
    return " (got " + what + ")";
}
inline std::string got(double number) {
    return got(describe(number));
}
inline std::string got(const glm::dvec3& v) {
    return got(text(v));
}

inline bool finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

inline double greatest(const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

inline void checkPoint(const Place& place, std::string_view key, const glm::dvec3& point) {
    if (!finite(point)) place.fail(key, "must be finite" + got(point));
    if (greatest(point) >= kMaxCoordinate)
        place.fail(key, "coordinates must be below " + describe(kMaxCoordinate) + got(point));
}

// One for each shape that is a quadric.
void checkQuadric(const QuadricShape& shape, const Place& place);
void checkQuadric(const EllipsoidShape& shape, const Place& place);
void checkQuadric(const CylinderShape& shape, const Place& place);
void checkQuadric(const ConeShape& shape, const Place& place);
void checkQuadric(const HyperboloidShape& shape, const Place& place);
void checkQuadric(const ParaboloidShape& shape, const Place& place);

}  // namespace glint
