// The heuristic's choices of cuts and of leaves.
#include <gtest/gtest.h>

#include "bvh/bvh.h"
#include "trees.h"

namespace glint::builder_quality_test {
using namespace test;

// One box of 1000 far away: the cheapest cut by far leaves it alone at the root.
TEST(BuilderQuality, CutsOffAnOutlier) {
    std::vector<Box> boxes = randomBoxes(1000, 6);
    boxes.push_back(boxAround({1000, 0, 0}, 0.1f));
    const Bvh bvh = buildBvh(boxes);
    const BvhNode& right = bvh.nodes[bvh.nodes[0].first + 1];
    ASSERT_EQ(right.count, 1u);
    EXPECT_EQ(bvh.order[right.first], 1000u);
}

// Two pairs far apart, interleaved by index: the pairs are the leaves, {0, 2} and {1, 3}.
TEST(BuilderQuality, KeepsNeighboursTogether) {
    std::vector<Box> boxes;
    for (const float x : {0.0f, 100.0f, 0.25f, 100.25f}) boxes.push_back(boxAround({0, x, 0}, 0.5f));
    const Bvh bvh = buildBvh(boxes);
    ASSERT_EQ(bvh.nodes.size(), 3u);
    EXPECT_EQ(bvh.order, (std::vector<uint32_t>{0, 2, 1, 3}));
    EXPECT_EQ(bvh.nodes[1].count, 2u);
}

// A dear node makes larger leaves, a free one cuts down to single boxes where they are apart.
TEST(BuilderQuality, TraversalCostSetsLeafSize) {
    std::vector<Box> boxes;
    for (int i = 0; i < 64; ++i)
        boxes.push_back(boxAround({static_cast<float>(i % 8), static_cast<float>(i / 8), 0}, 0.25f));
    BvhOptions options;
    options.traversalCost = 0;
    EXPECT_EQ(buildBvh(boxes, options).nodes.size(), 2 * boxes.size() - 1);
    options.traversalCost = 100;
    options.maxLeafSize = 8;
    EXPECT_LE(buildBvh(boxes, options).nodes.size(), 2 * (boxes.size() / 4) - 1);
}

}  // namespace glint::builder_quality_test
