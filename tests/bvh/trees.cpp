#include "trees.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace glint::test {

bool inside(const Box& inner, const Box& outer) {
    return glm::all(glm::lessThanEqual(outer.lo, inner.lo)) &&
           glm::all(glm::lessThanEqual(inner.hi, outer.hi));
}

namespace {

void expectValidLeaf(const Bvh& bvh, const BvhNode& leaf, const std::vector<Box>& boxes,
                     const BvhOptions& options, std::vector<int>& seen) {
    ASSERT_LE(leaf.count, options.maxLeafSize);
    ASSERT_LE(size_t{leaf.first} + leaf.count, bvh.order.size());
    for (uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
        const uint32_t box = bvh.order[i];
        ASSERT_LT(box, boxes.size());
        ++seen[box];
        EXPECT_TRUE(inside(boxes[box], leaf.box));
        if (i > leaf.first) {
            EXPECT_LT(bvh.order[i - 1], box);
        }
        if (options.groups != nullptr) {
            EXPECT_EQ((*options.groups)[box], (*options.groups)[bvh.order[leaf.first]]);
        }
    }
}

}  // namespace

Box boxAround(const glm::vec3& center, float halfEdge) {
    Box box;
    box.include(center - halfEdge);
    box.include(center + halfEdge);
    return box;
}

std::vector<Box> randomBoxes(size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    std::vector<Box> boxes;
    for (size_t i = 0; i < count; ++i) {
        const float x = unit(random), y = unit(random), z = unit(random);
        boxes.push_back(boxAround({x, y, z}, 0.02f * unit(random)));
    }
    return boxes;
}

std::vector<BoxSet> hardSets() {
    std::vector<BoxSet> sets;
    sets.push_back({"random", randomBoxes(20000, 1)});
    sets.push_back({"1000 identical (T46)", std::vector<Box>(1000, boxAround({1, 2, 3}, 0.5f))});
    sets.push_back({"100001 identical (T46)", std::vector<Box>(100001, boxAround({1, 2, 3}, 0.5f))});
    sets.push_back({"identical points", std::vector<Box>(777, boxAround({1, 2, 3}, 0.0f))});
    const auto add = [&](const char* name, int first, int last, auto&& box) {
        sets.push_back({name, {}});
        for (int i = first; i <= last; ++i) sets.back().boxes.push_back(box(i));
    };
    add("powers of two (T48)", -60, 60, [](int i) { return boxAround({std::ldexp(1.0f, i), 0, 0}, 0.0f); });
    add("powers of two with area", -60, 60, [](int i) {
        const float x = std::ldexp(1.0f, i);
        return boxAround({x, x, 0}, 0.25f * x);
    });
    add("ascending line", 0, 4999, [](int i) { return boxAround({static_cast<float>(i), 0, 0}, 0.5f); });
    add("descending line of points", 0, 4999, [](int i) {
        return boxAround({0, static_cast<float>(-i), 0}, 0.0f);
    });
    add("nested concentric (T49)", 1, 1000, [](int i) {
        return boxAround({0, 0, 0}, static_cast<float>(i));
    });
    add("flat grid", 0, 4095, [](int i) {
        return boxAround({static_cast<float>(i % 64), 0, static_cast<float>(i / 64)}, 0.0f);
    });
    add("near the end of fp32", -100, 100, [](int i) {
        return boxAround({static_cast<float>(i) * 3e36f, 0, 1e38f}, 1e36f);
    });
    add("size 1e18", -500, 500, [](int i) {
        return boxAround({static_cast<float>(i) * 1e15f, 0, 0}, 1e18f);
    });
    add("denormal spacing", 0, 99, [](int i) {
        return boxAround({static_cast<float>(i) * 1e-44f, 0, 0}, 1);
    });

    std::vector<Box> duplicates = randomBoxes(2000, 2);
    for (size_t i = 0; i < 2000; ++i) duplicates.insert(duplicates.end(), i % 7, duplicates[i]);
    sets.push_back({"duplicates (T47)", duplicates});
    for (size_t count = 0; count <= 9; ++count)
        sets.push_back({std::to_string(count) + " boxes (T49)", randomBoxes(count, 3)});
    return sets;
}

uint32_t halvings(size_t count, uint32_t leaf) {
    uint32_t levels = 0;
    for (; count > leaf; count = (count + 1) / 2) ++levels;
    return levels;
}

void expectValid(const Bvh& bvh, const std::vector<Box>& boxes, const BvhOptions& options) {
    ASSERT_EQ(bvh.order.size(), boxes.size());
    ASSERT_EQ(bvh.nodes.empty(), boxes.empty());
    if (boxes.empty()) return;
    struct Entry {
        uint32_t node, depth;
    };
    std::vector<Entry> pending{{0, 0}};
    std::vector<int> seen(boxes.size(), 0), visited(bvh.nodes.size(), 0);
    uint32_t depth = 0;
    while (!pending.empty()) {
        const Entry e = pending.back();
        pending.pop_back();
        ASSERT_EQ(visited[e.node]++, 0);
        depth = std::max(depth, e.depth);
        const BvhNode& node = bvh.nodes[e.node];
        if (node.count > 0) {
            ASSERT_NO_FATAL_FAILURE(expectValidLeaf(bvh, node, boxes, options, seen));
            continue;
        }
        for (uint32_t child = node.first; child <= node.first + 1; ++child) {
            ASSERT_LT(child, bvh.nodes.size());
            EXPECT_TRUE(inside(bvh.nodes[child].box, node.box));
            pending.push_back({child, e.depth + 1});
        }
    }
    EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
    EXPECT_TRUE(std::all_of(visited.begin(), visited.end(), [](int n) { return n == 1; }));
    EXPECT_EQ(bvh.depth, depth);
    EXPECT_LE(depth, options.maxLevels);
}

}  // namespace glint::test
