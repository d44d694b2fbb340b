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
// corner; other simple polygons are cut by ear clipping. For polygons that cross themselves or have no area
// the triangles are arbitrary, but the function returns. The projection along the Newell normal's greatest
// axis decides for polygons that are not planar.
//
// False if some triangles are turned over: then the polygon crosses itself, since triangles of its own
// corners that all face one way form a disc. Does not detect a polygon that overlaps itself without turning
// over, like a roll of tape.
bool splitPolygon(std::span<const glm::dvec3> corners, std::vector<std::array<uint32_t, 3>>& triangles);

}  // namespace glint
