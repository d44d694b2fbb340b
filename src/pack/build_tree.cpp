#include "pack/build_tree.h"

#include "bvh/reinsert.h"
#include "pack/presplit.h"
#include "pack/tree_memory.h"

namespace glint {
namespace {

// Further entries that splitting may add, in triangles. Measured on a hall of arches (docs/lab/building.md):
// box and triangle tests of a camera ray 187 without, 99 with 0.3, 77 with 1, 76 with 3.
constexpr double kSplitBudget = 1;
// Triangles that a random ray tests only because their boxes are too large. Measured: 1.0 to 3.8 for scanned
// and modelled meshes, where splitting costs 2 to 60 %; 51 for the hall of arches, where it gains a factor of
// 2.4.
constexpr double kMuchEmptiness = 6;
// And of all that such a ray tests, the least share that is worth a try by default: 0.43 in the hall of
// arches; 0.08 in a shader ball of 64 k triangles, whose splitting took six times as long as its tree and was
// no use.
constexpr double kMuchOfAll = 0.2;

// By default, subtrees are reinserted in trees of so many nodes at most, which takes some milliseconds, and
// where nothing was split only a tree so much cheaper is kept: gains of less in the expected cost were none
// in counted tests (docs/lab/building.md).
constexpr size_t kQuickNodes = 1u << 15;
constexpr double kWorthReinserting = 0.95;

bool mayGrow(const Primitives& primitives) {
    const double grown = (1 + kSplitBudget) * primitives.counts[shared::kKindTriangle];
    return grown < shared::kLeafFirstMask;
}

Tree plainTree(const Primitives& primitives, const TreeOptions& options, const Context& context) {
    Tree tree;
    tree.bvh = buildBvh(primitives.boxes, options.bvh, context);
    tree.cost = expectedCost(tree.bvh, options.bvh.traversalCost);
    return tree;
}

// Keeps whichever of both trees is cheaper, and the primitives that go with it.
void trySplits(Primitives& primitives, const Scene& scene, const Frame& frame, const TreeOptions& options,
               const Context& context, Tree& tree) {
    const double emptiness = boxEmptiness(primitives, scene, frame, context);
    if (emptiness < kMuchEmptiness) return;
    if (options.quality == BuildQuality::Default && emptiness < kMuchOfAll * tree.cost) return;
    Primitives split = primitives;
    const uint32_t added = splitLargeTriangles(split, scene, frame, kSplitBudget, context);
    if (added == 0) return;
    TreeOptions splitOptions = options;
    if (options.bvh.groups != nullptr) splitOptions.bvh.groups = &split.kinds;
    Tree candidate = plainTree(split, splitOptions, context);
    if (!(candidate.cost < tree.cost)) return;
    candidate.splitTriangles = added;
    tree = std::move(candidate);
    primitives = std::move(split);
}

}  // namespace

double expectedCost(const Bvh& bvh, double traversalCost) {
    if (bvh.nodes.empty()) return 0;
    // A random line that meets a convex box meets one inside it with the chance of their areas' ratio; where
    // both are points or lines, it meets both.
    const double rootArea = bvh.nodes[0].box.halfArea();
    double cost = 0;
    for (const BvhNode& node : bvh.nodes) {
        const double chance = rootArea > 0 ? node.box.halfArea() / rootArea : 1.0;
        cost += chance * (node.count > 0 ? node.count : traversalCost);
    }
    return cost;
}

namespace {

Tree freshTree(Primitives& primitives, const Scene& scene, const Frame& frame, const TreeOptions& options,
               const Context& context) {
    Tree tree = plainTree(primitives, options, context);
    if (options.quality == BuildQuality::Fast) return tree;
    if (options.split && mayGrow(primitives)) trySplits(primitives, scene, frame, options, context, tree);
    const bool high = options.quality == BuildQuality::High;
    if (!high && tree.bvh.nodes.size() > kQuickNodes) return tree;
    ReinsertionOptions reinsertion;
    reinsertion.maxLevels = options.bvh.maxLevels;
    reinsertion.iterations = high ? 8 : 3;
    reinsertion.batch = high ? 0.1 : 0.05;
    Tree candidate = tree;
    reinsertSubtrees(candidate.bvh, reinsertion, context);
    candidate.cost = expectedCost(candidate.bvh, options.bvh.traversalCost);
    const bool keep = high || tree.splitTriangles > 0 || candidate.cost < kWorthReinserting * tree.cost;
    return keep ? candidate : tree;
}

}  // namespace

Tree buildTree(Primitives& primitives, const Scene& scene, const Frame& frame, const TreeOptions& options,
               const Context& context) {
    if (!options.memory) return freshTree(primitives, scene, frame, options, context);
    const uint64_t key = treeKey(primitives, scene, frame, options);
    if (const TreeMemory::Entry* known = options.memory->find(key)) {
        if (known->split) primitives = *known->split;
        return known->tree;
    }
    TreeMemory::Entry entry;
    entry.tree = freshTree(primitives, scene, frame, options, context);
    if (entry.tree.splitTriangles > 0) entry.split = primitives;
    Tree tree = entry.tree;
    options.memory->keep(key, std::move(entry));
    return tree;
}

}  // namespace glint
