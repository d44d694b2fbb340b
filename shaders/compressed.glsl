// A walk through compressed nodes of eight children, after H. Ylitie, T. Karras, S. Laine, "Efficient
// Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017, alg. 1; leaves are those of the
// binary tree.
#ifndef GLINT_COMPRESSED_GLSL
#define GLINT_COMPRESSED_GLSL

#include "wide_nodes.glsl"

void pushGroup(inout uint top, ChildGroup group, bool pushed) {
    if (pushed) {
        stackPut(top, group.first);
        stackPut(top + 1u, group.bits);
    }
    top += pushed ? 2u : 0u;
}

void popGroup(inout uint top, bool popped, inout ChildGroup nodes, inout ChildGroup leaves) {
    uint place = popped ? top - 2u : 0u;
    ChildGroup group = ChildGroup(stackAt(place), stackAt(place + 1u));
    bool holdsLeaves = (group.bits & kLeafFlag) != 0u;
    top = popped ? place : top;
    if (popped && holdsLeaves) leaves = group;
    if (popped && !holdsLeaves) nodes = group;
}

// The order of a node's slots: see isFarthestFirst.
uint orderOf(Traversal traversal) {
    return octantOf(traversal.frame) ^ (isFarthestFirst(traversal) ? 7u : 0u);
}

// As traverse(), which has the same loops around the same ones, for the bound on their trips. One leaf in
// each trip of the outer one.
uint traverseCompressed(inout Traversal traversal, uint root) {
    // What is left free after a look at it holds what is pushed before the next: of a node one group; on the
    // way into an instance two more.
    const uint kRoom = FEATURE_INSTANCES ? 6u : 2u;
    uint top = 0u;
    uint base = 0u;
    uint octant = orderOf(traversal);
    ChildGroup nodes = ChildGroup(root, root == kNone ? 0u : 1u);
    ChildGroup leaves = ChildGroup(0u, 0u);
    bool goesOn = root != kNone;
    uint budget = dispatch.tripBudget;  // lavapipe reads it lane by lane, each time
    do {
        if (goesOn && traversal.trips < budget) {
            do {
                if (isEmpty(leaves) && !isEmpty(nodes) && traversal.trips < budget) {
                    uint node = takeFirst(nodes, octant);
                    pushGroup(top, nodes, !isEmpty(nodes));
                    precise float tEnd = traversal.ray.tMax * farPad();
                    enterEight(traversal.ray, traversal.frame, node, tEnd, octant, nodes, leaves);
                    popGroup(top, isEmpty(nodes) && isEmpty(leaves) && top > base, nodes, leaves);
                    ++traversal.trips;
                    if (top + kRoom > stackWords()) traversal.trips = budget;
                    if (MODE_COST) traversal.cost += 8u;
                }
            } while (isEmpty(leaves) && !isEmpty(nodes) && traversal.trips < budget);
            bool hasLeaf = !isEmpty(leaves);
            uint leaf = kNone;
            if (hasLeaf) leaf = loadLeaf(takeFirst(leaves, octant));
            if (hasLeaf && !isInstance(leaf)) testLeaf(traversal, leaf);
            if (FEATURE_INSTANCES) {
                bool enters = hasLeaf && isInstance(leaf);
                pushGroup(top, nodes, enters && !isEmpty(nodes));
                pushGroup(top, ChildGroup(leaves.first, leaves.bits | kLeafFlag), enters && !isEmpty(leaves));
                bool done = !enters && isEmpty(nodes) && isEmpty(leaves) && top == base;
                bool leavesSpace = done && traversal.instance != kNone && top > 0u && !settled(traversal);
                uint inner =
                    enterSpace(traversal, enters ? leaf & kLeafFirstMask : kNone, enters || leavesSpace);
                octant = orderOf(traversal);
                if (enters) {
                    nodes = ChildGroup(inner, 1u);
                    leaves = ChildGroup(0u, 0u);
                }
                base = enters ? top : (leavesSpace ? 0u : base);
            }
            popGroup(top, isEmpty(nodes) && isEmpty(leaves) && top > base, nodes, leaves);
            goesOn = !settled(traversal) && !(isEmpty(nodes) && isEmpty(leaves));
            ++traversal.trips;
        }
    } while (goesOn && traversal.trips < budget);
    if (FEATURE_INSTANCES) traversal.instance = kNone;
    return goesOn ? 0u : kNone;
}

#endif
