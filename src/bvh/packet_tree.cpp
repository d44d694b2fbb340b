#include "bvh/packet_tree.h"

#include <array>

#include "bvh/builder.h"

namespace glint {
namespace {

constexpr uint32_t kWidth = shared::kPacketWidth;

struct Child {
    Box box;
    uint32_t child = shared::kNone;
    bool inner() const { return (child & shared::kLeafFlag) == 0; }
};

struct WideNode {
    std::array<Child, kWidth> children;
    uint32_t count = 0;

    void add(const Child& child) {
        if (child.child != shared::kNone) children[count++] = child;
    }
    // The inner child with the largest box; count if all are leaves.
    uint32_t largestInner() const {
        uint32_t best = count;
        for (uint32_t i = 0; i < count; ++i) {
            if (!children[i].inner()) continue;
            if (best == count || children[i].box.halfArea() > children[best].box.halfArea()) best = i;
        }
        return best;
    }
};

Child firstOf(const shared::Node& node) {
    return {{node.lo0, node.hi0}, node.child0};
}
Child secondOf(const shared::Node& node) {
    return {{node.lo1, node.hi1}, node.child1};
}

WideNode gather(const std::vector<shared::Node>& nodes, uint32_t root) {
    WideNode wide;
    wide.add(firstOf(nodes[root]));
    wide.add(secondOf(nodes[root]));
    while (wide.count < kWidth) {
        const uint32_t opened = wide.largestInner();
        if (opened == wide.count) break;
        const shared::Node& node = nodes[wide.children[opened].child];
        wide.children[opened] = firstOf(node);
        wide.add(secondOf(node));
    }
    return wide;
}

}  // namespace

std::vector<shared::PacketCorner> packetTree(const std::vector<shared::Node>& nodes) {
    std::vector<shared::PacketCorner> corners;
    if (nodes.empty()) return corners;
    // A node of the binary tree that becomes the wide node `place`; depth first, so that a subtree lies
    // together.
    struct Pending {
        uint32_t node, place;
    };
    std::vector<Pending> pending = {{0, 0}};
    uint32_t places = 1;
    while (!pending.empty()) {
        const Pending next = pending.back();
        pending.pop_back();
        WideNode wide = gather(nodes, next.node);
        for (uint32_t i = 0; i < wide.count; ++i) {
            if (!wide.children[i].inner()) continue;
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
