// Instances in double: the surface is the set of points x whose W (x - place) lies on the prototype, W as
// rounded in the packed scene.
#pragma once

#include "reference/tracer.h"

namespace glint::reference {

class InstanceFrame {
  public:
    explicit InstanceFrame(const rows::Instance& instance);

    // The same points at the same t, in the instance's coordinates.
    Ray enterInstance(const Ray& ray) const;
    // PreparedRay::slip: how far fp32 may take an origin off on its way in, along any unit normal.
    double slipOfWayIn(const glm::dvec3& origin) const;
    glm::dvec3 pointInObject(const glm::dvec3& point) const;
    glm::dvec3 pointInWorld(const glm::dvec3& point) const;
    // Unit; by the inverse transpose.
    glm::dvec3 normalInWorld(const glm::dvec3& normal) const;
    // The error box of a point (rounding.h) in the world, from its error box in the instance's coordinates.
    glm::dvec3 errorInWorld(const glm::dvec3& point, const glm::dvec3& error) const;
    // For points with coordinates of at most `size`: the greatest coordinate, and the greatest summand of a
    // coordinate in the world.
    double scaleInWorld(double size) const;
    // At most how long a unit of way in the world is in the instance.
    double stretch() const;

  private:
    glm::dmat3 toObject_, toWorld_;
    glm::dvec3 place_;
};

// True if triangles' second and third corner, and with them u and v, are exchanged; `instance` may be kNone.
inline bool isMirrored(const Model& scene, uint32_t instance) {
    return instance != shared::kNone && scene.instances[instance].mirrored != 0;
}

}  // namespace glint::reference
