#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bvh/bvh.h"
#include "trees.h"

namespace glint::builder_test {

using namespace test;

void expectEqual(const Bvh& a, const Bvh& b) {
    EXPECT_EQ(a.depth, b.depth);
    EXPECT_EQ(a.order, b.order);
    ASSERT_EQ(a.nodes.size(), b.nodes.size());
    for (size_t i = 0; i < a.nodes.size(); ++i) {
        ASSERT_EQ(a.nodes[i].first, b.nodes[i].first);
        ASSERT_EQ(a.nodes[i].count, b.nodes[i].count);
        ASSERT_EQ(a.nodes[i].box.lo, b.nodes[i].box.lo);
        ASSERT_EQ(a.nodes[i].box.hi, b.nodes[i].box.hi);
    }
}

TEST(Box, HalfArea) {
    Box box;
    EXPECT_EQ(box.halfArea(), 0.0);
    box.include(glm::vec3(1, 2, 3));
    EXPECT_EQ(box.halfArea(), 0.0);
    box.include(glm::vec3(3, 5, 8));  // edges 2, 3, 5
    EXPECT_EQ(box.halfArea(), 2.0 * 3 + 3 * 5 + 5 * 2);
}

TEST(Box, HalfAreaBeyondFloat) {
    const Box box = boxAround(glm::vec3(0), std::ldexp(1.0f, 126));  // edges 2^127
    EXPECT_EQ(box.halfArea(), 3 * std::ldexp(1.0, 254));
}

TEST(Builder, HardSetsAreValid) {
    for (const BoxSet& set : hardSets()) {
        SCOPED_TRACE(set.name);
        for (const uint32_t leaf : {1u, 4u, 8u}) {
            const BvhOptions options = {.maxLeafSize = leaf};
            expectValid(buildBvh(set.boxes, options), set.boxes, options);
        }
    }
}

// The least depth that can hold the boxes forces balanced splits; a little more leaves some choice.
TEST(Builder, TightDepthHolds) {
    for (const BoxSet& set : hardSets()) {
        SCOPED_TRACE(set.name);
        for (const uint32_t leaf : {1u, 3u, 4u}) {
            for (const uint32_t slack : {0u, 1u, 3u}) {
                const BvhOptions options = {.maxLeafSize = leaf,
                                            .maxLevels = halvings(set.boxes.size(), leaf) + slack};
                expectValid(buildBvh(set.boxes, options), set.boxes, options);
            }
        }
    }
}

TEST(Builder, RefusesWhatCannotFit) {
    BvhOptions options = {.maxLeafSize = 4, .maxLevels = 3};
    EXPECT_NO_THROW(buildBvh(randomBoxes(32, 1), options));  // 2^3 leaves of 4
    EXPECT_THROW(buildBvh(randomBoxes(33, 1), options), std::invalid_argument);
    options = {};
    options.maxLeafSize = 9;
    EXPECT_THROW(buildBvh(randomBoxes(3, 1), options), std::invalid_argument);
    options = {};
    const std::vector<uint8_t> groups(2, 0);
    options.groups = &groups;
    EXPECT_THROW(buildBvh(randomBoxes(3, 1), options), std::invalid_argument);
}

// T46: nothing to choose by, so the tree is the balanced one.
TEST(Builder, IdenticalCentroidsAreBalanced) {
    for (const size_t count : {1000u, 100001u}) {
        const std::vector<Box> boxes(count, boxAround({1, 2, 3}, 0.5f));
        const Bvh bvh = buildBvh(boxes);
        EXPECT_LE(bvh.depth, static_cast<uint32_t>(std::ceil(std::log2(count))) + 1);
        EXPECT_EQ(bvh.depth, halvings(count, BvhOptions{}.maxLeafSize));
        // Split by index: leaves from left to right hold ascending runs.
        EXPECT_TRUE(std::is_sorted(bvh.order.begin(), bvh.order.end()));
    }
}

// Points on a line have boxes without area for any split: halves are best.
TEST(Builder, PointsOnALineAreBalanced) {
    for (const BoxSet& set : hardSets()) {
        if (set.name != "descending line of points" && set.name != "powers of two (T48)") continue;
        EXPECT_EQ(buildBvh(set.boxes).depth, halvings(set.boxes.size(), BvhOptions{}.maxLeafSize));
    }
}

TEST(Builder, SmallestTrees) {
    EXPECT_TRUE(buildBvh({}).nodes.empty());
    EXPECT_TRUE(buildBvh({}).order.empty());
    const Box box = boxAround({1, 2, 3}, 1);
    const Bvh one = buildBvh({box});
    ASSERT_EQ(one.nodes.size(), 1u);
    EXPECT_EQ(one.nodes[0].count, 1u);
    EXPECT_EQ(one.nodes[0].first, 0u);
    EXPECT_EQ(one.nodes[0].box.lo, box.lo);
    EXPECT_EQ(one.nodes[0].box.hi, box.hi);
    EXPECT_EQ(one.depth, 0u);
    // Two unit boxes and one far away: 2 + (2 * 3 + 3) / 203 < 3; touching the same space: one leaf.
    const Box unit = boxAround({0, 0, 0}, 0.5f);
    const Bvh apart = buildBvh({unit, unit, boxAround({100, 0, 0}, 0.5f)});
    EXPECT_EQ(apart.nodes.size(), 3u);
    EXPECT_EQ(buildBvh({box, box}).nodes.size(), 1u);
}

TEST(Builder, ThreadsDoNotChangeTheTree) {
    for (const size_t count : {1000u, 20000u, 200000u}) {
        const std::vector<Box> boxes = randomBoxes(count, 7);
        const Bvh one = buildBvh(boxes, {}, {.threads = 1});
        for (const unsigned threads : {2u, 4u, 7u}) {
            SCOPED_TRACE(std::to_string(count) + " boxes, " + std::to_string(threads) + " threads");
            expectEqual(one, buildBvh(boxes, {}, {.threads = threads}));
        }
    }
}

TEST(Builder, ManyBoxesAreValid) {
    const std::vector<Box> boxes = randomBoxes(200000, 8);
    expectValid(buildBvh(boxes), boxes, {});
    const std::vector<Box> same(200000, boxAround({0, 0, 0}, 1));
    const BvhOptions tight = {.maxLevels = halvings(same.size(), BvhOptions().maxLeafSize)};
    expectValid(buildBvh(same, tight), same, tight);
}

// Groups in one place, so that no split by position separates them, at the least depth: 2 groups may need one
// level more than balanced halving takes, 256 groups eight.
TEST(Builder, LeavesNeverMixGroups) {
    for (const BoxSet& set : hardSets()) {
        SCOPED_TRACE(set.name);
        const std::vector<std::pair<unsigned, uint32_t>> groupsAndLevels{{2, 1}, {3, 2}, {256, 8}};
        for (const auto& [groupCount, levels] : groupsAndLevels) {
            std::vector<uint8_t> groups(set.boxes.size());
            for (size_t i = 0; i < groups.size(); ++i) groups[i] = static_cast<uint8_t>(i * i % groupCount);
            BvhOptions options = {.groups = &groups};
            expectValid(buildBvh(set.boxes, options), set.boxes, options);
            options.maxLevels = halvings(set.boxes.size(), options.maxLeafSize) + levels;
            expectValid(buildBvh(set.boxes, options), set.boxes, options);
        }
    }
}

TEST(Builder, OneGroupIsNoGroup) {
    const std::vector<Box> boxes = randomBoxes(5000, 9);
    const std::vector<uint8_t> groups(boxes.size(), 3);
    expectEqual(buildBvh(boxes), buildBvh(boxes, {.groups = &groups}));
}

// The heuristic's choices of cuts and of leaves.

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

// Leaves are larger if nodes cost much. If nodes cost nothing, each box that lies apart is a leaf.
TEST(BuilderQuality, TraversalCostSetsLeafSize) {
    std::vector<Box> boxes;
    for (int i = 0; i < 64; ++i)
        boxes.push_back(boxAround({static_cast<float>(i % 8), static_cast<float>(i / 8), 0}, 0.25f));
    BvhOptions options = {.traversalCost = 0};
    EXPECT_EQ(buildBvh(boxes, options).nodes.size(), 2 * boxes.size() - 1);
    options.traversalCost = 100;
    options.maxLeafSize = 8;
    EXPECT_LE(buildBvh(boxes, options).nodes.size(), 2 * (boxes.size() / 4) - 1);
}

}  // namespace glint::builder_test
