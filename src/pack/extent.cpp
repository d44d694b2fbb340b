#include "pack/extent.h"

#include <algorithm>
#include <cmath>

namespace glint {

double largestComponent(const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

glm::dvec3 nearestOnPlane(const glm::dvec3& from, const glm::dvec3& point, const glm::dvec3& normal) {
    return from - glm::dot(from - point, normal) * normal;
}

void Extent::include(const glm::dvec3& p) {
    if (!(largestComponent(p) <= std::numeric_limits<float>::max())) return;
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
}

void Extent::include(const Extent& other) {
    lo = glm::min(lo, other.lo);
    hi = glm::max(hi, other.hi);
}

double Extent::halfSize() const {
    return largestComponent(0.5 * hi - 0.5 * lo);
}

glm::dvec3 planeAnchor(const glm::dvec3& point, const glm::dvec3& normal, const Extent& extent) {
    constexpr double kMuchFarther = 16;
    const glm::dvec3 center = extent.center();
    const glm::dvec3 nearest = nearestOnPlane(center, point, normal);
    const double needed = std::max(extent.halfSize(), glm::distance(nearest, center));
    return glm::distance(point, center) > kMuchFarther * needed ? nearest : point;
}

}  // namespace glint
