// What the lanes of a subgroup of 8 know of each other. On lavapipe an exclusive or of lanes is one
// instruction, and a vote or ballot a loop over them.
#ifndef GLINT_LANES_GLSL
#define GLINT_LANES_GLSL

#include "storage.glsl"

uint anyOfLanes(uint bits) {
    bits |= subgroupShuffleXor(bits, 1u);
    bits |= subgroupShuffleXor(bits, 2u);
    return bits | subgroupShuffleXor(bits, 4u);
}

// All lanes run through every loop that a walk's nodes stand in, and leave it together: those that are
// through change nothing. On lavapipe a store to the stack jumps lane by lane on whether the lane is in the
// loop (docs/lab/nodes.md). What a lane reads of another is defined only where both are, so loops around
// these are such loops too. Rays that count what they cross have a walk of their own (crossings_walk.glsl).
#ifdef GLINT_CROSSINGS
const bool kConvergent = false;
#else
const bool kConvergent = CONVERGENT != 0u;
#endif

// Whether a lane that would go on by itself does, or together with others.
bool anyGoesOn(bool own) {
    if (kConvergent) return anyOfLanes(own ? 1u : 0u) != 0u;
    return own;
}

// A batch's nearest hits in nodes of four go from the nodes to the leaves when a single lane is left at
// nodes: what the others wait for it costs more than entering the loops once more. Any hits and pictures are
// no faster so (docs/lab/nodes.md). In each trip around both every ray that goes on still counts one of its
// own, as the budget wants it (src/render/path_limits.cpp).
bool leavesOneAtNodes() {
#if defined(GLINT_ANY_HIT) || defined(GLINT_BOTH_HITS) || defined(GLINT_CERTIFY)
    return false;
#else
    return kConvergent && MODE_GIVEN && NODE_FORMAT == kNodesFour && !FEATURE_INSTANCES &&
           !FEATURE_ALPHA_MASK;
#endif
}

// Whether lanes go on through nodes. What kConvergent leaves out names no shuffle, which src/gpu/specialize.h
// has to see where a device has none.
bool anyGoesOnThroughNodes(bool atNode, bool atLeaf) {
    if (kConvergent) {
        if (!leavesOneAtNodes()) return anyOfLanes(atNode ? 1u : 0u) != 0u;
        uint lanes = atNode ? 1u : (atLeaf ? 16u : 0u);
        lanes += subgroupShuffleXor(lanes, 1u);
        lanes += subgroupShuffleXor(lanes, 2u);
        lanes += subgroupShuffleXor(lanes, 4u);
        return (lanes & 15u) > (lanes > 15u ? 1u : 0u);
    }
    return atNode;
}

#endif
