#include "reference/instance.h"

#include <algorithm>
#include <cmath>

namespace glint::reference {

using glm::dvec3;

InstanceFrame::InstanceFrame(const rows::Instance& instance) : place_(instance.place) {
    const dvec3 rows[3] = {dvec3(instance.toObjectX), dvec3(instance.toObjectY), dvec3(instance.toObjectZ)};
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) toObject_[column][row] = rows[row][column];
    // Cramer's rule: column j of the inverse is the cross product of the other two rows over their volume.
    const double volume = glm::dot(rows[0], glm::cross(rows[1], rows[2]));
    for (int j = 0; j < 3; ++j) toWorld_[j] = glm::cross(rows[(j + 1) % 3], rows[(j + 2) % 3]) / volume;
}

Ray InstanceFrame::enterInstance(const Ray& ray) const {
    Ray inside = ray;
    inside.origin = toObject_ * (ray.origin - place_);
    inside.direction = toObject_ * ray.direction;
    return inside;
}

dvec3 InstanceFrame::pointInWorld(const dvec3& point) const {
    return toWorld_ * point + place_;
}

dvec3 InstanceFrame::normalInWorld(const dvec3& normal) const {
    return glm::normalize(glm::transpose(toObject_) * normal);
}

double InstanceFrame::scaleInWorld(double size) const {
    double greatest = 0;
    for (int row = 0; row < 3; ++row)
        greatest = std::max(greatest, size * (std::abs(toWorld_[0][row]) + std::abs(toWorld_[1][row]) +
                                              std::abs(toWorld_[2][row])) +
                                          std::abs(place_[row]));
    return greatest;
}

double InstanceFrame::stretch() const {
    return glm::length(toObject_[0]) + glm::length(toObject_[1]) + glm::length(toObject_[2]);
}

}  // namespace glint::reference
