// How far a hit point may be off where it is found in fp32 (docs/design/numerics.md 2.9): a box
// around it, from whose edge the rays begin that leave the point. In the coordinates of the primitive, until
// an instance takes the point into the world.
#pragma once

#include <glm/glm.hpp>

#include "reference/rounding.h"

namespace glint::reference {

// The relative error of n roundings.
constexpr double gammaOf(double n) {
    return n * kFloatUnit / (1 - n * kFloatUnit);
}

// Error box of a point that is formed as an anchor plus an offset on the surface.
inline glm::dvec3 errorBox(const glm::dvec3& offset, const glm::dvec3& anchor) {
    return gammaOf(7) * (glm::abs(offset) + glm::abs(anchor));
}

// How far along the unit normal of its surface a ray begins from a point.
inline double clearanceOf(const glm::dvec3& error, const glm::dvec3& normal) {
    return glm::dot(glm::abs(normal), error);
}

}  // namespace glint::reference
