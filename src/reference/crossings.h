// Crossings in double and beyond: what shaders/traversal/crossings.glsl counts, by formulas of its own.
#pragma once

#include <vector>

#include "reference/tracer.h"

namespace glint::reference {

// Where a local ray goes through surfaces, nearest first: of triangles that share the edge or corner that it
// meets those alone that it crosses, so that a closed surface is entered and left in turns. Triangles of the
// scene must stand in its tree once each (packScene without `split`).
std::vector<Hit> crossings(const Tracer& tracer, const Ray& ray);

// True if rounding to fp32 cannot tell the local point from a surface: if it lies within 4 u (|point| + |v|)
// of a triangle (16 u of an instance's), u = 2^-24, both in the greatest coordinate, v the triangle's
// farthest vertex; of any other surface along an axis.
bool touches(const Tracer& tracer, const glm::dvec3& point);

}  // namespace glint::reference
