// Traversal of the reference's BVHs, with double boxes (rows::Node) or packed boxes (shared::Node).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/device_layout.h"
#include "reference/model.h"

namespace glint::reference {

// Primitives of one kind, from `first` to before `end` in its array.
struct Leaf {
    shared::PrimitiveKind kind;
    uint32_t first, end;
};
inline Leaf leafOf(uint32_t child) {
    const uint32_t first = child & shared::kLeafFirstMask;
    return {static_cast<shared::PrimitiveKind>(child >> shared::kLeafKindShift & shared::kLeafKindMask),
            first, first + (child >> shared::kLeafCountShift & shared::kLeafCountMask) + 1};
}

// The corners of the box of a node's child, 0 or 1.
template <class Node>
const auto& loOf(const Node& node, int child) {
    return child == 0 ? node.lo0 : node.lo1;
}
template <class Node>
const auto& hiOf(const Node& node, int child) {
    return child == 0 ? node.hi0 : node.hi1;
}

// A box that is not entered.
inline constexpr double kNotEntered = std::numeric_limits<double>::infinity();

// Visits the leaves below `root` depth first, the nearer child first, until a visit returns true; returns
// true then. `enter(node, child)`: the t at which a child's box begins, or kNotEntered. Children that begin
// beyond `limit()`, which is finite and may decrease, are culled. `visit(leaf, begin)`.
template <class Nodes, class Enter, class Limit, class Visit>
bool traverse(const Nodes& nodes, uint32_t root, const Enter& enter, const Limit& limit, const Visit& visit) {
    struct Waiting {
        double begin;
        uint32_t child;
    };
    std::array<Waiting, kMaxTreeDepth + 1> stack;
    size_t size = 0;
    Waiting at{0, root};
    for (;;) {
        if (at.child & shared::kLeafFlag) {
            if (visit(leafOf(at.child), at.begin)) return true;
        } else {
            const auto& node = nodes[at.child];
            Waiting near{node.child0 != shared::kNone ? enter(node, 0) : kNotEntered, node.child0};
            Waiting far{node.child1 != shared::kNone ? enter(node, 1) : kNotEntered, node.child1};
            if (far.begin < near.begin) std::swap(near, far);
            if (far.begin <= limit()) stack[size++] = far;
            if (near.begin <= limit()) {
                at = near;
                continue;
            }
        }
        do {
            if (size == 0) return false;
            at = stack[--size];
        } while (at.begin > limit());
    }
}

}  // namespace glint::reference
