#include "bvh/refit.h"

#include <vector>

#include "bvh/collapse.h"
#include "bvh/flatten.h"
#include "core/parallel.h"

namespace glint {
namespace {

constexpr size_t kRefitChunk = 8192;  // nodes that one thread treats at a time

Box unionOf(const Box& a, const Box& b) {
    Box both = a;
    both.include(b);
    return both;
}

// The boxes of a node's children. A leaf that stays keeps the one it is stored with, which is widened
// already: to widen it with every refit would let it grow.
struct Pair {
    Box first, second;
    bool keepsFirst = false, keepsSecond = false;

    Box both() const { return unionOf(first, second); }
    void store(shared::Node& node) const {
        if (!keepsFirst) {
            const Box box = storedBox(first);
            node.lo0 = box.lo;
            node.hi0 = box.hi;
        }
        if (!keepsSecond) {
            const Box box = storedBox(second);
            node.lo1 = box.lo;
            node.hi1 = box.hi;
        }
    }
};

// Half areas, each child's times what a ray that meets it does there.
struct CostSum {
    double primitives = 0, nodes = 0;

    void add(uint32_t child, const Box& box) {
        if (child == shared::kNone) return;
        if (isInnerChild(child)) {
            nodes += box.halfArea();
        } else {
            const uint32_t more = child >> shared::kLeafCountShift & shared::kLeafCountMask;
            primitives += box.halfArea() * (more + 1);
        }
    }
};

}  // namespace

RefitResult refitNodes(std::span<shared::Node> nodes, double traversalCost,
                       const std::function<std::optional<Box>(uint32_t child)>& leafBox, unsigned threads) {
    RefitResult result;
    if (nodes.empty()) return result;
    std::vector<Pair> pairs(nodes.size());
    const auto leaf = [&](uint32_t child, const Box& stored, Box& box, bool& keeps) {
        if (isInnerChild(child)) return;
        const std::optional<Box> tight = child == shared::kNone ? std::nullopt : leafBox(child);
        keeps = !tight;
        box = tight.value_or(stored);
    };
    const auto leaves = [&](size_t chunk) {
        const size_t end = std::min(nodes.size(), (chunk + 1) * kRefitChunk);
        for (size_t i = chunk * kRefitChunk; i < end; ++i) {
            const shared::Node& node = nodes[i];
            leaf(node.child0, {node.lo0, node.hi0}, pairs[i].first, pairs[i].keepsFirst);
            leaf(node.child1, {node.lo1, node.hi1}, pairs[i].second, pairs[i].keepsSecond);
        }
    };
    parallelFor((nodes.size() + kRefitChunk - 1) / kRefitChunk, leaves, threads);
    // Children stand behind their parents.
    CostSum sum;
    for (size_t i = nodes.size(); i-- > 0;) {
        shared::Node& node = nodes[i];
        Pair& pair = pairs[i];
        if (isInnerChild(node.child0)) pair.first = pairs[node.child0].both();
        if (isInnerChild(node.child1)) pair.second = pairs[node.child1].both();
        sum.add(node.child0, pair.first);
        sum.add(node.child1, pair.second);
        pair.store(node);
    }
    result.box = pairs[0].both();
    const double area = result.box.halfArea();
    const double all = sum.primitives + traversalCost * sum.nodes;
    const bool single = nodes[0].child1 == shared::kNone;
    result.cost = (single ? 0 : traversalCost) + (area > 0 ? all / area : 0);
    return result;
}

}  // namespace glint
