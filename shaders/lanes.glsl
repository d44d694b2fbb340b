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

#endif
