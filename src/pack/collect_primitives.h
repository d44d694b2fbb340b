// The primitives of a scene that can be hit; internal to the packing.
#pragma once

#include <string>
#include <vector>

#include "pack/primitives.h"

namespace glint {

// Leaves out planes and the triangles that cannot be hit, which are counted and warned of.
// Throws Error(Scene) if there are more primitives of a kind than a leaf can name.
Primitives collectPrimitives(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame,
                             const Context& context, PackStatistics& statistics,
                             std::vector<std::string>& warnings);

}  // namespace glint
