#include "bvh/flatten.h"

#include <algorithm>
#include <array>

#include "bvh/lanes.h"
#include "core/parallel.h"

namespace glint {
namespace {

// Distance by which a stored box exceeds its contents: one ulp, and enough that a ray in the plane of a side
// (a direction of 0, whose inverse the shaders take for 2^125) is well inside.
Lanes storedMargin(Lanes x) {
    const Lanes magnitude = max(x, Lanes::all(0) - x);
    return max(magnitude * Lanes::all(0x1p-23f), Lanes::all(0x1p-100f));
}

// The box that a node stores for a child with this tight one, which is not empty: so much wider that no ray
// is lost by rounding.
LaneBox storedBox(const LaneBox& tight) {
    return {tight.lo - storedMargin(tight.lo), tight.hi + storedMargin(tight.hi)};
}

// A child still to be written, with the slot it belongs in and the slot that follows its subtree.
struct Pending {
    uint32_t bvhNode;
    uint32_t slot;
    uint32_t escape;
};

// One of a node's boxes, and the child that has it.
struct Side {
    glm::vec3 &lo, &hi;
    uint32_t& child;

    static Side of(shared::Node& node, bool second) {
        return second ? Side{node.lo1, node.hi1, node.child1} : Side{node.lo0, node.hi0, node.child0};
    }
    LaneBox box() const { return {Lanes::load(&lo.x), Lanes::load(&hi.x)}; }
    // Each corner shares a row with a word of another meaning.
    void set(const LaneBox& b) const {
        b.lo.withWOf(Lanes::load(&lo.x)).store(&lo.x);
        b.hi.withWOf(Lanes::load(&hi.x)).store(&hi.x);
    }
};

void setChild(std::vector<shared::Node>& nodes, uint32_t slot, const Box& tight, uint32_t child) {
    const Side side = Side::of(nodes[slot / 2], slot % 2 != 0);
    const Box box = tight.empty() ? tight : storedBox(LaneBox::of(tight)).box();
    side.lo = box.lo;
    side.hi = box.hi;
    side.child = child;
}

}  // namespace

std::vector<shared::Node> flattenBvh(const Bvh& bvh, const std::vector<uint8_t>& kinds,
                                     const Context& context) {
    std::vector<shared::Node> nodes;
    if (bvh.nodes.empty()) return nodes;
    nodes.reserve(bvh.nodes.size() / 2 + 1);
    // Leaves come in the order of Bvh::order, so the array of each kind fills up from its start.
    std::array<uint32_t, 256> filled{};
    const auto leafChild = [&](const BvhNode& leaf) {
        const uint32_t kind = kinds.empty() ? shared::kKindTriangle : kinds[bvh.order[leaf.first]];
        const uint32_t first = filled[kind];
        filled[kind] += leaf.count;
        return shared::kLeafFlag | kind << shared::kLeafKindShift |
               (leaf.count - 1) << shared::kLeafCountShift | first;
    };
    const auto addNode = [&](uint32_t escape) {
        nodes.emplace_back().escape = escape;
        return static_cast<uint32_t>(nodes.size() - 1);
    };

    std::vector<Pending> pending;
    const auto addChildren = [&](const BvhNode& parent, uint32_t node) {
        pending.push_back({parent.first + 1, 2 * node + 1, nodes[node].escape});
        pending.push_back({parent.first, 2 * node, 2 * node + 1});
    };
    const BvhNode& root = bvh.nodes[0];
    addNode(shared::kNone);
    if (root.count > 0) {
        setChild(nodes, 0, root.box, leafChild(root));
        setChild(nodes, 1, Box{}, shared::kNone);
        return nodes;
    }
    addChildren(root, 0);
    while (!pending.empty()) {
        context.pace(nodes.size());
        const Pending next = pending.back();
        pending.pop_back();
        const BvhNode& child = bvh.nodes[next.bvhNode];
        if (child.count > 0) {
            setChild(nodes, next.slot, child.box, leafChild(child));
        } else {
            const uint32_t node = addNode(next.escape);
            setChild(nodes, next.slot, child.box, node);
            addChildren(child, node);
        }
    }
    return nodes;
}

namespace {

constexpr size_t kRefitChunk = 8192;  // nodes that one thread treats at a time

// Sums of half areas: of inner children, and of leaves times their primitives.
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
    void add(const CostSum& other) {
        primitives += other.primitives;
        nodes += other.nodes;
    }
};

using LeafBox = std::function<std::optional<Box>(uint32_t child)>;

// Consecutive nodes. Children follow their parents, so a run is finished from its end. A node waits for other
// runs if one of its children is outside of the run, or waits itself. Joining stored boxes equals storing
// joined ones, as storedBox is monotonic.
class Run {
  public:
    void work(std::span<shared::Node> nodes, size_t first, size_t end, const LeafBox& leafBox) {
        for (size_t i = first; i < end; ++i)
            for (const Side& side : {Side::of(nodes[i], false), Side::of(nodes[i], true)})
                setLeaf(side, leafBox);
        std::vector<uint8_t> waits(end - first);
        const auto isReady = [&](uint32_t child) {
            return !isInnerChild(child) || (child < end && waits[child - first] == 0);
        };
        for (size_t i = end; i-- > first;) {
            if (isReady(nodes[i].child0) && isReady(nodes[i].child1)) {
                finish(nodes, i);
            } else {
                waits[i - first] = 1;
                waiting_.push_back(static_cast<uint32_t>(i));
            }
        }
    }
    // When those behind it are through.
    void finishWaiting(std::span<shared::Node> nodes) {
        for (const uint32_t i : waiting_) finish(nodes, i);
    }
    const LaneBox& leaves() const { return leaves_; }
    const CostSum& sum() const { return sum_; }

