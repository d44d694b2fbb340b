#include "bvh/flatten.h"

#include <array>

#include "bvh/stored_box.h"

namespace glint {
namespace {

// A child still to be written, with the slot it belongs in and the slot that follows its subtree.
struct Pending {
    uint32_t bvhNode;
    uint32_t slot;
    uint32_t escape;
};

void setChild(std::vector<shared::Node>& nodes, uint32_t slot, const Box& tight, uint32_t child) {
    const Box box = tight.empty() ? tight : storedBox(RegisterBox::of(tight)).box();
    shared::Node& node = nodes[slot / 2];
    if (slot % 2 == 0) {
        node.lo0 = box.lo;
        node.hi0 = box.hi;
        node.child0 = child;
    } else {
        node.lo1 = box.lo;
        node.hi1 = box.hi;
        node.child1 = child;
    }
}

}  // namespace

std::vector<shared::Node> flattenBvh(const Bvh& bvh, const std::vector<uint8_t>& kinds,
                                     const Context& context) {
    std::vector<shared::Node> nodes;
    if (bvh.nodes.empty()) return nodes;
    nodes.reserve(bvh.nodes.size() / 2 + 1);
    // Leaves are met in the order of Bvh::order, so each kind's array fills up from its start.
    std::array<uint32_t, 256> filled{};
    const auto leafChild = [&](const BvhNode& leaf) {
        const uint32_t kind = kinds.empty() ? shared::kKindTriangle : kinds[bvh.order[leaf.first]];
        const uint32_t first = filled[kind];
        filled[kind] += leaf.count;
        return shared::kLeafFlag | kind << shared::kLeafKindShift |
               (leaf.count - 1) << shared::kLeafCountShift | first;
    };
    const auto addNode = [&](uint32_t escape) {
        nodes.emplace_back().escape = escape;
        return static_cast<uint32_t>(nodes.size() - 1);
    };

    std::vector<Pending> pending;
    const auto addChildren = [&](const BvhNode& parent, uint32_t node) {
        pending.push_back({parent.first + 1, 2 * node + 1, nodes[node].escape});
        pending.push_back({parent.first, 2 * node, 2 * node + 1});
    };
    const BvhNode& root = bvh.nodes[0];
    addNode(shared::kNone);
    if (root.count > 0) {
        setChild(nodes, 0, root.box, leafChild(root));
        setChild(nodes, 1, Box{}, shared::kNone);
        return nodes;
    }
    addChildren(root, 0);
    while (!pending.empty()) {
        context.pace(nodes.size());
        const Pending next = pending.back();
        pending.pop_back();
        const BvhNode& child = bvh.nodes[next.bvhNode];
        if (child.count > 0) {
            setChild(nodes, next.slot, child.box, leafChild(child));
        } else {
            const uint32_t node = addNode(next.escape);
            setChild(nodes, next.slot, child.box, node);
            addChildren(child, node);
        }
    }
    return nodes;
}

}  // namespace glint
