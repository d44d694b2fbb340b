// Split by the surface area heuristic over bins of the boxes' middles (I. Wald, "On Fast Construction of SAH
// Based Bounding Volume Hierarchies", 2007): of many items along the widest axis, of few along all three.
#include <algorithm>
#include <array>

#include "core/room.h"
#include "reference/truth/part.h"

namespace glint::reference::truth {
namespace {

using glm::dvec3;

constexpr size_t kBins = 16;
constexpr uint32_t kMaxLeaf = 8;
// From here on halves of equal numbers: 2^25 items then take 25 more levels.
constexpr uint32_t kDeep = 36;
static_assert(kDeep + 26 <= kMaxTreeDepth);
// Three axes take three times as long to fill bins of.
constexpr uint32_t kFew = 32;

struct Split {
    double cost = std::numeric_limits<double>::infinity();
    int axis = 0;
    size_t bin = 0;  // the first on the right
};

struct Bin {
    Bounds box;
    uint32_t count = 0;

    void include(const Bin& other) {
        box.include(other.box);
        count += other.count;
    }
    double cost() const { return count * box.halfArea(); }
};

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
        const uint32_t count = end - first;
        // A leaf of instances holds one.
        const uint32_t most = !oneKind                                                ? 0
                              : items_[first].kind == shared::PrimitiveKind::Instance ? 1
                                                                                      : kMaxLeaf;
        const Split split = count == 1 ? Split{} : bestSplit(first, end, middles);
        const double area = box.halfArea();
        if (count == 1 || (count <= most && !(split.cost + area < count * area)))
            return {box, writeLeaf(first, end)};
        const auto index = static_cast<uint32_t>(nodes_.size());
        nodes_.emplace_back();
        const uint32_t middle = partition(first, end, depth, split, middles, oneKind);
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

    static dvec3 middleOf(const Item& item) {
        return 0.5 * item.box.lo + 0.5 * item.box.hi;
    }

    static size_t binOf(double middle, double lo, double size) {
        const double bin = (middle - lo) / size * kBins;
        return std::min(static_cast<size_t>(bin), kBins - 1);
    }

    // Costs are areas times the number of tests on either side.
    Split bestSplit(uint32_t first, uint32_t end, const Bounds& middles) const {
        Split best;
        const dvec3 widths = middles.hi - middles.lo;
        const double widest = std::max({widths.x, widths.y, widths.z});
        for (int axis = 0; axis < 3; ++axis) {
            const double lo = middles.lo[axis], size = widths[axis];
            if (!(size > 0) || (end - first > kFew && size < widest)) continue;
            std::array<Bin, kBins> bins;
            for (uint32_t i = first; i < end; ++i)
                bins[binOf(middleOf(items_[i])[axis], lo, size)].include({items_[i].box, 1});
            std::array<double, kBins> right{};
            Bin sum;
            for (size_t bin = kBins - 1; bin > 0; --bin) {
                sum.include(bins[bin]);
                right[bin] = sum.cost();
            }
            sum = Bin();
            for (size_t bin = 1; bin < kBins; ++bin) {
                sum.include(bins[bin - 1]);
                const double cost = sum.cost() + right[bin];
                if (sum.count > 0 && sum.count < end - first && cost < best.cost) best = {cost, axis, bin};
            }
        }
        return best;
    }

    uint32_t partition(uint32_t first, uint32_t end, uint32_t depth, const Split& split,
                       const Bounds& middles, bool oneKind) {
        const auto begin = items_.begin();
        const bool found = split.bin > 0;
        if (found && depth < kDeep) {
            const double lo = middles.lo[split.axis], size = middles.hi[split.axis] - lo;
            const auto middle = std::partition(begin + first, begin + end, [&](const Item& item) {
                return binOf(middleOf(item)[split.axis], lo, size) < split.bin;
            });
            return static_cast<uint32_t>(middle - begin);
        }
        // All in one place, or too deep: by kind, then in halves.
        if (!oneKind)
            std::stable_sort(begin + first, begin + end,
                             [](const Item& a, const Item& b) { return a.kind < b.kind; });
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
