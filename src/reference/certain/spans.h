// Spans of t that contain every hit, in double with bounds on each rounding error. Outside the spans a miss
// is proven.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>

#include "scene/scene.h"
#include "trace/ray_batch.h"

namespace glint::reference::certain {

// If the surface is met at all, and `met` says that it is for sure, then at lower <= t <= upper. t, u, v: as
// rounded; u and v of triangles, P = (1-u-v)a + u b + v c.
struct Span {
    double lower = 0, upper = 0;
    double t = 0, u = 0, v = 0;
    bool met = false;
};

// Values of a ray that every test needs. The ray is finite and has a direction.
class PreparedRay {
  public:
    explicit PreparedRay(const WorldRay& ray);

    // `place`: from the corners' coordinates to the world, or null. Nothing: it is not met, for sure, or not
    // within the ray's interval.
    std::optional<Span> span(const std::array<glm::dvec3, 3>& corners, const Affine* place) const;
    std::optional<Span> span(const PlaneShape& plane) const;
    // Spans of the entry into and the exit from the sphere.
    std::array<std::optional<Span>, 2> spans(const SphereShape& sphere) const;

    const WorldRay& ray() const { return ray_; }

  private:
    // `lower` and `upper` of something that is met, or may be: cut to the ray's interval.
    std::optional<Span> within(Span span, bool met) const;

    WorldRay ray_;
    int axis_ = 2;  // of the direction's greatest component; it comes last when turned
    glm::dvec3 shear_{0};
};

}  // namespace glint::reference::certain
