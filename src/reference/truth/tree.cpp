// Split at one of a few planes by the surface area heuristic (I. Wald, "On Fast Construction of SAH Based
// Bounding Volume Hierarchies", 2007): of many items along the widest axis, of few along all three.
#include <algorithm>
#include <cmath>

#include "core/room.h"
#include "reference/truth/part.h"

namespace glint::reference::truth {
namespace {

using glm::dvec3;

constexpr uint32_t kMaxLeaf = 8;
constexpr int kPlanes = 7;  // along an axis
// From here on halves of equal numbers: 2^25 items then take 25 more levels.
constexpr uint32_t kDeep = 36;
static_assert(kDeep + 26 <= kMaxTreeDepth);

// Three axes take three times as long.
constexpr uint32_t kFew = 256;

struct Split {
    double cost = std::numeric_limits<double>::infinity();
    int axis = 0;
    double at = 0;  // middles from here on are on the right
};

dvec3 middleOf(const Item& item) {
    return 0.5 * item.box.lo + 0.5 * item.box.hi;
}

// Builds the tree and writes the primitives of each leaf as it is made.
class Builder {
  public:
    Builder(Part& part, std::vector<rows::Node>& nodes)
        : part_(part), items_(part.items), nodes_(nodes), model_(part.whole) {
        reserveMore(nodes, items_.size() / 2 + 1);
        reserveMore(model_.triangles, part.model.triangles.size());
        reserveMore(model_.triangleSurfaces, part.model.triangles.size());
    }

    uint32_t run() { return grow(0, static_cast<uint32_t>(items_.size()), 0).word; }

  private:
    struct Child {
        Bounds box;
        uint32_t word;  // as in rows::Node
    };

    Child grow(uint32_t first, uint32_t end, uint32_t depth) {
        Bounds box, middles;
        bool oneKind = true;
        for (uint32_t i = first; i < end; ++i) {
            box.include(items_[i].box);
            middles.include(middleOf(items_[i]));
            oneKind = oneKind && items_[i].kind == items_[first].kind;
        }
        // A leaf of instances holds one.
        const uint32_t most = items_[first].kind == shared::PrimitiveKind::Instance ? 1 : kMaxLeaf;
        const uint32_t count = end - first;
        const Split split = count == 1 ? Split{} : bestSplit(first, end, middles);
        const bool isLeaf =
            oneKind && count <= most && !(split.cost + box.halfArea() < count * box.halfArea());
        if (count == 1 || isLeaf) return {box, writeLeaf(first, end)};
        const auto index = static_cast<uint32_t>(nodes_.size());
        nodes_.emplace_back();
        const uint32_t middle = partition(first, end, depth, split);
        const Child left = grow(first, middle, depth + 1), right = grow(middle, end, depth + 1);
        rows::Node& node = nodes_[index];
        node.lo0 = left.box.lo;
        node.hi0 = left.box.hi;
        node.child0 = left.word;
        node.lo1 = right.box.lo;
        node.hi1 = right.box.hi;
        node.child1 = right.word;
        return {box, index};
    }

    uint32_t writeLeaf(uint32_t first, uint32_t end) {
        const shared::PrimitiveKind kind = items_[first].kind;
        size_t start = 0;
        switch (kind) {
#define GLINT_WRITE(number, Kind, KINDS, kinds, one, many)                                                 \
    case shared::PrimitiveKind::Kind:                                                                      \
        start = model_.kinds.size();                                                                       \
        for (uint32_t i = first; i < end; ++i) model_.kinds.push_back(part_.model.kinds[items_[i].index]); \
        break;
            GLINT_PRIMITIVES(GLINT_WRITE, GLINT_WRITE)
#undef GLINT_WRITE
        }
        if (kind == shared::PrimitiveKind::Triangle)
            for (uint32_t i = first; i < end; ++i)
                model_.triangleSurfaces.push_back(part_.model.triangleSurfaces[items_[i].index]);
        return shared::kLeafFlag | static_cast<uint32_t>(kind) << shared::kLeafKindShift |
               (end - first - 1) << shared::kLeafCountShift | static_cast<uint32_t>(start);
    }

    // Costs are areas times the number of tests on either side.
    Split bestSplit(uint32_t first, uint32_t end, const Bounds& middles) const {
        Split best;
        const dvec3 widths = middles.hi - middles.lo;
        for (int i = 0; i < 3 * kPlanes; ++i) {
            const int axis = i % 3;
            if (!(widths[axis] > 0) || (end - first > kFew && widths[axis] < greatestMagnitude(widths)))
                continue;
            const double at = middles.lo[axis] + widths[axis] * (i / 3 + 1) / (kPlanes + 1);
            Bounds boxes[2];
            uint32_t counts[2] = {0, 0};
            for (uint32_t item = first; item < end; ++item) {
                const bool right = middleOf(items_[item])[axis] >= at;
                boxes[right].include(items_[item].box);
                ++counts[right];
            }
            const double cost = counts[0] * boxes[0].halfArea() + counts[1] * boxes[1].halfArea();
            if (counts[0] > 0 && counts[1] > 0 && cost < best.cost) best = {cost, axis, at};
        }
        return best;
    }

    // Returns the first item on the right. If all are in one place, or too deep, the halves are of equal
    // numbers, by kind.
    uint32_t partition(uint32_t first, uint32_t end, uint32_t depth, const Split& split) {
        const auto begin = items_.begin() + first, behind = items_.begin() + end;
        if (depth < kDeep && std::isfinite(split.cost))
            return static_cast<uint32_t>(
                std::partition(begin, behind,
                               [&](const Item& item) { return middleOf(item)[split.axis] < split.at; }) -
                items_.begin());
        std::stable_sort(begin, behind, [](const Item& a, const Item& b) { return a.kind < b.kind; });
        return first + (end - first) / 2;
    }

    Part& part_;
    std::vector<Item>& items_;
    std::vector<rows::Node>& nodes_;
    Model& model_;
};

}  // namespace

uint32_t append(Part&& part, std::vector<rows::Node>& nodes) {
    return part.items.empty() ? shared::kNone : Builder(part, nodes).run();
}

}  // namespace glint::reference::truth
