// Trees as the tracers read them, and new boxes for those whose primitives have moved.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "bvh/bvh.h"
#include "core/context.h"
#include "core/device_layout.h"

namespace glint {

// Turns a tree whose nodes hold one box each into nodes that hold both children's boxes, in depth-first
// order, as described in shared/layout.h: an inner left child follows its parent, leaves name runs in the
// array of their kind, and each node holds the slot after its subtree. A tree of a single leaf becomes one
// node whose second child is kNone with an empty box. `kinds`: one per box, as the tree's groups; empty: all
// are kKindTriangle.
std::vector<shared::Node> flattenBvh(const Bvh& bvh, const std::vector<uint8_t>& kinds,
                                     const Context& context = {});

// True for a child that is a node, of those that are not kNone.
inline bool isInnerChild(uint32_t child) {
    return (child & shared::kLeafFlag) == 0;
}

struct RefitResult {
    Box box;          // of the tree
    double cost = 0;  // expectedCost (pack/build_tree.h) of the tree with its new boxes
};

// nodes: of one tree, from its root on. leafBox(child): the tight box of a leaf's primitives; nothing leaves
// the leaf's box as it is. It is called from several threads. The boxes are those that flattenBvh would have
// stored.
RefitResult refitNodes(std::span<shared::Node> nodes, double traversalCost,
                       const std::function<std::optional<Box>(uint32_t child)>& leafBox,
                       const Context& context = {});

}  // namespace glint
