// Split by the surface area heuristic over bins of the boxes' middles (I. Wald, "On Fast Construction of SAH
// Based Bounding Volume Hierarchies", 2007): of many items along the widest axis, of few along all three.
#include "reference/truth/tree.h"

#include <array>
#include <numeric>

#include "core/parallel.h"
#include "reference/model.h"

namespace glint::reference::truth {
namespace {

using glm::dvec3;

constexpr size_t kBins = 16;
constexpr uint32_t kMaxLeaf = 8;
// From here on halves of equal numbers: 2^25 items then take 25 more levels.
constexpr uint32_t kDeep = 36;
static_assert(kDeep + 26 <= kMaxTreeDepth);
// Fewer items are one thread's.
constexpr uint32_t kTask = 4096;
// Three axes take three times as long to fill bins of.
constexpr uint32_t kFew = 32;

struct Split {
    double cost = std::numeric_limits<double>::infinity();
    int axis = 0;
    size_t bin = 0;  // the first on the right
};

class Builder {
  public:
    Builder(std::vector<Item>& items, uint32_t soloKind) : items_(items), soloKind_(soloKind) {}

    std::vector<TreeNode> run(const Context& context) {
        std::vector<TreeNode> nodes;
        std::vector<Task> tasks;
        grow(0, static_cast<uint32_t>(items_.size()), 0, nodes, &tasks);
        std::vector<std::vector<TreeNode>> parts(tasks.size());
        parallelFor(context, tasks.size(),
                    [&](size_t i) { grow(tasks[i].first, tasks[i].end, tasks[i].depth, parts[i], nullptr); });
        for (size_t i = 0; i < tasks.size(); ++i) put(parts[i], tasks[i].node, nodes);
        return nodes;
    }

  private:
    struct Task {
        uint32_t node, first, end, depth;
    };

    // The part's root takes the place kept for it, the others come behind all there are.
    static void put(std::vector<TreeNode>& part, uint32_t place, std::vector<TreeNode>& nodes) {
        const auto offset = static_cast<uint32_t>(nodes.size()) - 1;
        for (TreeNode& node : part) {
            if (node.count > 0) continue;
            node.left += offset;
            node.right += offset;
        }
        nodes[place] = part[0];
        nodes.insert(nodes.end(), part.begin() + 1, part.end());
    }

    uint32_t grow(uint32_t first, uint32_t end, uint32_t depth, std::vector<TreeNode>& nodes,
                  std::vector<Task>* tasks) {
        const auto index = static_cast<uint32_t>(nodes.size());
        nodes.emplace_back();
        if (tasks != nullptr && end - first <= kTask) {
            tasks->push_back({index, first, end, depth});
            return index;
        }
        TreeNode node;
        Bounds middles;
        bool oneKind = true;
        for (uint32_t i = first; i < end; ++i) {
            node.box.include(items_[i].box);
            middles.include(middleOf(items_[i]));
            oneKind = oneKind && items_[i].kind == items_[first].kind;
        }
        const uint32_t count = end - first;
        const uint32_t most = !oneKind ? 0 : items_[first].kind == soloKind_ ? 1 : kMaxLeaf;
        const Split split = count == 1 ? Split{} : bestSplit(first, end, middles);
        const double area = node.box.halfArea();
        if (count == 1 || (count <= most && !(split.cost + area < count * area))) {
            node.first = first;
            node.count = count;
        } else {
            const uint32_t middle = partition(first, end, depth, split, middles, oneKind);
            node.left = grow(first, middle, depth + 1, nodes, tasks);
            node.right = grow(middle, end, depth + 1, nodes, tasks);
        }
        nodes[index] = node;
        return index;
    }

    static dvec3 middleOf(const Item& item) { return 0.5 * item.box.lo + 0.5 * item.box.hi; }

    static size_t binOf(double middle, double lo, double size) {
        const double bin = (middle - lo) / size * kBins;
        return std::min(static_cast<size_t>(bin), kBins - 1);
    }

    // Costs are in areas: of what is tested on either side.
    Split bestSplit(uint32_t first, uint32_t end, const Bounds& middles) const {
        Split best;
        const dvec3 widths = middles.hi - middles.lo;
        const double widest = std::max({widths.x, widths.y, widths.z});
        for (int axis = 0; axis < 3; ++axis) {
            const double lo = middles.lo[axis], size = widths[axis];
            if (!(size > 0) || (end - first > kFew && size < widest)) continue;
            std::array<Bounds, kBins> boxes;
            std::array<uint32_t, kBins> counts{};
            for (uint32_t i = first; i < end; ++i) {
                const size_t bin = binOf(middleOf(items_[i])[axis], lo, size);
                boxes[bin].include(items_[i].box);
                ++counts[bin];
            }
            std::array<double, kBins> right{};
            Bounds box;
            uint32_t count = 0;
            for (size_t bin = kBins - 1; bin > 0; --bin) {
                box.include(boxes[bin]);
                count += counts[bin];
                right[bin] = count * box.halfArea();
            }
            box = Bounds();
            count = 0;
            for (size_t bin = 1; bin < kBins; ++bin) {
                box.include(boxes[bin - 1]);
                count += counts[bin - 1];
                const double cost = count * box.halfArea() + right[bin];
                if (count > 0 && count < end - first && cost < best.cost) best = {cost, axis, bin};
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

    std::vector<Item>& items_;
    uint32_t soloKind_;
};

}  // namespace

std::vector<TreeNode> buildTree(std::vector<Item>& items, uint32_t soloKind, const Context& context) {
    if (items.empty()) return {};
    return Builder(items, soloKind).run(context);
}

}  // namespace glint::reference::truth
