#include "bvh/packet_tree.h"

#include <algorithm>

#include "bvh/collapse.h"
#include "core/parallel.h"

namespace glint {
namespace {

constexpr uint32_t kWidth = shared::kPacketWidth;

}  // namespace

std::vector<shared::PacketCorner> packetTree(const std::vector<shared::Node>& nodes,
                                             std::vector<uint32_t>* slots) {
    std::vector<shared::PacketCorner> corners;
    if (slots != nullptr) slots->clear();
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
        if (slots == nullptr) continue;
        slots->resize(static_cast<size_t>(places) * kWidth);
        for (uint32_t i = 0; i < kWidth; ++i)
            (*slots)[size_t{next.place} * kWidth + i] = wide.children[i].slot;
    }
    return corners;
}

void refitPacketTree(const std::vector<shared::Node>& nodes, const std::vector<uint32_t>& slots,
                     std::vector<shared::PacketCorner>& corners) {
    constexpr size_t kChunk = 16384;
    const auto refit = [&](size_t chunk) {
        const size_t end = std::min(slots.size(), (chunk + 1) * kChunk);
        for (size_t i = chunk * kChunk; i < end; ++i) {
            if (slots[i] == shared::kNone) continue;
            const shared::Node& node = nodes[slots[i] / 2];
            shared::PacketCorner* const corner = &corners[i / kWidth * 2 * kWidth + i % kWidth];
            corner[0].corner = slots[i] % 2 == 0 ? node.lo0 : node.lo1;
            corner[kWidth].corner = slots[i] % 2 == 0 ? node.hi0 : node.hi1;
        }
    };
    parallelFor((slots.size() + kChunk - 1) / kChunk, refit);
}

}  // namespace glint
