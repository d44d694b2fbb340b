// Making a finished tree cheaper by moving subtrees to better places.
#pragma once

#include <cstdint>

#include "bvh/bvh.h"
#include "core/context.h"

namespace glint {

struct ReinsertionOptions {
    uint32_t iterations = 3;
    // Part of all nodes, those with the greatest areas, that each iteration looks for a better place for.
    double batch = 0.05;
    uint32_t maxLevels = 48;  // levels below the root; an iteration that passes it is undone, and the last
};

// Takes each subtree of a batch out of the tree and puts it back where the sum of all nodes' areas, and with
// it the expected number of nodes that a random ray visits, becomes least; repeats. Leaves keep their boxes.
// The result does not depend on the number of threads, and is never dearer than before.
// J. Bittner, M. Hapala, V. Havran, "Fast Insertion-Based Optimization of Bounding Volume Hierarchies",
// Computer Graphics Forum 32(1), 2013; many at a time: D. Meister, J. Bittner, "Parallel Reinsertion for
// Bounding Volume Hierarchy Optimization", Computer Graphics Forum 37(2), 2018.
void reinsertSubtrees(Bvh& bvh, const ReinsertionOptions& options = {}, const Context& context = {});

}  // namespace glint
