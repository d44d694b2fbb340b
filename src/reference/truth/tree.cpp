// Halves of equal numbers along the widest axis of the boxes' middles: at most 32 levels.
#include <algorithm>

#include "core/room.h"
#include "reference/truth/part.h"

namespace glint::reference::truth {
namespace {

using glm::dvec3;

constexpr uint32_t kMaxLeaf = 4;

// Builds the tree and writes the primitives of each leaf as it is made.
class Builder {
  public:
    Builder(Part& part, std::vector<rows::Node>& nodes)
        : part_(part), items_(part.items), nodes_(nodes), model_(part.whole) {
        reserveMore(nodes, items_.size() / 2 + 1);
        reserveMore(model_.triangles, part.model.triangles.size());
        reserveMore(model_.triangleSurfaces, part.model.triangles.size());
    }

    uint32_t run() { return grow(0, static_cast<uint32_t>(items_.size())).word; }

  private:
    struct Child {
        Bounds box;
        uint32_t word;  // as in rows::Node
    };

    Child grow(uint32_t first, uint32_t end) {
        Bounds box, middles;
        bool oneKind = true;
        for (uint32_t i = first; i < end; ++i) {
            box.include(items_[i].box);
            middles.include(middleOf(items_[i]));
            oneKind = oneKind && items_[i].kind == items_[first].kind;
        }
        // A leaf of instances holds one.
        const uint32_t most = items_[first].kind == shared::PrimitiveKind::Instance ? 1 : kMaxLeaf;
        if (oneKind && end - first <= most) return {box, writeLeaf(first, end)};
        const dvec3 widths = middles.hi - middles.lo;
        const int axis =
            widths.x >= widths.y ? (widths.x >= widths.z ? 0 : 2) : (widths.y >= widths.z ? 1 : 2);
        const uint32_t middle = first + (end - first) / 2;
        const auto begin = items_.begin();
        std::nth_element(begin + first, begin + middle, begin + end,
                         [&](const Item& a, const Item& b) { return middleOf(a)[axis] < middleOf(b)[axis]; });
        const auto index = static_cast<uint32_t>(nodes_.size());
        nodes_.emplace_back();
        const Child left = grow(first, middle), right = grow(middle, end);
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
