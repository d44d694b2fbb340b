#include "bvh/wide_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "bvh/flatten.h"
#include "trees.h"

namespace glint::wide_tree_test {
namespace {

using namespace test;
using shared::kLeafFlag;
using shared::kNone;

bool contains(const Box& outer, const Box& inner) {
    return glm::all(glm::lessThanEqual(outer.lo, inner.lo)) &&
           glm::all(glm::lessThanEqual(inner.hi, outer.hi));
}

// Leaves' words below a node of the binary tree, with their boxes.
using Leaves = std::multimap<uint32_t, Box>;

void collect(const std::vector<shared::Node>& nodes, uint32_t index, Leaves& leaves) {
    const shared::Node& node = nodes[index];
    const auto child = [&](uint32_t word, const Box& box) {
        if (word == kNone) return;
        if (word & kLeafFlag)
            leaves.insert({word, box});
        else
            collect(nodes, word, leaves);
    };
    child(node.child0, {node.lo0, node.hi0});
    child(node.child1, {node.lo1, node.hi1});
}

uint32_t wordOf(const shared::WideRow& row, uint32_t i) {
    return i == 0 ? row.x : i == 1 ? row.y : i == 2 ? row.z : row.w;
}
float floatOf(const shared::WideRow& row, uint32_t i) {
    return std::bit_cast<float>(wordOf(row, i));
}
uint32_t byteOf(uint32_t low, uint32_t high, uint32_t i) {
    return ((i < 4 ? low : high) >> 8 * (i % 4)) & 0xff;
}

struct Child {
    Box box;
    uint32_t word = kNone;
};

float atLeast(double x) {
    const auto f = static_cast<float>(x);
    return f < x ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

// Of a node of four along an axis: planes are origin + step * (256 + byte).
double stepOfFour(const shared::WideRow& head, int axis) {
    const auto exponent = static_cast<int>(head.w >> 8 * axis & 0xff);
    EXPECT_GT(exponent, 0);
    EXPECT_LT(exponent, 255);
    return std::ldexp(1.0, exponent - 127 - 8);
}
// Bytes of the lower planes, of the upper ones.
std::pair<uint32_t, uint32_t> planesOfFour(const shared::WideRow* rows, int axis) {
    if (axis == 0) return {rows[1].x, rows[1].y};
    return axis == 1 ? std::pair(rows[1].z, rows[1].w) : std::pair(rows[2].x, rows[2].y);
}

// Boxes less the 2^-15 of a step by which the device may take their planes for further in.
std::vector<Child> fourOf(const WideTree& tree, uint32_t node) {
    std::vector<Child> children(4);
    const shared::WideRow* rows = &tree.rows[size_t{shared::kFourRows} * node];
    const uint32_t links = rows[2].w;
    const uint32_t absent[] = {0, rows[0].w >> 31, rows[2].z, links >> 31};
    for (uint32_t i = 0; i < 4; ++i) {
        children[i].word = wordOf(rows[3], i);
        EXPECT_EQ(absent[i], children[i].word != kNone ? 0u : i == 2 ? ~0u : 1u);
        // Inner children come first and follow each other.
        const bool inner = (children[i].word & shared::kLeafFlag) == 0;  // of kNone too it is set
        EXPECT_EQ(links >> (shared::kFourInnerShift + i) & 1, inner ? 1u : 0u);
        if (inner) {
            EXPECT_EQ(children[i].word, (links & 0xffffff) + i);
        }
        if (children[i].word == kNone) continue;
        for (int axis = 0; axis < 3; ++axis) {
            const double origin = floatOf(rows[0], static_cast<uint32_t>(axis));
            const double step = stepOfFour(rows[0], axis), slack = std::ldexp(step, -15);
            const auto [lo, hi] = planesOfFour(rows, axis);
            children[i].box.lo[axis] = atLeast(origin + (256 + byteOf(lo, 0, i)) * step + slack);
            children[i].box.hi[axis] = -atLeast(-(origin + (256 + byteOf(hi, 0, i)) * step - slack));
        }
    }
    return children;
}

// As the paper has it: 80 bytes, from which planes come by one product and one sum of floats.
std::vector<Child> eightOf(const WideTree& tree, uint32_t node) {
    std::vector<Child> children(8);
    const shared::WideRow* rows = &tree.rows[size_t{shared::kCompressedRows} * node];
    const uint32_t inner = rows[0].w >> 24, leaf = rows[1].z;
    EXPECT_EQ(inner & leaf, 0u);
    EXPECT_EQ(leaf >> 8, 0u);
    uint32_t nextNode = rows[1].x, nextLeaf = rows[1].y;
    for (uint32_t i = 0; i < 8; ++i) {
        if (inner >> i & 1) children[i].word = nextNode++;
        if (leaf >> i & 1) {
            children[i].word = wordOf(tree.rows[nextLeaf / 4], nextLeaf % 4);
            ++nextLeaf;
        }
        if (children[i].word == kNone) continue;
        for (int axis = 0; axis < 3; ++axis) {
            const shared::WideRow& planes = rows[2 + axis];
            const float step = std::bit_cast<float>((rows[0].w >> 8 * axis & 0xff) << 23);
            EXPECT_TRUE(std::isnormal(step));
            const float origin = floatOf(rows[0], static_cast<uint32_t>(axis));
            children[i].box.lo[axis] = origin + static_cast<float>(byteOf(planes.x, planes.y, i)) * step;
            children[i].box.hi[axis] = origin + static_cast<float>(byteOf(planes.z, planes.w, i)) * step;
        }
    }
    return children;
}

struct Visit {
    const WideTree& tree;
    NodeFormat format;
    Leaves leaves = {};
    std::vector<uint32_t> met = {};

    void node(uint32_t index) {
        met.resize(std::max<size_t>(met.size(), index + 1));
        ++met[index];
        for (const Child& c : format == NodeFormat::Four ? fourOf(tree, index) : eightOf(tree, index)) {
            if (c.word == kNone) {
                EXPECT_TRUE(c.box.empty());
            } else if (c.word & kLeafFlag) {
                leaves.insert({c.word, c.box});
            } else {
                node(c.word);
            }
        }
    }
};

const NodeFormat kFormats[] = {NodeFormat::Four, NodeFormat::Compressed};

void expectSameLeaves(const Leaves& found, const Leaves& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (const auto& [word, box] : found) {
        const auto [first, last] = expected.equal_range(word);
        EXPECT_TRUE(std::any_of(first, last, [&](const auto& leaf) { return contains(box, leaf.second); }));
    }
}

TEST(WideTree, HasTheLeavesOfTheBinaryTreeEachOnceInBoxesThatHoldThem) {
    for (const BoxSet& set : hardSets()) {
        if (set.boxes.empty()) continue;
        const std::vector<shared::Node> nodes = flattenBvh(buildBvh(set.boxes), {});
        Leaves expected;
        collect(nodes, 0, expected);
        for (const NodeFormat format : kFormats) {
            // 256 steps of a grid are a float, so nodes of four are for coordinates up to 2^125; those of
            // scenes go up to 1e18.
            if (format == NodeFormat::Four && set.name == "near the end of fp32") continue;
            SCOPED_TRACE(set.name + (format == NodeFormat::Four ? ", four" : ", compressed"));
            const WideTree tree = wideTree(nodes, format);
            EXPECT_TRUE(tree.roots.empty());
            Visit visit{tree, format};
            visit.node(0);
            EXPECT_TRUE(std::all_of(visit.met.begin(), visit.met.end(), [](uint32_t n) { return n == 1; }));
            expectSameLeaves(visit.leaves, expected);
        }
    }
}

std::vector<Box> flatBoxes(float scale, float offset) {
    std::vector<Box> boxes = randomBoxes(500, 3);
    for (Box& box : boxes) {
        box.lo = (box.lo * 0.01f + offset) * (scale / (offset + 1));
        box.hi = (box.hi * 0.01f + offset) * (scale / (offset + 1));
        box.hi.z = box.lo.z;
    }
    return boxes;
}

// That a node's grid is no coarser than floats can tell or 1/127 of the node.
void expectFineGrids(const WideTree& tree, NodeFormat format, uint32_t node) {
    Box around;
    for (const Child& c : format == NodeFormat::Four ? fourOf(tree, node) : eightOf(tree, node)) {
        if (c.word != kNone) around.include(c.box);
    }
    const size_t rows = format == NodeFormat::Four ? shared::kFourRows : shared::kCompressedRows;
    const shared::WideRow head = tree.rows[rows * node];
    for (int axis = 0; axis < 3; ++axis) {
        const double step = format == NodeFormat::Four
                                ? stepOfFour(head, axis)
                                : std::bit_cast<float>((head.w >> 8 * axis & 0xff) << 23);
        const double extent = double(around.hi[axis]) - around.lo[axis];
        const double digit = std::abs(around.hi[axis]) * 0x1p-23 + 0x1p-99;
        EXPECT_LE(step, std::max(extent / 126, digit)) << axis;
    }
}

// Where floats are far apart beside a node's size, at the least and greatest coordinates, and flat: the
// decoded box of every child holds its box, and is no more than two steps of the node's grid larger, or what
// floats can tell.
TEST(WideTree, BoxesHoldTheirChildrenAndLittleMore) {
    for (const float scale : {1.0f, 1e-30f, 1e-18f, 1e18f, 3e37f}) {
        for (const float offset : {0.0f, 1.0f, 1000.0f, 1e6f}) {
            const std::vector<shared::Node> nodes = flattenBvh(buildBvh(flatBoxes(scale, offset)), {});
            Leaves expected;
            collect(nodes, 0, expected);
            for (const NodeFormat format : kFormats) {
                SCOPED_TRACE("scale " + std::to_string(scale) + ", offset " + std::to_string(offset));
                const WideTree tree = wideTree(nodes, format);
                Visit visit{tree, format};
                visit.node(0);
                expectSameLeaves(visit.leaves, expected);
                for (uint32_t node = 0; node < visit.met.size(); ++node) expectFineGrids(tree, format, node);
            }
        }
    }
}

// As meetAxisOfFour in shaders/wide_nodes.glsl has the planes, seen from origins within the node, in its
// planes and far away: never further in than the child's box, whose differences are rounded once, but for one
// more rounding.
TEST(WideTree, PlanesOfFourEncloseAsTheDeviceRoundsThem) {
    constexpr double kUnit = 0x1p-24;
    for (const float scale : {1.0f, 1e-18f, 1e18f}) {
        for (const float offset : {0.0f, 1.0f, 1e6f}) {
            const std::vector<Box> boxes = flatBoxes(scale, offset);
            const std::vector<shared::Node> nodes = flattenBvh(buildBvh(boxes), {});
            Leaves leaves;
            collect(nodes, 0, leaves);
            const WideTree tree = wideTree(nodes, NodeFormat::Four);
            size_t inwards = 0, planes = 0;
            for (uint32_t node = 0; node < tree.rows.size() / shared::kFourRows; ++node) {
                const shared::WideRow* rows = &tree.rows[size_t{shared::kFourRows} * node];
                for (uint32_t i = 0; i < 4; ++i) {
                    const auto found = leaves.find(wordOf(rows[3], i));
                    if (found == leaves.end() || leaves.count(found->first) != 1) continue;
                    for (int axis = 0; axis < 3; ++axis) {
                        const float lo = found->second.lo[axis], hi = found->second.hi[axis];
                        const float steps256 = static_cast<float>(256 * stepOfFour(rows[0], axis));
                        const auto [lower, upper] = planesOfFour(rows, axis);
                        for (const float from :
                             {lo, hi, 0.5f * (lo + hi), boxes[0].lo[axis], 0.0f, 3 * scale, -1000 * scale}) {
                            const float away = floatOf(rows[0], static_cast<uint32_t>(axis)) - from;
                            const auto seen = [&](uint32_t bytes) {
                                const uint32_t byte = byteOf(bytes, 0, i);
                                return std::bit_cast<float>(std::bit_cast<uint32_t>(steps256) | byte << 15) +
                                       away;
                            };
                            const double below = double(lo) - from, above = double(hi) - from;
                            inwards += seen(lower) > below + 2.001 * kUnit * std::abs(below);
                            inwards += seen(upper) < above - 2.001 * kUnit * std::abs(above);
                            planes += 2;
                        }
                    }
                }
            }
            EXPECT_EQ(inwards, 0u) << scale << ", " << offset;
            EXPECT_GT(planes, 1000u);
        }
    }
}

// So that slot ^ octant is about the order that rays meet children in: of eight boxes in the corners of a
// cube each has the slot that names its corner.
TEST(WideTree, ChildrenStandInTheSlotsOfTheirCorners) {
    std::vector<Box> boxes;
    for (int corner = 0; corner < 8; ++corner)
        boxes.push_back(boxAround({corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1}, 0.1f));
    BvhOptions options;
    options.maxLeafSize = 1;
    const WideTree tree = wideTree(flattenBvh(buildBvh(boxes, options), {}), NodeFormat::Compressed);
    const std::vector<Child> children = eightOf(tree, 0);
    for (uint32_t slot = 0; slot < 8; ++slot) {
        ASSERT_NE(children[slot].word, kNone);
        const glm::vec3 center = children[slot].box.lo + children[slot].box.hi;
        EXPECT_EQ(center.x > 0, (slot & 1) != 0) << slot;
        EXPECT_EQ(center.y > 0, (slot & 2) != 0) << slot;
        EXPECT_EQ(center.z > 0, (slot & 4) != 0) << slot;
    }
}

// Two trees in one array of nodes, the second one shown twice.
TEST(WideTree, InstancesStartAtTheirOwnTrees) {
    std::vector<shared::Node> nodes = flattenBvh(buildBvh(randomBoxes(40, 5)), {});
    const auto root = static_cast<uint32_t>(nodes.size());
    for (shared::Node node : flattenBvh(buildBvh(randomBoxes(300, 6)), {})) {
        for (uint32_t* child : {&node.child0, &node.child1}) {
            if (*child != kNone && !(*child & kLeafFlag)) *child += root;
        }
        nodes.push_back(node);
    }
    std::vector<shared::Instance> instances(3);
    instances[0].root = instances[2].root = root;
    for (const NodeFormat format : kFormats) {
        const WideTree tree = wideTree(nodes, format, instances);
        ASSERT_EQ(tree.roots.size(), 3u);
        EXPECT_EQ(tree.roots[1], 0u);
        EXPECT_EQ(tree.roots[0], tree.roots[2]);
        Visit visit{tree, format};
        for (const uint32_t start : {0u, tree.roots[0]}) {
            visit.leaves.clear();
            visit.node(start);
            Leaves expected;
            collect(nodes, start == 0 ? 0 : root, expected);
            expectSameLeaves(visit.leaves, expected);
        }
        EXPECT_TRUE(std::all_of(visit.met.begin(), visit.met.end(), [](uint32_t n) { return n == 1; }));
    }
}

TEST(WideTree, Sizes) {
    EXPECT_TRUE(wideTree({}, NodeFormat::Four).rows.empty());
    EXPECT_TRUE(wideTree({}, NodeFormat::Compressed).rows.empty());
    const std::vector<shared::Node> one = flattenBvh(buildBvh(randomBoxes(1, 1)), {});
    EXPECT_TRUE(wideTree(one, NodeFormat::Two).rows.empty());
    EXPECT_EQ(wideTree(one, NodeFormat::Four).rows.size() * sizeof(shared::WideRow), 64u);
    // And a row for the leaf's word.
    EXPECT_EQ(wideTree(one, NodeFormat::Compressed).rows.size() * sizeof(shared::WideRow), 80u + 16u);
    const std::vector<shared::Node> many = flattenBvh(buildBvh(randomBoxes(20000, 2)), {});
    const size_t binary = many.size() * sizeof(shared::Node);
    EXPECT_LT(wideTree(many, NodeFormat::Four).rows.size() * sizeof(shared::WideRow), binary);
    EXPECT_LT(wideTree(many, NodeFormat::Compressed).rows.size() * sizeof(shared::WideRow), binary / 2);
}

}  // namespace
}  // namespace glint::wide_tree_test
