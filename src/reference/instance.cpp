#include "reference/instance.h"

#include "core/vectors.h"
#include "reference/rounding.h"
#include "scene/transform.h"

namespace glint::reference {

using glm::dvec3;

InstanceFrame::InstanceFrame(const rows::Instance& instance)
    : toObject_(glm::transpose(glm::dmat3(instance.toObjectX, instance.toObjectY, instance.toObjectZ))),
      toWorld_(glm::inverse(toObject_)),
      place_(instance.place) {}

Ray InstanceFrame::enterInstance(const Ray& ray) const {
    Ray inside = ray;
    inside.origin = pointInObject(ray.origin);
    inside.direction = toObject_ * ray.direction;
    return inside;
}

// The difference, the products and their sums round: gamma_5 of the magnitudes for each coordinate, of which
// there are three.
double InstanceFrame::slipOfWayIn(const dvec3& origin) const {
    return 9 * 0x1p-24 * greatestMagnitude(magnitudes(toObject_) * glm::abs(origin - place_));
}

dvec3 InstanceFrame::pointInObject(const dvec3& point) const {
    return toObject_ * (point - place_);
}

dvec3 InstanceFrame::pointInWorld(const dvec3& point) const {
    return toWorld_ * point + place_;
}

dvec3 InstanceFrame::normalInWorld(const dvec3& normal) const {
    return glm::normalize(glm::transpose(toObject_) * normal);
}

// The matrix, its products and their sum round by gamma_5 on the way out; and a ray that starts at the point
// by as much of |W| |x - place| on its way in again, which it must come to the same side after. The place is
// added to the point, and taken from it.
dvec3 InstanceFrame::errorInWorld(const dvec3& point, const dvec3& error) const {
    const dvec3 inAgain = magnitudes(toObject_) * glm::abs(toWorld_ * point);
    const dvec3 inside = error + gammaOf(5) * (glm::abs(point) + inAgain);
    return (1 + gammaOf(5)) * (magnitudes(toWorld_) * inside) + gammaOf(2) * glm::abs(place_);
}

double InstanceFrame::scaleInWorld(double size) const {
    return greatestMagnitude(size * (magnitudes(toWorld_) * dvec3(1)) + glm::abs(place_));
}

double InstanceFrame::stretch() const {
    return glm::length(toObject_[0]) + glm::length(toObject_[1]) + glm::length(toObject_[2]);
}

}  // namespace glint::reference