  private:
    // A leaf that stays keeps its box.
    void setLeaf(const Side& side, const LeafBox& leafBox) {
        if (side.child == shared::kNone || isInnerChild(side.child)) return;
        const std::optional<Box> moved = leafBox(side.child);
        const LaneBox tight = moved ? LaneBox::of(*moved) : side.box();
        leaves_.include(tight);
        if (moved) side.set(storedBox(tight));
    }
    void finish(std::span<shared::Node> nodes, size_t i) {
        for (const Side& side : {Side::of(nodes[i], false), Side::of(nodes[i], true)}) {
            LaneBox box = side.box();
            if (isInnerChild(side.child)) {
                shared::Node& child = nodes[side.child];
                box = Side::of(child, false).box();
                box.include(Side::of(child, true).box());
                side.set(box);
            }
            sum_.add(side.child, box.box());
        }
    }

    std::vector<uint32_t> waiting_;
    LaneBox leaves_;  // their union, before any of it was widened
    CostSum sum_;
};

}  // namespace

RefitResult refitNodes(std::span<shared::Node> nodes, double traversalCost,
                       const std::function<std::optional<Box>(uint32_t child)>& leafBox,
                       const Context& context) {
    RefitResult result;
    if (nodes.empty()) return result;
    std::vector<Run> runs((nodes.size() + kRefitChunk - 1) / kRefitChunk);
    parallelFor(context, runs.size(), [&](size_t i) {
        const size_t first = i * kRefitChunk;
        runs[i].work(nodes, first, std::min(nodes.size(), first + kRefitChunk), leafBox);
    });
    CostSum sum;
    for (size_t i = runs.size(); i-- > 0;) {
        runs[i].finishWaiting(nodes);
        result.box.include(runs[i].leaves().box());
        sum.add(runs[i].sum());
    }
    const double area = result.box.halfArea();
    const double all = sum.primitives + traversalCost * sum.nodes;
    const bool single = nodes[0].child1 == shared::kNone;
    result.cost = (single ? 0 : traversalCost) + (area > 0 ? all / area : 0);
    return result;
}

}  // namespace glint
