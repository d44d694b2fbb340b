// New boxes for a flattened tree (flatten.h) whose primitives have moved: the tree stays, its boxes follow.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "bvh/bvh.h"
#include "core/context.h"
#include "shared/layout.h"

namespace glint {

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
