// Crossings in double and beyond: what shaders/traversal/crossings.glsl counts, by formulas of its own.
#pragma once

#include <vector>

#include "reference/tracer.h"

namespace glint::reference {

// Crossings of a local ray, nearest first. At a shared edge or corner of triangles it counts only those that
// it crosses, so a closed surface is entered and left in turns. Each triangle must stand in the BVH once
// (packScene without `split`).
std::vector<Hit> crossings(const Tracer& tracer, const Ray& ray);

// True if rounding to fp32 cannot tell the local point from a surface: if it lies within 4 u (|point| + |v|)
// of a triangle (16 u of an instance's), u = 2^-24, both in the greatest coordinate, v the triangle's
// farthest vertex; of any other surface along an axis.
bool touches(const Tracer& tracer, const glm::dvec3& point);

}  // namespace glint::reference
