// A binary bounding volume hierarchy over boxes, built by the binned surface area heuristic: I. Wald, "On
// fast Construction of SAH-based Bounding Volume Hierarchies", 2007. Knows nothing of primitives.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "core/context.h"
#include "core/enum_names.h"

namespace glint {

struct Box {
    glm::vec3 lo{std::numeric_limits<float>::max()};
    glm::vec3 hi{-std::numeric_limits<float>::max()};

    void include(const glm::vec3& p) {
        lo = glm::min(lo, p);
        hi = glm::max(hi, p);
    }
    void include(const Box& b) {
        lo = glm::min(lo, b.lo);
        hi = glm::max(hi, b.hi);
    }
    bool empty() const { return lo.x > hi.x; }
    // Half the surface area; 0 for an empty box. In double: edges up to 1e18 square beyond float's range.
    double halfArea() const;
};

// How much time to spend on a tree, see build_tree.h.
enum class BuildQuality { Fast, Default, High };
constexpr auto entriesOf(BuildQuality) {
    return std::to_array<EnumEntry<BuildQuality>>(
        {{BuildQuality::Fast, "fast", "binned"},
         {BuildQuality::Default, "default", "long triangles split if that is much of the cost"},
         {BuildQuality::High, "high", "long triangles split everywhere"}});
}

struct BvhOptions {
    uint32_t maxLeafSize = 4;  // 1..shared::kMaxLeafSize
    uint32_t maxLevels =
        48;  // levels below the root; SAH gives way to median splits where needed to stay within
    // Cost of a node, in primitive tests. Measured on the mountain of 524 k triangles: packets trace a tenth
    // faster with 2 than with 1.5, single rays are equal; 2 to 5 differ by noise (docs/lab/traversal.md).
    double traversalCost = 2;
    // Optional, one per box: a leaf never mixes groups (shared::kKind...). Empty: one group.
    const std::vector<uint8_t>* groups = nullptr;
    uint32_t soloGroup = 256;  // each box of this group gets a leaf of its own
};

struct BvhNode {
    Box box;
    uint32_t first =
        0;  // inner: index of the left child, the right one is first + 1; leaf: first entry in Bvh::order
    uint32_t count = 0;  // 0: inner node; else number of boxes in the leaf
};

struct Bvh {
    std::vector<BvhNode> nodes;   // nodes[0] is the root; empty for no boxes
    std::vector<uint32_t> order;  // indices of boxes in leaf order, each box once
    uint32_t depth = 0;           // levels below the root
};

// Builds a tree over `boxes` (each finite and not empty; zero-thickness is fine). The result does not depend
// on the number of threads. Identical centroids are split by index, so that the leaf size always holds.
// Throws std::invalid_argument for options out of range, and where maxLevels levels cannot hold that many
// boxes in leaves of maxLeafSize; kMaxBvhDepth levels hold any number up to 2^31.
Bvh buildBvh(const std::vector<Box>& boxes, const BvhOptions& options = {}, const Context& context = {});

}  // namespace glint
