#pragma once

#include <glm/glm.hpp>

namespace glint {

// (v1 - v0) x (v2 - v0): along the triangle's normal, as long as twice its area. Exactly zero if and only if
// the three points, as rounded, are collinear or coincide; otherwise every component is within 2^-28 of the
// largest one's magnitude, whatever the triangle's shape, so that a needle's normal is as good in fp32 as any
// other's.
glm::dvec3 areaVector(const glm::vec3& v0, const glm::vec3& v1, const glm::vec3& v2);

}  // namespace glint
