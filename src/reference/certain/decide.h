// Two ways to intersect a ray with surfaces of the scene before it is packed: in double with bounds on each
// rounding error, which leave spans of t, and in exact fractions. Internal to certain.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "scene/scene.h"
#include "trace/ray_batch.h"

namespace glint::reference::certain {

// A triangle or a plane.
struct ExactSurface {
    std::array<glm::dvec3, 3> corners{};  // of a triangle
    const Affine* place = nullptr;        // from their coordinates to the world
    const PlaneShape* plane = nullptr;    // if it is one
    uint32_t id = 0;                      // of surfaces hit at the same t, the one with the lowest is taken
};

// If the ray hits the surface, then at lower <= t <= upper; it certainly does if isHit. t, u, v: as rounded;
// u and v of triangles, P = (1-u-v)a + u b + v c.
struct Span {
    double lower = 0, upper = 0;
    double t = 0, u = 0, v = 0;
    bool isHit = false;
};

// Finds spans of t that contain every hit; misses elsewhere are proven. The ray is finite and has a
// direction.
class SpanRay {
  public:
    explicit SpanRay(const WorldRay& ray);

    // Empty: the ray certainly misses the surface, or hits it outside its interval.
    std::optional<Span> span(const ExactSurface& surface) const;
    // Spans of the entry into and the exit from the sphere.
    std::array<std::optional<Span>, 2> spans(const SphereShape& sphere) const;

    const WorldRay& ray() const { return ray_; }

  private:
    // A span in units of direction_, cut to the ray's interval.
    std::optional<Span> within(Span span, bool isHit) const;

    WorldRay ray_;
    glm::dvec3 direction_;  // the ray's, times 2^-exponent_; its greatest component is in [1, 2)
    int exponent_;
};

struct ExactHit {
    size_t surface = 0;           // of those given
    double lower = 0, upper = 0;  // neighbouring doubles, or the same, with the exact t between them
    double u = 0, v = 0;
};

// The first hit within max(tMin, 0) < t <= tMax, or nothing. Edges and corners belong to a triangle. A ray in
// the plane of a triangle misses it, and a parallel ray misses a plane. All numbers except tMax must be
// finite, and the direction must not be zero.
std::optional<ExactHit> nearestExactly(const WorldRay& ray, std::span<const ExactSurface> surfaces);

}  // namespace glint::reference::certain
