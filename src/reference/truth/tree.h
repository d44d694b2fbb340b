// A tree of boxes in double; internal to truth.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "core/context.h"

namespace glint::reference::truth {

struct Bounds {
    glm::dvec3 lo{std::numeric_limits<double>::infinity()};
    glm::dvec3 hi{-std::numeric_limits<double>::infinity()};

    void include(const glm::dvec3& p) {
        lo = glm::min(lo, p);
        hi = glm::max(hi, p);
    }
    void include(const Bounds& other) {
        lo = glm::min(lo, other.lo);
        hi = glm::max(hi, other.hi);
    }
    bool empty() const { return lo.x > hi.x; }
    double halfArea() const {
        const glm::dvec3 size = hi - lo;
        return empty() ? 0 : size.x * size.y + size.y * size.z + size.z * size.x;
    }
    // The greatest coordinate of a point in it.
    double reach() const {
        const glm::dvec3 far = glm::max(glm::abs(lo), glm::abs(hi));
        return std::max({far.x, far.y, far.z});
    }
    void grow(double margin) {
        lo -= margin;
        hi += margin;
    }
    // Corner i of 8.
    glm::dvec3 corner(int i) const { return {i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z}; }
};

// Entry of a BVH: number `index` of its kind.
struct Item {
    Bounds box;
    uint32_t kind = 0, index = 0;
};

// A leaf if count > 0: the items from `first` on, all of one kind. Else both children are nodes.
struct TreeNode {
    Bounds box;
    uint32_t left = 0, right = 0;
    uint32_t first = 0, count = 0;
};

// Brings the items into the order of leaves; node 0 is the root. Of nothing no nodes. At most kMaxTreeDepth
// deep; leaves of soloKind hold one item.
std::vector<TreeNode> buildTree(std::vector<Item>& items, uint32_t soloKind, const Context& context);

}  // namespace glint::reference::truth
