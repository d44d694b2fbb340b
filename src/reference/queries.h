// Closest points and crossings, in double and beyond: what shaders/closest_point.comp and
// shaders/traversal/count.glsl find, by formulas of their own.
#pragma once

#include <vector>

#include "reference/tracer.h"

namespace glint::reference {

// The point's u and v, and its primitive with the instance; t is its distance.
struct ClosestPoint {
    Hit hit;
    glm::dvec3 point{0};  // local
};

// The point of a triangle or sphere, of an instance or none, that is closest to a local point.
ClosestPoint closestPointOn(const Model& model, uint32_t primitive, uint32_t instance,
                            const glm::dvec3& point);

// The closest point of a scene of triangles and spheres. At the same distance the lowest id counts.
// hit.primitive is kNone if nothing is in the BVH.
ClosestPoint closestPoint(const Model& model, const glm::dvec3& point);

// Crossings of a local ray, nearest first. At a shared edge or corner of triangles it counts only those that
// it crosses, so a closed surface is entered and left in turns. Each triangle must stand in the BVH once
// (packScene without `split`).
std::vector<Hit> crossings(const Tracer& tracer, const Ray& ray);

// True if rounding to fp32 may put the local point on a surface: if it lies within 4 u (|point| + |v|) of a
// triangle, u = 2^-24, both in the greatest coordinate, v the triangle's farthest vertex; in instances,
// farther by the pad of boxes (Environment::instancePad); of any other surface along an axis.
bool touches(const Tracer& tracer, const glm::dvec3& point);

}  // namespace glint::reference
