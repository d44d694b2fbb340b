// Checks that the parts of the validation share; internal to it.
#pragma once

#include <cmath>
#include <string>

#include "core/text_file.h"
#include "core/vectors.h"
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

inline void checkPoint(const Place& place, std::string_view key, const glm::dvec3& point) {
    if (!isFinite(point)) place.fail(key, "must be finite" + got(point));
    if (greatestMagnitude(point) >= kMaxCoordinate)
        place.fail(key, "coordinates must be below " + describe(kMaxCoordinate) + got(point));
}

// Both ends are in the range; `unit` follows the greatest number.
inline void checkRange(const Place& place, std::string_view key, double value, double least, double most,
                       const std::string& unit = "") {
    if (!(value >= least && value <= most))
        place.fail(key, "must be from " + describe(least) + " to " + describe(most) + unit + got(value));
}

// One for each shape that is a quadric.
void checkQuadric(const QuadricShape& shape, const Place& place);
void checkQuadric(const EllipsoidShape& shape, const Place& place);
void checkQuadric(const CylinderShape& shape, const Place& place);
void checkQuadric(const ConeShape& shape, const Place& place);
void checkQuadric(const HyperboloidShape& shape, const Place& place);
void checkQuadric(const ParaboloidShape& shape, const Place& place);

}  // namespace glint
