// Traverses the BVH in depth-first order without a stack, from any slot (2 * node + side) on: each node has
// the slot that follows once both of its children are done (Node::escape). The whole state of a ray is one
// slot, two with instances, so a ray that runs out of trips continues in a further dispatch. Rays that the
// stack traversal could not finish continue here, and rays that count crossings, which no order helps.
#ifndef GLINT_STACKLESS_GLSL
#define GLINT_STACKLESS_GLSL

#include "traversal/state.glsl"

// Each query defines: true if a box may hold what it looks for; the test of a leaf's primitives; and of the
// planes.
bool entersBox(Traversal traversal, vec3 lo, vec3 hi);
void testLeaf(inout Traversal traversal, uint leaf);
void testPlanes(inout Traversal traversal, uint planeCount);

// Tests the box of a slot. Returns the leaf in it if the ray enters that, else kNone; `slot` becomes the
// next.
uint stepToLeaf(Traversal traversal, inout uint slot) {
    Node node = loadNode(slot >> 1);
    bool second = (slot & 1u) != 0u;
    uint child = second ? node.child1 : node.child0;
    bool entered = entersBox(traversal, second ? node.lo1 : node.lo0, second ? node.hi1 : node.hi0);
    slot = second ? node.escape : slot + 1u;
    if (entered && isNode(child)) slot = child << 1;
    return entered && !isNode(child) ? child : kNone;
}

// Returns the slot to continue from, kNone at the end.
uint traverseFrom(inout Traversal traversal, uint slot) {
    uint budget = dispatch.tripBudget;
    do {
        if (slot != kNone && traversal.trips < budget) {
            uint leaf = kNone;
            do {
                if (slot != kNone && leaf == kNone && traversal.trips < budget) {
                    leaf = stepToLeaf(traversal, slot);
                    ++traversal.trips;
                    if (MODE_COST) ++traversal.cost;
                }
            } while (slot != kNone && leaf == kNone && traversal.trips < budget);
            if (leaf != kNone && !isInstance(leaf)) testLeaf(traversal, leaf);
            if (settled(traversal)) slot = kNone;
            if (FEATURE_INSTANCES) {
                bool enters = leaf != kNone && isInstance(leaf);
                if (enters) traversal.worldSlot = slot;
                bool leaves = !enters && slot == kNone && traversal.instance != kNone && !settled(traversal);
                uint root = enterSpace(traversal, enters ? leaf & kLeafFirstMask : kNone, enters || leaves);
                slot = enters ? root << 1 : (leaves ? traversal.worldSlot : slot);
            }
        }
    } while (slot != kNone && traversal.trips < budget);
    return slot;
}

// Goes back to the instance that an unfinished ray was in. Its trip is not counted: with a budget of one trip
// the ray would never continue.
void enterAgain(inout Traversal traversal, uvec2 place, bool enters) {
    if (FEATURE_INSTANCES) {
        uint trips = traversal.trips;
        traversal.worldSlot = place.y;
        enterSpace(traversal, place.x, enters && place.x != kNone);
        traversal.trips = trips;
    }
}

// Resumes a ray from `slot`, or begins it there (kSlotFresh). `place`: the instance that an unfinished ray is
// in, and its slot in the world. Returns kNone when finished, else the slot to resume from.
uint resume(inout Traversal traversal, Environment environment, uint slot, uvec2 place) {
    bool sound = prepare(traversal, environment);
    bool begins = slot == kSlotFresh;
    if (FEATURE_PLANES) testPlanes(traversal, sound && begins ? environment.planeCount : 0u);
    bool inTree = sound && !settled(traversal);
    if (begins) slot = environment.root != kNone ? 0u : kNone;
    if (begins) place = uvec2(kNone);
    enterAgain(traversal, place, inTree && slot != kNone);
    return traverseFrom(traversal, inTree ? slot : kNone);
}

#endif
