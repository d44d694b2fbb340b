// The closest point of all surfaces, in double: what shaders/closest_point.comp finds, by formulas of its
// own.
#pragma once

#include <optional>

#include "reference/tracer.h"

namespace glint::reference {

// The point's u and v, and its primitive with the instance; t is its distance.
struct ClosestPoint {
    Hit hit;
    glm::dvec3 point{0};  // local
};

// True of triangles and spheres: the other kinds have no closest points.
bool hasClosestPoint(shared::PrimitiveKind kind);

// The point of the triangle a b c that is closest to `point`.
glm::dvec3 closestOnTriangle(const glm::dvec3& point, const glm::dvec3& a, const glm::dvec3& b,
                             const glm::dvec3& c);

// The point of a primitive, of an instance or none, that is closest to a local point.
ClosestPoint closestPointOn(const Model& model, uint32_t primitive, uint32_t instance,
                            const glm::dvec3& point);

// The closest point of all. At the same distance the lowest id counts. Empty if nothing is in the BVH.
std::optional<ClosestPoint> closestPoint(const Model& model, const glm::dvec3& point);

}  // namespace glint::reference
