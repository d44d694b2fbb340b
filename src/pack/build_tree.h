// From primitives to a tree of the wanted quality.
#pragma once

#include "bvh/builder.h"
#include "pack/primitives.h"

namespace glint {

class TreeMemory;

struct TreeOptions {
    BvhOptions bvh;
    BuildQuality quality = BuildQuality::Default;
    // False where a primitive must stand in the tree once: a shadow ray that multiplies what each surface
    // lets through would count the parts of a split triangle twice.
    bool split = true;
    TreeMemory* memory = nullptr;  // where trees may be found, and are kept; may be null
};

struct Tree {
    Bvh bvh;
    double cost = 0;              // expectedCost
    uint32_t splitTriangles = 0;  // entries that splitting added
};

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
Tree buildTree(Primitives& primitives, const Scene& scene, const Frame& frame, const TreeOptions& options);

}  // namespace glint
