// Traverses the BVH in depth-first order without a stack, from any slot on: each child has the slot that
// follows its subtree. The whole state of a ray is one slot, two with instances, so a ray that runs out of
// trips continues in a further dispatch. Rays that a traversal with a stack could not finish continue here.
#ifndef GLINT_STACKLESS_GLSL
#define GLINT_STACKLESS_GLSL

#include "traversal/state.glsl"

// Each query defines: true if a box may hold what it looks for; the test of a leaf's primitives; and of the
// planes.
bool entersBox(Traversal traversal, vec3 lo, vec3 hi);
void testLeaf(inout Traversal traversal, uint leaf);
void testPlanes(inout Traversal traversal, uint planeCount);

// True if the ray hits the box in its interval.
bool rayEntersBox(Traversal traversal, vec3 lo, vec3 hi) {
    precise float tEnd = traversal.ray.tMax * farPad();
    float near;
    return intersectBox(traversal.ray, traversal.frame, lo, hi, tEnd, near);
}

// One child of a node with its box; the slot of a child is 2 * node + side.
struct Slot {
    vec3 lo, hi;
    uint child;
    uint next;  // the slot that follows the child's subtree
};
Slot loadSlot(uint slot) {
    uvec4 lo = nodesArrayRow(2u * slot);
    uvec4 hi = nodesArrayRow(2u * slot + 1u);
    return Slot(uintBitsToFloat(lo.xyz), uintBitsToFloat(hi.xyz), lo.w, (slot & 1u) == 0u ? slot + 1u : hi.w);
}

// Tests the box of a slot. Returns the leaf in it if the ray enters that, else kNone; `slot` becomes the
// next.
uint stepToLeaf(Traversal traversal, inout uint slot) {
    Slot at = loadSlot(slot);
    bool entered = entersBox(traversal, at.lo, at.hi);
    slot = entered && isNode(at.child) ? at.child << 1 : at.next;
    return entered && !isNode(at.child) ? at.child : kNone;
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
            bool enters = leaf != kNone && isInstance(leaf);
            if (leaf != kNone && !enters) testLeaf(traversal, leaf);
            if (settled(traversal)) slot = kNone;
            if (FEATURE_INSTANCES) {
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
