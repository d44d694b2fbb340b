#include "bvh/refit.h"

#include <algorithm>
#include <vector>

#include "bvh/collapse.h"
#include "bvh/stored_box.h"
#include "core/parallel.h"

namespace glint {
namespace {

constexpr size_t kRefitChunk = 8192;  // nodes that one thread treats at a time

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
    void add(const CostSum& other) {
        primitives += other.primitives;
        nodes += other.nodes;
    }
};

// One of a node's boxes, and which corners have it.
struct Side {
    glm::vec3 &lo, &hi;
    uint32_t child;

    RegisterBox box() const { return {Lanes::load(&lo.x), Lanes::load(&hi.x)}; }
    // Each corner shares a row with a word of another meaning.
    void set(const RegisterBox& b) const {
        b.lo.withWOf(Lanes::load(&lo.x)).store(&lo.x);
        b.hi.withWOf(Lanes::load(&hi.x)).store(&hi.x);
    }
};
Side firstOf(shared::Node& node) {
    return {node.lo0, node.hi0, node.child0};
}
Side secondOf(shared::Node& node) {
    return {node.lo1, node.hi1, node.child1};
}

using LeafBox = std::function<std::optional<Box>(uint32_t child)>;

// Nodes that lie side by side. Children stand behind their parents, so a run taken from its end on needs no
// others, but for the nodes of which a child is not in it or waits itself. Stored boxes are joined, not tight
// ones: as storedBox is monotonic, it makes no difference.
class Run {
  public:
    void work(std::span<shared::Node> nodes, size_t first, size_t end, const LeafBox& leafBox) {
        for (size_t i = first; i < end; ++i)
            for (const Side& side : {firstOf(nodes[i]), secondOf(nodes[i])}) setLeaf(side, leafBox);
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
    const RegisterBox& leaves() const { return leaves_; }
    const CostSum& sum() const { return sum_; }

  private:
    // A leaf that stays keeps its box.
    void setLeaf(const Side& side, const LeafBox& leafBox) {
        if (side.child == shared::kNone || isInnerChild(side.child)) return;
        const std::optional<Box> moved = leafBox(side.child);
        const RegisterBox tight = moved ? RegisterBox::of(*moved) : side.box();
        leaves_ = unionOf(leaves_, tight);
        if (moved) side.set(storedBox(tight));
    }
    void finish(std::span<shared::Node> nodes, size_t i) {
        for (const Side& side : {firstOf(nodes[i]), secondOf(nodes[i])}) {
            RegisterBox box = side.box();
            if (isInnerChild(side.child)) {
                shared::Node& child = nodes[side.child];
                box = unionOf(firstOf(child).box(), secondOf(child).box());
                side.set(box);
            }
            sum_.add(side.child, box.box());
        }
    }

    std::vector<uint32_t> waiting_;
    RegisterBox leaves_ = RegisterBox::of({});  // their union, before any of it was widened
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
