#include "bvh/packet_tree.h"

#include <algorithm>

#include "bvh/collapse.h"
#include "core/parallel.h"

namespace glint {
namespace {

constexpr uint32_t kWidth = shared::kPacketWidth;

using Wide = Collapse<kWidth>::Wide;

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
Wide wideNode(const Collapse<kWidth>& collapse, uint32_t node) {
    Wide wide = collapse.childrenOf(node);
    std::stable_partition(wide.children.begin(), wide.children.begin() + wide.count,
                          [](const Collapse<kWidth>::Child& c) { return isInnerChild(c.child); });
    return wide;
}

// A node of the wide tree: the one of the binary tree that became it, and the place of its first inner child.
struct Place {
    uint32_t node, firstChild;
};

// Depth first, so that a subtree lies together.
std::vector<Place> placesOf(const Collapse<kWidth>& collapse) {
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
    const Collapse<kWidth> collapse(nodes);
    // Numbered first and written then: the arrays are made once, of the right size, and written side by side.
    const std::vector<Place> places = placesOf(collapse);
    std::vector<shared::PacketCorner> corners(places.size() * 2 * kWidth);
    if (slots != nullptr) slots->resize(places.size() * kWidth);
    forEach(context, places.size(), [&](size_t place) {
        const Wide wide = wideNode(collapse, places[place].node);
        shared::PacketCorner* const node = &corners[place * 2 * kWidth];
        for (uint32_t i = 0; i < kWidth; ++i) {
            const Collapse<kWidth>::Child& child = wide.children[i];
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
