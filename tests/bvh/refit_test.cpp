#include <gtest/gtest.h>

#include "bvh/flatten.h"
#include "pack/build_tree.h"
#include "trees.h"

namespace glint::refit_test {
using namespace test;

// The tree with the boxes that its nodes have once the boxes it was made of are others.
void follow(Bvh& bvh, const std::vector<Box>& boxes, uint32_t node = 0) {
    BvhNode& n = bvh.nodes[node];
    n.box = Box();
    if (n.count > 0) {
        for (uint32_t i = n.first; i < n.first + n.count; ++i) n.box.include(boxes[bvh.order[i]]);
        return;
    }
    for (const uint32_t child : {n.first, n.first + 1}) {
        follow(bvh, boxes, child);
        n.box.include(bvh.nodes[child].box);
    }
}

void expectSameBoxes(const shared::Node& a, const shared::Node& b) {
    EXPECT_EQ(a.lo0, b.lo0);
    EXPECT_EQ(a.hi0, b.hi0);
    EXPECT_EQ(a.lo1, b.lo1);
    EXPECT_EQ(a.hi1, b.hi1);
    EXPECT_EQ(a.child0, b.child0);
    EXPECT_EQ(a.child1, b.child1);
    EXPECT_EQ(a.escape, b.escape);
}

// Of `boxes` every `stay`-th leaf stays, 0: none.
void expectRefitted(const std::vector<Box>& boxes, const std::vector<Box>& others, uint32_t stay,
                    unsigned threads) {
    Bvh bvh = buildBvh(boxes);
    std::vector<shared::Node> nodes = flattenBvh(bvh, {});
    std::vector<Box> moved = others;
    const auto stays = [&](uint32_t first) { return stay > 0 && first % stay == 0; };
    for (const BvhNode& n : bvh.nodes)
        for (uint32_t i = n.first; n.count > 0 && stays(n.first) && i < n.first + n.count; ++i)
            moved[bvh.order[i]] = boxes[bvh.order[i]];
    const auto leafBox = [&](uint32_t leaf) -> std::optional<Box> {
        const uint32_t first = leaf & shared::kLeafFirstMask;
        if (stays(first)) return std::nullopt;
        Box box;
        for (uint32_t i = first; i <= first + (leaf >> shared::kLeafCountShift & shared::kLeafCountMask); ++i)
            box.include(moved[bvh.order[i]]);
        return box;
    };
    const RefitResult result = refitNodes(nodes, 2, leafBox, {.threads = threads});
    follow(bvh, moved);
    const std::vector<shared::Node> expected = flattenBvh(bvh, {});
    ASSERT_EQ(nodes.size(), expected.size());
    for (size_t i = 0; i < nodes.size() && !testing::Test::HasFailure(); ++i) {
        SCOPED_TRACE("node " + std::to_string(i));
        expectSameBoxes(nodes[i], expected[i]);
    }
    // Leaves that stay are recognized by their stored numbers.
    const auto expectNear = [&](float found, float tight) {
        EXPECT_NEAR(found, tight, stay > 0 ? std::abs(tight) * 0x1p-22f : 0);
    };
    for (int axis = 0; axis < 3; ++axis) {
        expectNear(result.box.lo[axis], bvh.nodes[0].box.lo[axis]);
        expectNear(result.box.hi[axis], bvh.nodes[0].box.hi[axis]);
    }
    const double cost = expectedCost(bvh, 2);
    EXPECT_NEAR(result.cost, cost, 1e-5 * cost);
}

// About 0 too, where margins are no ulps, and so many that nodes wait for runs behind theirs.
TEST(RefitTest, NodesHaveTheBoxesThatANewTreeWouldStore) {
    for (const size_t count : {1u, 2u, 3u, 100u, 60000u}) {
        std::vector<Box> others = randomBoxes(count, 2);
        for (size_t i = 1; i < count; i += 5) others[i] = boxAround(glm::vec3(0), i % 2 == 0 ? 0 : 1e-35f);
        for (const uint32_t stay : {0u, 1u, 2u})
            for (const unsigned threads : {1u, 3u}) {
                SCOPED_TRACE(std::to_string(count) + " boxes, stay " + std::to_string(stay));
                expectRefitted(randomBoxes(count, 1), others, stay, threads);
            }
    }
}

}  // namespace glint::refit_test
