#include "bvh/packet_tree.h"

#include <algorithm>

#include "bvh/collapse.h"

namespace glint {
namespace {

constexpr uint32_t kWidth = shared::kPacketWidth;

}  // namespace

std::vector<shared::PacketCorner> packetTree(const std::vector<shared::Node>& nodes) {
    std::vector<shared::PacketCorner> corners;
    if (nodes.empty()) return corners;
    // A node of the binary tree that becomes the wide node `place`; depth first, so that a subtree lies
    // together.
    struct Pending {
        uint32_t node, place;
    };
    const Collapse<kWidth> collapse(nodes);
    std::vector<Pending> pending = {{0, 0}};
    uint32_t places = 1;
    while (!pending.empty()) {
        const Pending next = pending.back();
        pending.pop_back();
        Collapse<kWidth>::Wide wide = collapse.childrenOf(next.node);
        std::stable_partition(wide.children.begin(), wide.children.begin() + wide.count,
                              [](const Collapse<kWidth>::Child& c) { return isInnerChild(c.child); });
        for (uint32_t i = 0; i < wide.count; ++i) {
            if (!isInnerChild(wide.children[i].child)) continue;
            pending.push_back({wide.children[i].child, places});
            wide.children[i].child = places++;
        }
        corners.resize(static_cast<size_t>(places) * 2 * kWidth);
        shared::PacketCorner* const node = &corners[static_cast<size_t>(next.place) * 2 * kWidth];
        for (uint32_t i = 0; i < kWidth; ++i) {
            node[i] = {wide.children[i].box.lo, wide.children[i].child};
            node[kWidth + i] = {wide.children[i].box.hi, 0};
        }
    }
    return corners;
}

}  // namespace glint
