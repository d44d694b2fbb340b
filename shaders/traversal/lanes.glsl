// llvmpipe (Mesa's lavapipe) in one place: what it compiles differently from a GPU, and what shaders do about
// it. The figures are in docs/lab/nodes.md; the driver is Mesa 22.3.6.
//
// - An `if` never jumps: both sides run with a mask. Only a loop jumps, back, while a lane goes on. So every
//   loop runs its body at least once; `do { if (mine) {...} } while (mine)` once less than a `while` loop.
// - After 65,535 trips of a subgroup through all of its loops together, every loop ends silently. So each ray
//   counts its trips and gives up at dispatch.tripBudget (src/render/path_limits.cpp).
// - A store to a private array jumps lane by lane on whether the lane is in the loop, and mispredicts once
//   for each lane that leaves. With kConvergent all lanes leave all loops of a traversal together; a finished
//   lane changes nothing. A shuffle needs both lanes active, so all loops around are convergent.
// - subgroupShuffleXor is one instruction; votes, ballots and broadcasts are loops over the lanes.
// - A store to a buffer takes 14 instructions for each word and lane: rows that do not change are not stored.
//   A push constant costs 25 instructions at each use: loops use a local copy. Loads ignore conditions.
#ifndef GLINT_LANES_GLSL
#define GLINT_LANES_GLSL

#include "storage.glsl"

const bool kConvergent = CONVERGENT;

uint anyOfLanes(uint bits) {
    bits |= subgroupShuffleXor(bits, 1u);
    bits |= subgroupShuffleXor(bits, 2u);
    return bits | subgroupShuffleXor(bits, 4u);
}

// True if the lane runs through the body of a loop: it has work, or other lanes may have.
bool takesPart(bool hasWork) { return kConvergent || hasWork; }

// The condition of such a loop.
bool anyHasWork(bool hasWork) {
    if (kConvergent) return anyOfLanes(hasWork ? 1u : 0u) != 0u;
    return hasWork;
}

#endif
