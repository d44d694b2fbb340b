// From primitives to a tree of the wanted quality.
#pragma once

#include "pack/tree_memory.h"

namespace glint {

// The expected cost of a random ray that meets the root's box, in tests of a primitive: each node by its
// chance of being met, the ratio of areas (Goldsmith & Salmon 1987; MacDonald & Booth 1990). 0 for an empty
// tree.
double expectedCost(const Bvh& bvh, double traversalCost);

// Builds the tree over `primitives`, to which split triangles are added as further entries
// (splitLargeTriangles).
// Fast: binned surface area heuristic, nothing else. Default: besides, triangles are split if their boxes are
// mostly empty (boxEmptiness, presplit.h) and the tree is cheaper for it, and small trees have subtrees
// reinserted where that makes them cheaper. High: the same whatever it takes. No quality changes what a ray
// hits, but for hits by rounding of triangles that a ray lies in the plane of
// (tests/render/traversal_test.cpp).
Tree buildTree(Primitives& primitives, const Scene& scene, const Frame& frame, const TreeOptions& options,
               const Context& context);

}  // namespace glint
