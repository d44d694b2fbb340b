// Builds a BVH of the requested quality from primitives.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>

#include "bvh/bvh.h"
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

// Trees of the scene that was packed last, for one that is packed next and shares geometry with it: a frame
// of an animation. A tree is found again by a hash of all that it is built from, so it is the very tree that
// would be built.
class TreeMemory {
  public:
    struct Entry {
        Tree tree;
        std::optional<Primitives> split;  // with the entries that splitting added, if it added any
        bool used = false;
    };

    // The next scene begins: what the one before it did not use is forgotten.
    void begin();
    // Null if there is none. Valid until begin().
    const Entry* find(uint64_t key);
    void keep(uint64_t key, Entry entry);

    // Trees that were built, and not found, since the start.
    uint64_t built() const { return built_; }

  private:
    std::mutex mutex_;  // prototypes may be packed by several threads
    std::map<uint64_t, Entry> entries_;
    uint64_t built_ = 0;
};

// The expected cost of a random ray that hits the root's box, in tests of a primitive: each node counts with
// its probability of being hit, the ratio of areas (Goldsmith & Salmon 1987; MacDonald & Booth 1990). 0 for
// an empty tree.
double expectedCost(const Bvh& bvh, double traversalCost);

// Builds the tree over `primitives`, to which split triangles are added as further entries
// (splitLargeTriangles).
// - Fast: binned surface area heuristic.
// - High: also splits triangles if their boxes are mostly empty (boxEmptiness, presplit.h) and the tree
//   becomes cheaper.
// - Default: as High, if these triangles are also a large part of the tree's cost.
// The quality does not change hits, except rounding hits of triangles in whose plane a ray lies
// (tests/render/traversal_test.cpp).
Tree buildTree(Primitives& primitives, const Scene& scene, const Frame& frame, const TreeOptions& options,
               const Context& context);

}  // namespace glint
