// Trees compared by work counted: boxes and primitives' boxes that random lines meet.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "bvh/builder.h"
#include "trees.h"

namespace glint::builder_quality_test {
namespace {

using namespace test;

// The tree that the heuristic must beat: halves by count along the widest axis of the centroids.
class MedianBuilder {
  public:
    explicit MedianBuilder(const std::vector<Box>& boxes) : boxes_(boxes) {
        bvh_.order.resize(boxes.size());
        std::iota(bvh_.order.begin(), bvh_.order.end(), 0u);
        bvh_.nodes.resize(1);
        build(0, 0, static_cast<uint32_t>(boxes.size()));
    }
    const Bvh& bvh() const { return bvh_; }

  private:
    glm::vec3 centroid(uint32_t box) const { return 0.5f * (boxes_[box].lo + boxes_[box].hi); }

    void build(uint32_t node, uint32_t begin, uint32_t end) {
        Box box, centroids;
        for (uint32_t i = begin; i < end; ++i) {
            box.include(boxes_[bvh_.order[i]]);
            centroids.include(centroid(bvh_.order[i]));
        }
        bvh_.nodes[node] = {box, begin, end - begin};
        if (end - begin <= BvhOptions{}.maxLeafSize) return;
        const glm::vec3 extent = centroids.hi - centroids.lo;
        int axis = extent.x >= extent.y ? 0 : 1;
        if (extent.z > extent[axis]) axis = 2;
        const uint32_t middle = begin + (end - begin) / 2;
        std::nth_element(bvh_.order.begin() + begin, bvh_.order.begin() + middle, bvh_.order.begin() + end,
                         [&](uint32_t a, uint32_t b) { return centroid(a)[axis] < centroid(b)[axis]; });
        const uint32_t first = static_cast<uint32_t>(bvh_.nodes.size());
        bvh_.nodes.resize(bvh_.nodes.size() + 2);
        bvh_.nodes[node].first = first;
        bvh_.nodes[node].count = 0;
        build(first, begin, middle);
        build(first + 1, middle, end);
    }

    const std::vector<Box>& boxes_;
    Bvh bvh_;
};

bool meets(const Box& box, const glm::dvec3& o, const glm::dvec3& d) {
    double near = -1e30, far = 1e30;
    for (int axis = 0; axis < 3; ++axis) {
        const double t0 = (box.lo[axis] - o[axis]) / d[axis], t1 = (box.hi[axis] - o[axis]) / d[axis];
        near = std::max(near, std::min(t0, t1));
        far = std::min(far, std::max(t0, t1));
    }
    return near <= far;
}

// Inner nodes entered and primitives tested, for lines through two uniform points of the root's box.
double countedCost(const Bvh& bvh) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const glm::dvec3 lo(bvh.nodes[0].box.lo), size = glm::dvec3(bvh.nodes[0].box.hi) - lo;
    const auto point = [&] {
        const double x = unit(random), y = unit(random), z = unit(random);
        return lo + size * glm::dvec3(x, y, z);
    };
    uint64_t work = 0;
    constexpr int kRays = 500;
    for (int ray = 0; ray < kRays; ++ray) {
        const glm::dvec3 o = point(), d = point() - o;
        std::vector<uint32_t> pending{0};
        while (!pending.empty()) {
            const BvhNode& node = bvh.nodes[pending.back()];
            pending.pop_back();
            if (!meets(node.box, o, d)) continue;
            work += std::max(node.count, 1u);
            if (node.count == 0) pending.insert(pending.end(), {node.first, node.first + 1});
        }
    }
    return static_cast<double>(work) / kRays;
}

// A teapot in a stadium: most boxes crowd a corner, some large ones span the rest.
std::vector<Box> skewedScene() {
    std::vector<Box> boxes = randomBoxes(20000, 4);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    for (int i = 0; i < 2000; ++i) {
        const float x = unit(random), y = unit(random), z = unit(random);
        boxes.push_back(boxAround(100.0f * glm::vec3(x, y, z), 2.0f * unit(random)));
    }
    return boxes;
}

TEST(BuilderQuality, BeatsMedianSplitsOnSkewedScene) {
    const std::vector<Box> boxes = skewedScene();
    EXPECT_LT(countedCost(buildBvh(boxes)), 0.9 * countedCost(MedianBuilder(boxes).bvh()));
}

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

}  // namespace
}  // namespace glint::builder_quality_test
