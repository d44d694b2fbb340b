#pragma once

#include <cstdint>
#include <vector>

#include "bvh/bvh.h"
#include "core/context.h"
#include "shared/layout.h"

namespace glint {

// Turns a tree whose nodes hold one box each into nodes that hold both children's boxes, in depth-first
// order, as shared/layout.h describes them: an inner left child follows its parent, leaves name runs in the
// array of their kind, and each node knows the slot that follows its subtree. A tree that is a single leaf
// becomes one node whose second child is kNone with an empty box. `kinds`: one per box, as the tree's groups;
// empty: all are kKindTriangle.
std::vector<shared::Node> flattenBvh(const Bvh& bvh, const std::vector<uint8_t>& kinds,
                                     const Context& context = {});

}  // namespace glint
