// Instances in double: the surface is the set of points x whose W (x - place) lies on the prototype, W as
// rounded in the packed scene.
#pragma once

#include "core/vectors.h"
#include "reference/rounding.h"
#include "reference/tracer.h"
#include "scene/transform.h"

namespace glint::reference {

class InstanceFrame {
  public:
    explicit InstanceFrame(const rows::Instance& instance)
        : toObject_(glm::transpose(glm::dmat3(instance.toObjectX, instance.toObjectY, instance.toObjectZ))),
          toWorld_(glm::inverse(toObject_)),
          place_(instance.place) {}

    // The same points at the same t, in the instance's coordinates.
    Ray enterInstance(const Ray& ray) const {
        Ray inside = ray;
        inside.origin = pointInObject(ray.origin);
        inside.direction = toObject_ * ray.direction;
        return inside;
    }
    // PreparedRay::slip: how far fp32 may take an origin off on its way in, along any unit normal. The
    // difference, the products and their sums round: gamma_5 of the magnitudes of each of three coordinates.
    double slipOfWayIn(const glm::dvec3& origin) const {
        return 9 * kFloatUnit * greatestMagnitude(magnitudes(toObject_) * glm::abs(origin - place_));
    }
    glm::dvec3 pointInObject(const glm::dvec3& point) const { return toObject_ * (point - place_); }
    glm::dvec3 pointInWorld(const glm::dvec3& point) const { return toWorld_ * point + place_; }
    // Unit; by the inverse transpose.
    glm::dvec3 normalInWorld(const glm::dvec3& normal) const {
        return glm::normalize(glm::transpose(toObject_) * normal);
    }
    // The error box of a point (rounding.h) in the world, from its error box in the instance's coordinates.
    // The matrix, its products and their sum round by gamma_5 on the way out; and a ray that starts at the
    // point by as much of |W| |x - place| on its way in again, which it must come to the same side after. The
    // place is added to the point, and taken from it.
    glm::dvec3 errorInWorld(const glm::dvec3& point, const glm::dvec3& error) const {
        const glm::dvec3 inAgain = magnitudes(toObject_) * glm::abs(toWorld_ * point);
        const glm::dvec3 inside = error + gammaOf(5) * (glm::abs(point) + inAgain);
        return (1 + gammaOf(5)) * (magnitudes(toWorld_) * inside) + gammaOf(2) * glm::abs(place_);
    }
    // For points with coordinates of at most `size`: the greatest coordinate, and the greatest summand of a
    // coordinate in the world.
    double scaleInWorld(double size) const {
        return greatestMagnitude(size * (magnitudes(toWorld_) * glm::dvec3(1)) + glm::abs(place_));
    }
    // At most how long a unit of way in the world is in the instance.
    double stretch() const {
        return glm::length(toObject_[0]) + glm::length(toObject_[1]) + glm::length(toObject_[2]);
    }

  private:
    glm::dmat3 toObject_, toWorld_;
    glm::dvec3 place_;
};

// True if triangles' second and third corner, and with them u and v, are exchanged; `instance` may be kNone.
inline bool isMirrored(const Model& scene, uint32_t instance) {
    return instance != shared::kNone && scene.instances[instance].mirrored != 0;
}

}  // namespace glint::reference
