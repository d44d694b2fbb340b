#include "bvh/packet_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "bvh/flatten.h"
#include "trees.h"

namespace glint::packet_tree_test {
using namespace test;
using shared::kLeafFlag;
using shared::kNone;
using shared::kPacketWidth;

using Leaves = std::multimap<uint32_t, Box>;

Leaves leavesOf(const std::vector<shared::Node>& nodes) {
    Leaves leaves;
    for (const shared::Node& node : nodes) {
        if (node.child0 != kNone && (node.child0 & kLeafFlag))
            leaves.insert({node.child0, {node.lo0, node.hi0}});
        if (node.child1 != kNone && (node.child1 & kLeafFlag))
            leaves.insert({node.child1, {node.lo1, node.hi1}});
    }
    return leaves;
}

// Visits the wide tree from its root; counts the visits of each node.
struct Visit {
    const std::vector<shared::PacketCorner>& corners;
    Leaves leaves = {};
    std::vector<uint32_t> met = std::vector<uint32_t>(corners.size() / (2 * kPacketWidth), 0u);

    void node(uint32_t index, const Box* around) {
        ASSERT_LT(index, met.size());
        ++met[index];
        for (uint32_t i = 0; i < kPacketWidth; ++i) {
            const shared::PacketCorner& lower = corners[size_t{index} * 2 * kPacketWidth + i];
            const Box box = {lower.corner,
                             corners[size_t{index} * 2 * kPacketWidth + kPacketWidth + i].corner};
            if (lower.child == kNone) {
                EXPECT_TRUE(box.empty());
                continue;
            }
            EXPECT_TRUE(around == nullptr || inside(box, *around));
            if (lower.child & kLeafFlag) {
                leaves.insert({lower.child, box});
            } else {
                node(lower.child, &box);
            }
        }
    }
};

TEST(PacketTree, HasTheLeavesOfTheBinaryTreeEachOnceInBoxesThatHoldThem) {
    for (const BoxSet& set : hardSets()) {
        if (set.boxes.empty()) continue;
        SCOPED_TRACE(set.name);
        const std::vector<shared::Node> nodes = flattenBvh(buildBvh(set.boxes), {});
        const std::vector<shared::PacketCorner> corners = packetTree(nodes);
        ASSERT_EQ(corners.size() % (2 * kPacketWidth), 0u);
        Visit visit{corners};
        visit.node(0, nullptr);
        EXPECT_TRUE(std::all_of(visit.met.begin(), visit.met.end(), [](uint32_t n) { return n == 1; }));
        const Leaves expected = leavesOf(nodes);
        ASSERT_EQ(visit.leaves.size(), expected.size());
        for (auto a = visit.leaves.begin(); a != visit.leaves.end(); ++a) {
            const auto [first, last] = expected.equal_range(a->first);
            EXPECT_TRUE(std::any_of(first, last, [&](const auto& leaf) {
                return leaf.second.lo == a->second.lo && leaf.second.hi == a->second.hi;
            }));
        }
    }
}

// The any-hit traversal of packets recognizes an inner child by its place alone.
TEST(PacketTree, InnerChildrenComeFirstAndFollowEachOther) {
    for (const BoxSet& set : hardSets()) {
        if (set.boxes.empty()) continue;
        SCOPED_TRACE(set.name);
        const std::vector<shared::PacketCorner> corners = packetTree(flattenBvh(buildBvh(set.boxes), {}));
        for (size_t node = 0; node < corners.size(); node += 2 * kPacketWidth) {
            bool innerEnded = false;
            for (uint32_t i = 0; i < kPacketWidth; ++i) {
                const uint32_t child = corners[node + i].child;
                const bool inner = (child & kLeafFlag) == 0;
                EXPECT_FALSE(inner && innerEnded);
                if (inner) {
                    EXPECT_EQ(child, corners[node].child + i);
                }
                innerEnded = innerEnded || !inner;
            }
        }
    }
}

TEST(PacketTree, OfNothingIsEmptyAndOfOneLeafIsOneNode) {
    EXPECT_TRUE(packetTree({}).empty());
    const std::vector<shared::Node> nodes = flattenBvh(buildBvh(randomBoxes(1, 1)), {});
    ASSERT_EQ(nodes.size(), 1u);
    const auto corners = packetTree(nodes);
    ASSERT_EQ(corners.size(), 2 * kPacketWidth);
    EXPECT_EQ(corners[0].child, nodes[0].child0);
    EXPECT_EQ(std::count_if(corners.begin(), corners.begin() + kPacketWidth,
                            [](const auto& c) { return c.child != kNone; }),
              1);
}

Box boxOf(const shared::Node& node) {
    Box box{node.lo0, node.hi0};
    box.include(Box{node.lo1, node.hi1});
    return box;
}

// The places that `child` takes in the wide node above it, if the binary nodes in `kept` stay.
uint32_t placesOf(const std::vector<shared::Node>& nodes, uint32_t child, uint32_t kept) {
    if ((child & kLeafFlag) || (kept >> child & 1)) return 1;
    return placesOf(nodes, nodes[child].child0, kept) + placesOf(nodes, nodes[child].child1, kept);
}

// The least sum of areas, by trying every choice of nodes that stay.
double leastAreas(const std::vector<shared::Node>& nodes) {
    double least = std::numeric_limits<double>::infinity();
    for (uint32_t kept = 1; kept < 1u << nodes.size(); kept += 2) {
        double sum = 0;
        bool fits = true;
        for (uint32_t i = 0; i < nodes.size() && fits; ++i) {
            if (!(kept >> i & 1)) continue;
            fits = placesOf(nodes, nodes[i].child0, kept) + placesOf(nodes, nodes[i].child1, kept) <=
                   kPacketWidth;
            sum += boxOf(nodes[i]).halfArea();
        }
        if (fits) least = std::min(least, sum);
    }
    return least;
}

TEST(PacketTree, NoOtherCollapseHasLessArea) {
    for (uint32_t seed = 1; seed <= 40; ++seed) {
        const std::vector<shared::Node> nodes =
            flattenBvh(buildBvh(randomBoxes(9 + seed % 6, seed), {.maxLeafSize = 1}), {});
        const std::vector<shared::PacketCorner> corners = packetTree(nodes);
        double sum = 0;
        for (size_t node = 0; node < corners.size(); node += 2 * kPacketWidth) {
            Box box;
            for (size_t i = node; i < node + kPacketWidth; ++i)
                if (corners[i].child != kNone)
                    box.include(Box{corners[i].corner, corners[i + kPacketWidth].corner});
            sum += box.halfArea();
        }
        EXPECT_NEAR(sum, leastAreas(nodes), 1e-6 * sum) << seed;
    }
}

}  // namespace glint::packet_tree_test
