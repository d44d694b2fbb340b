#include "bvh/flatten.h"

#include <gtest/gtest.h>

#include <functional>

#include "trees.h"

namespace glint::flatten_test {
using namespace test;
using shared::kLeafFlag;
using shared::kNone;

struct Slot {
    Box box;
    uint32_t child;
};

Slot slotOf(const std::vector<shared::Node>& nodes, uint32_t slot) {
    const shared::Node& n = nodes.at(slot / 2);
    Slot s;
    s.child = slot % 2 == 0 ? n.child0 : n.child1;
    s.box.lo = slot % 2 == 0 ? n.lo0 : n.lo1;
    s.box.hi = slot % 2 == 0 ? n.hi0 : n.hi1;
    return s;
}

using Enter = std::function<bool(const Box&)>;

// Leaves in depth-first order by recursion over the builder's tree: the truth for the walks below.
void recurse(const Bvh& bvh, uint32_t node, const Enter& enter, std::vector<uint32_t>& firsts) {
    const BvhNode& n = bvh.nodes[node];
    if (!enter(n.box)) return;
    if (n.count > 0) {
        firsts.push_back(n.first);
        return;
    }
    recurse(bvh, n.first, enter, firsts);
    recurse(bvh, n.first + 1, enter, firsts);
}

// The stackless traversal that uses the escapes: an entered inner child leads to its first slot; anything
// else to the next slot of the node, or past it.
std::vector<uint32_t> walk(const std::vector<shared::Node>& nodes, const Enter& enter) {
    std::vector<uint32_t> leaves;
    size_t steps = 0;
    for (uint32_t slot = nodes.empty() ? kNone : 0; slot != kNone;) {
        if (++steps > 2 * nodes.size()) {
            ADD_FAILURE() << "the walk does not end";
            return leaves;
        }
        const Slot s = slotOf(nodes, slot);
        const bool entered = s.child != kNone && enter(s.box);
        if (entered && (s.child & kLeafFlag) == 0) {
            slot = 2 * s.child;
            continue;
        }
        if (entered) leaves.push_back(s.child);
        slot = slot % 2 == 0 ? slot + 1 : nodes[slot / 2].escape;
    }
    return leaves;
}

// The same with a stack, first child first, reading only children.
std::vector<uint32_t> walkWithStack(const std::vector<shared::Node>& nodes, const Enter& enter) {
    std::vector<uint32_t> leaves, pending{0};
    while (!pending.empty() && !nodes.empty()) {
        const uint32_t child = pending.back();
        pending.pop_back();
        if ((child & kLeafFlag) != 0) {
            leaves.push_back(child);
            continue;
        }
        for (const uint32_t side : {1u, 0u}) {
            const Slot s = slotOf(nodes, 2 * child + side);
            if (s.child != kNone && enter(s.box)) pending.push_back(s.child);
        }
    }
    return leaves;
}

uint32_t firstOf(uint32_t leaf) {
    return leaf & shared::kLeafFirstMask;
}
uint32_t countOf(uint32_t leaf) {
    return (leaf >> shared::kLeafCountShift & shared::kLeafCountMask) + 1;
}
uint32_t kindOf(uint32_t leaf) {
    return leaf >> shared::kLeafKindShift & shared::kLeafKindMask;
}

bool everything(const Box&) {
    return true;
}

TEST(Flatten, WalksVisitTheSameLeavesInOrder) {
    for (const BoxSet& set : hardSets()) {
        SCOPED_TRACE(set.name);
        const Bvh bvh = buildBvh(set.boxes);
        const std::vector<shared::Node> nodes = flattenBvh(bvh, {});
        if (set.boxes.empty()) {
            EXPECT_TRUE(nodes.empty());
            continue;
        }
        const Box& all = bvh.nodes[0].box;
        const glm::vec3 middle = 0.5f * all.lo + 0.5f * all.hi;
        const std::vector<Enter> queries{
            everything, [&](const Box& b) { return b.lo.x <= middle.x; },
            [&](const Box& b) { return b.hi.x >= middle.x && b.hi.y >= middle.y; },
            [&](const Box& b) { return b.lo.z <= middle.z && b.hi.x >= middle.x; },
            [&](const Box& b) {
                return glm::all(glm::lessThanEqual(b.lo, middle)) &&
                       glm::all(glm::lessThanEqual(middle, b.hi));
            }};
        for (const Enter& enter : queries) {
            std::vector<uint32_t> truth, firsts;
            recurse(bvh, 0, enter, truth);
            const std::vector<uint32_t> leaves = walk(nodes, enter);
            for (const uint32_t leaf : leaves) firsts.push_back(firstOf(leaf));
            // With one kind, `first` in the array of the kind is `first` in leaf order.
            EXPECT_EQ(firsts, truth);
            EXPECT_EQ(walkWithStack(nodes, enter), leaves);
        }
    }
}

// Flattening widens boxes by one ulp or 2^-100, whichever is more, and never by more than two ulps.
void expectWidened(const glm::vec3& lo, const glm::vec3& hi, const Box& tight) {
    for (int i = 0; i < 3; ++i) {
        const auto bound = [](float x) { return std::max(std::abs(x) * 0x1p-22f, 0x1p-99f); };
        EXPECT_LT(lo[i], tight.lo[i]);
        EXPECT_GE(lo[i], tight.lo[i] - bound(tight.lo[i]));
        EXPECT_GT(hi[i], tight.hi[i]);
        EXPECT_LE(hi[i], tight.hi[i] + bound(tight.hi[i]));
    }
}

TEST(Flatten, NodesHoldChildrensBoxes) {
    const std::vector<Box> boxes = randomBoxes(3000, 1);
    const Bvh bvh = buildBvh(boxes);
    const std::vector<shared::Node> nodes = flattenBvh(bvh, {});
    // Each inner node of the tree becomes a node, each child of one a slot.
    EXPECT_EQ(2 * nodes.size(), bvh.nodes.size() - 1);
    struct Entry {
        uint32_t node, bvhNode;
    };
    std::vector<Entry> pending{{0, 0}};
    while (!pending.empty()) {
        const Entry e = pending.back();
        pending.pop_back();
        for (uint32_t side = 0; side < 2; ++side) {
            const Slot s = slotOf(nodes, 2 * e.node + side);
            const BvhNode& child = bvh.nodes[bvh.nodes[e.bvhNode].first + side];
            expectWidened(s.box.lo, s.box.hi, child.box);
            ASSERT_EQ((s.child & kLeafFlag) != 0, child.count > 0);
            if (child.count > 0) {
                EXPECT_EQ(countOf(s.child), child.count);
                EXPECT_EQ(firstOf(s.child), child.first);
                EXPECT_EQ(kindOf(s.child), shared::kKindTriangle);
            } else {
                if (side == 0) {
                    EXPECT_EQ(s.child, e.node + 1);
                }
                EXPECT_GT(s.child, e.node);
                pending.push_back({s.child, bvh.nodes[e.bvhNode].first + side});
            }
        }
    }
}

TEST(Flatten, SingleLeaf) {
    const std::vector<Box> boxes(3, boxAround({1, 2, 3}, 1));
    const std::vector<shared::Node> nodes = flattenBvh(buildBvh(boxes), {});
    ASSERT_EQ(nodes.size(), 1u);
    EXPECT_EQ(nodes[0].child0, kLeafFlag | 2u << shared::kLeafCountShift);
    expectWidened(nodes[0].lo0, nodes[0].hi0, boxes[0]);
    EXPECT_EQ(nodes[0].child1, kNone);
    EXPECT_EQ(nodes[0].lo1, glm::vec3(std::numeric_limits<float>::max()));
    EXPECT_EQ(nodes[0].hi1, glm::vec3(-std::numeric_limits<float>::max()));
    EXPECT_EQ(nodes[0].escape, kNone);
}

// Two kinds: each leaf names one kind, and the leaves of a kind cover its array from 0 in order without gaps.
TEST(Flatten, KindsHaveArraysOfTheirOwn) {
    const std::vector<Box> boxes = randomBoxes(1000, 5);
    std::vector<uint8_t> kinds;
    uint32_t spheres = 0;
    for (size_t i = 0; i < boxes.size(); ++i) {
        kinds.push_back(static_cast<uint8_t>(i % 3 == 0 ? shared::kKindSphere : shared::kKindTriangle));
        spheres += i % 3 == 0;
    }
    const Bvh bvh = buildBvh(boxes, {.groups = &kinds});
    uint32_t next[2] = {0, 0};
    for (const uint32_t leaf : walk(flattenBvh(bvh, kinds), everything)) {
        ASSERT_LT(kindOf(leaf), 2u);
        EXPECT_EQ(firstOf(leaf), next[kindOf(leaf)]);
        next[kindOf(leaf)] += countOf(leaf);
    }
    EXPECT_EQ(next[shared::kKindSphere], spheres);
    EXPECT_EQ(next[shared::kKindTriangle], 1000 - spheres);
}

}  // namespace glint::flatten_test
