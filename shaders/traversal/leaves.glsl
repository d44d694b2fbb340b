// Leaves that a ray has entered and not tested, at most kMostLeaves: the last first, then kNone.
#ifndef GLINT_LEAVES_GLSL
#define GLINT_LEAVES_GLSL

struct Leaves {
    uint list[kMostLeaves];
};

Leaves noLeaves() {
    Leaves leaves;
    for (uint i = 0u; i < kMostLeaves; ++i) leaves.list[i] = kNone;
    return leaves;
}

// A leaf of polygons may take so many trips that the budget has room for one (src/render/path_limits.cpp).
bool isFull(Leaves leaves) { return leaves.list[FEATURE_POLYGONS ? 0u : kMostLeaves - 1u] != kNone; }

void addLeaf(inout Leaves leaves, uint leaf) {
    for (uint i = 0u; i < kMostLeaves; ++i) {
        uint next = leaves.list[i];
        leaves.list[i] = leaf;
        leaf = next;
    }
}

// Takes the first primitive out of the first leaf.
void dropPrimitive(inout Leaves leaves) {
    if (sizeOfLeaf(leaves.list[0]) > 1u) {
        leaves.list[0] += 1u - (1u << kLeafCountShift);
    } else {
        for (uint i = 1u; i < kMostLeaves; ++i) leaves.list[i - 1u] = leaves.list[i];
        leaves.list[kMostLeaves - 1u] = kNone;
    }
}

#endif
