// Builds a BVH by the binned surface area heuristic: I. Wald, "On fast Construction of SAH-based Bounding
// Volume Hierarchies", 2007.
#pragma once

#include <vector>

#include "bvh/bvh.h"
#include "core/context.h"

namespace glint {

// Builds a tree over `boxes` (each finite and not empty; zero-thickness is fine). The result does not depend
// on the number of threads. Identical centroids are split by index, so that the leaf size always holds.
// Throws std::invalid_argument for options out of range, and where maxLevels levels cannot hold that many
// boxes in leaves of maxLeafSize; kMaxBvhDepth levels hold any number up to 2^31.
Bvh buildBvh(const std::vector<Box>& boxes, const BvhOptions& options = {}, const Context& context = {});

}  // namespace glint
