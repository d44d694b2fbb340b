// Polygons into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace glint {

// Splits the polygon with these corners (three or more) into size - 2 triangles of the same winding and
// appends them to `triangles` as indices into `corners`. A convex polygon becomes a fan about its first
// corner, any other simple one is cut by ear clipping; a polygon that crosses itself or has no area gives
// some covering, never an endless loop. A polygon that is not planar is judged by its projection along the
// Newell normal's greatest axis.
//
// False if some of the triangles are turned over, and so lie over others: then the polygon crosses itself, as
// triangles without other corners than its own that all face one way make a disc. (One that overlaps itself
// without turning over, like a roll of tape, is not noticed.)
bool splitPolygon(std::span<const glm::dvec3> corners, std::vector<std::array<uint32_t, 3>>& triangles);

}  // namespace glint
