#include "bvh/packet_tree.h"

#include <algorithm>
#include <array>
#include <limits>

#include "bvh/flatten.h"
#include "core/parallel.h"

namespace glint {
namespace {

constexpr uint32_t kWidth = shared::kPacketWidth;

// Which nodes of the binary tree stay, as nodes of the wide one, so that the expected number of those that a
// ray visits, the sum of their areas, is least: leaves and their boxes are the same in any case. Dynamic
// programming as of H. Ylitie, T. Karras, S. Laine, "Efficient Incoherent Ray Traversal on GPUs Through
// Compressed Wide BVHs", HPG 2017, sec. 3.1.
class Collapse {
  public:
    explicit Collapse(const std::vector<shared::Node>& nodes) : nodes_(nodes), plans_(nodes.size()) {
        const double area = nodes.empty() ? 0 : boxOf(nodes[0]).halfArea();
        scale_ = area > 0 ? 1 / area : 0;
        // Children stand behind their parents.
        for (size_t i = nodes.size(); i-- > 0;) plan(i);
    }

    struct Child {
        Box box;
        uint32_t child = shared::kNone;
        uint32_t slot = shared::kNone;  // of the binary tree that has it: 2 * node + side
    };
    struct Wide {
        std::array<Child, kWidth> children;
        uint32_t count = 0;
    };
    Wide childrenOf(uint32_t node) const {
        Wide wide;
        open(node, kWidth, wide);
        return wide;
    }

  private:
    // Cost and choice of a subtree in j + 1 = 1..kWidth places of its wide parent.
    struct Plan {
        std::array<float, kWidth> cost;     // with at most so many places
        std::array<uint8_t, kWidth> first;  // the places of the first child, if opened
        std::array<bool, kWidth> opened{};  // false: it stays, in one place
    };

    static Box boxOf(const shared::Node& node) {
        Box box{node.lo0, node.hi0};
        if (node.child1 != shared::kNone) box.include(Box{node.lo1, node.hi1});
        return box;
    }
    float costOf(uint32_t child, uint32_t places) const {
        return child != shared::kNone && isInnerChild(child) ? plans_[child].cost[places - 1] : 0;
    }

    void plan(size_t index) {
        const shared::Node& node = nodes_[index];
        Plan& plan = plans_[index];
        plan.first.fill(1);
        std::array<float, kWidth> asForest{};
        for (uint32_t places = 2; places <= kWidth; ++places) {
            float best = std::numeric_limits<float>::infinity();
            for (uint32_t first = 1; first < places; ++first) {
                const float cost = costOf(node.child0, first) + costOf(node.child1, places - first);
                if (cost < best) {
                    best = cost;
                    plan.first[places - 1] = static_cast<uint8_t>(first);
                }
            }
            asForest[places - 1] = best;
        }
        const float whole = static_cast<float>(scale_ * boxOf(node).halfArea()) + asForest[kWidth - 1];
        plan.cost[0] = whole;
        for (uint32_t places = 2; places <= kWidth; ++places) {
            plan.opened[places - 1] = asForest[places - 1] < whole;
            plan.cost[places - 1] = std::min(whole, asForest[places - 1]);
        }
    }

    void open(uint32_t node, uint32_t places, Wide& wide) const {
        const uint32_t first = plans_[node].first[places - 1];
        add(nodes_[node].child0, 2 * node, {nodes_[node].lo0, nodes_[node].hi0}, first, wide);
        add(nodes_[node].child1, 2 * node + 1, {nodes_[node].lo1, nodes_[node].hi1}, places - first, wide);
    }
    void add(uint32_t child, uint32_t slot, const Box& box, uint32_t places, Wide& wide) const {
        if (child == shared::kNone) return;
        if (isInnerChild(child) && plans_[child].opened[places - 1])
            open(child, places, wide);
        else
            wide.children[wide.count++] = {box, child, slot};
    }

    const std::vector<shared::Node>& nodes_;
    std::vector<Plan> plans_;
    double scale_ = 0;  // areas in parts of the root's: coordinates go up to 1e38
};

using Wide = Collapse::Wide;

// Calls body(i) for each i < count, by several threads in runs of many.
template <typename Body>
void forEach(const Context& context, size_t count, const Body& body) {
    constexpr size_t kRun = 16384;
    parallelFor(context, (count + kRun - 1) / kRun, [&](size_t part) {
        const size_t end = std::min(count, (part + 1) * kRun);
        for (size_t i = part * kRun; i < end; ++i) body(i);
    });
}

// Inner children first, so that those of a node are numbered in a row.
Wide wideNode(const Collapse& collapse, uint32_t node) {
    Wide wide = collapse.childrenOf(node);
    std::stable_partition(wide.children.begin(), wide.children.begin() + wide.count,
                          [](const Collapse::Child& c) { return isInnerChild(c.child); });
    return wide;
}

// A node of the wide tree: the one of the binary tree that became it, and the place of its first inner child.
struct Place {
    uint32_t node, firstChild;
};

// Depth first, so that a subtree lies together.
std::vector<Place> placesOf(const Collapse& collapse) {
    std::vector<Place> places = {{0, 0}};
    std::vector<uint32_t> pending = {0};
    while (!pending.empty()) {
        const uint32_t place = pending.back();
        pending.pop_back();
        places[place].firstChild = static_cast<uint32_t>(places.size());
        const Wide wide = wideNode(collapse, places[place].node);
        for (uint32_t i = 0; i < wide.count && isInnerChild(wide.children[i].child); ++i) {
            pending.push_back(static_cast<uint32_t>(places.size()));
            places.push_back({wide.children[i].child, 0});
        }
    }
    return places;
}

}  // namespace

std::vector<shared::PacketCorner> packetTree(const std::vector<shared::Node>& nodes,
                                             std::vector<uint32_t>* slots, const Context& context) {
    if (slots != nullptr) slots->clear();
    if (nodes.empty()) return {};
    const Collapse collapse(nodes);
    // Numbered first and written then: the arrays are made once, of the right size, and written side by side.
    const std::vector<Place> places = placesOf(collapse);
    std::vector<shared::PacketCorner> corners(places.size() * 2 * kWidth);
    if (slots != nullptr) slots->resize(places.size() * kWidth);
    forEach(context, places.size(), [&](size_t place) {
        const Wide wide = wideNode(collapse, places[place].node);
        shared::PacketCorner* const node = &corners[place * 2 * kWidth];
        for (uint32_t i = 0; i < kWidth; ++i) {
            const Collapse::Child& child = wide.children[i];
            const bool inner = i < wide.count && isInnerChild(child.child);
            node[i] = {child.box.lo, inner ? places[place].firstChild + i : child.child};
            node[kWidth + i] = {child.box.hi, 0};
            if (slots != nullptr) (*slots)[place * kWidth + i] = child.slot;
        }
    });
    return corners;
}

void refitPacketTree(const std::vector<shared::Node>& nodes, const std::vector<uint32_t>& slots,
                     std::vector<shared::PacketCorner>& corners, const Context& context) {
    forEach(context, slots.size(), [&](size_t i) {
        if (slots[i] == shared::kNone) return;
        const shared::Node& node = nodes[slots[i] / 2];
        shared::PacketCorner* const corner = &corners[i / kWidth * 2 * kWidth + i % kWidth];
        corner[0].corner = slots[i] % 2 == 0 ? node.lo0 : node.lo1;
        corner[kWidth].corner = slots[i] % 2 == 0 ? node.hi0 : node.hi1;
    });
}

}  // namespace glint
