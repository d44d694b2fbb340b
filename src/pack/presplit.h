// Splits large triangles into parts for the BVH, so that boxes fit tightly.
#pragma once

#include <cstdint>
#include <vector>

#include "bvh/bvh.h"
#include "pack/primitives.h"

namespace glint {

// One triangle and its box, cut along planes into `parts` boxes (at most; fewer where cutting gains nothing)
// that together enclose it. `root`: the scene's box; the planes are those that halve it again and again, so
// that the parts of neighbours end at the same planes.
std::vector<Box> splitTriangle(const Corners& corners, const Box& root, uint32_t parts);

// Mean number of triangles that a random ray through the scene's box tests only because boxes are larger than
// triangles: the sum of (half the box's area - the least that boxes around small parts of the triangle come
// down to) over half the area of the scene's box. 1 to 4 for meshes of even triangles, much more for long
// oblique ones.
double boxEmptiness(const Primitives& primitives, const Scene& scene, const Frame& frame,
                    const Context& context);

// Adds to `primitives` further entries for the triangles whose boxes are emptiest, up to `budget` times the
// number of triangles, and shrinks their first ones: each entry names the same source, the boxes of one
// triangle enclose it together. Returns how many entries were added. T. Karras, T. Aila, "Fast Parallel
// Construction of High-Quality Bounding Volume Hierarchies", HPG 2013, section 4: importance (2^-level (box
// area - ideal area))^(1/3), splits in proportion to it.
uint32_t splitLargeTriangles(Primitives& primitives, const Scene& scene, const Frame& frame, double budget,
                             const Context& context);

}  // namespace glint
