// Moving subtrees: the tree stays a valid one over the same leaves, and gets cheaper.
#include "bvh/reinsert.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pack/build_tree.h"
#include "trees.h"

namespace glint::reinsert_test {
namespace {

using namespace test;

// Boxes in leaves as they come, pairs of leaves in the order of their indices: about as bad as a tree can be.
Bvh careless(const std::vector<Box>& boxes) {
    std::vector<Box> shuffled(boxes.size());
    BvhOptions options;
    options.maxLeafSize = 1;
    // Built over boxes along a line, then given the true ones: neighbours by index, not by place.
    for (size_t i = 0; i < boxes.size(); ++i) shuffled[i] = boxAround({static_cast<float>(i), 0, 0}, 0.25f);
    Bvh bvh = buildBvh(shuffled, options);
    for (size_t n = bvh.nodes.size(); n-- > 0;) {
        BvhNode& node = bvh.nodes[n];
        node.box = Box{};
        if (node.count > 0) node.box.include(boxes[bvh.order[node.first]]);
    }
    const auto refit = [&](const auto& self, uint32_t n) -> Box {
        BvhNode& node = bvh.nodes[n];
        if (node.count == 0) {
            node.box = self(self, node.first);
            node.box.include(self(self, node.first + 1));
        }
        return node.box;
    };
    refit(refit, 0);
    return bvh;
}

TEST(Reinsertion, KeepsHardTreesValidAndNoDearer) {
    for (const BoxSet& set : hardSets()) {
        SCOPED_TRACE(set.name);
        Bvh bvh = buildBvh(set.boxes);
        const double before = expectedCost(bvh, 1.5);
        reinsertSubtrees(bvh, {.iterations = 4, .batch = 0.5});
        expectValid(bvh, set.boxes, {});
        EXPECT_LE(expectedCost(bvh, 1.5), before * (1 + 1e-12));
    }
}

// Random order, 4096 boxes of edge about 1/16 of the whole: the bottom-up tree of random pairs costs several
// times what the heuristic's does.
TEST(Reinsertion, MendsACarelessTree) {
    const std::vector<Box> boxes = randomBoxes(4096, 3);
    Bvh bvh = careless(boxes);
    const double before = expectedCost(bvh, 1.5);
    reinsertSubtrees(bvh, {.iterations = 60, .batch = 1});
    BvhOptions single;
    single.maxLeafSize = 1;
    expectValid(bvh, boxes, single);
    const double good = expectedCost(buildBvh(boxes, single), 1.5);
    ASSERT_GT(before, 3 * good);
    EXPECT_LT(expectedCost(bvh, 1.5), (before + good) / 2);
}

TEST(Reinsertion, StaysWithinTheDepth) {
    const std::vector<Box> boxes = randomBoxes(512, 8);
    Bvh bvh = careless(boxes);
    reinsertSubtrees(bvh, {.iterations = 20, .batch = 1, .maxLevels = 10});
    BvhOptions options;
    options.maxLeafSize = 1;
    options.maxLevels = 10;
    expectValid(bvh, boxes, options);
}

TEST(Reinsertion, DoesNotDependOnThreads) {
    const std::vector<Box> boxes = randomBoxes(20000, 12);
    Bvh one = buildBvh(boxes), four = one;
    reinsertSubtrees(one, {}, {.threads = 1});
    reinsertSubtrees(four, {}, {.threads = 4});
    EXPECT_EQ(one.order, four.order);
    ASSERT_EQ(one.nodes.size(), four.nodes.size());
    for (size_t i = 0; i < one.nodes.size(); ++i) {
        EXPECT_EQ(one.nodes[i].first, four.nodes[i].first);
        EXPECT_EQ(one.nodes[i].box.lo, four.nodes[i].box.lo);
    }
}

}  // namespace
}  // namespace glint::reinsert_test
