// The closest hit, or any hit, of a ray through the BVH: each lane traverses the binary tree with a stack of
// its own, the nearer child first. Aila, Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG
// 2009: an inner loop over nodes up to the next leaf, an outer loop over leaves. A ray that runs out of trips
// is finished by further dispatches without a stack (traversal/stackless.glsl).
#ifndef GLINT_TRAVERSAL_GLSL
#define GLINT_TRAVERSAL_GLSL

#include "traversal/state.glsl"

// Each query defines: the tests of a leaf's primitives and of the planes; with kCollects, which children a
// ray collects as leaves instead of entering them (true if there is no room for two more), and their test.
void testLeaf(inout Traversal traversal, uint leaf);
void testPlanes(inout Traversal traversal, uint planeCount);
bool collect(Node node, inout bool hit0, inout bool hit1);
void testLeaves(inout Traversal traversal);

// Entries below the topmost, which is in a register, so that the stack's loads and stores need not wait for a
// node. One entry for each level of the tree at most, kNone below those of the world and of an instance, and
// two places that are only read.
uint stack[kMaxBvhDepth + 3u];

// Any-hit rays take the farther child first: the neighbourhood of the surface that they leave seldom shades
// them. Not if dielectrics filter the light, whose sum depends on the order.
bool isFarthestFirst(Traversal traversal) { return isAnyHit(traversal) && !FEATURE_COLORED_SHADOWS; }

uint pop(inout uint top, inout uint topmost) {
    uint next = topmost;
    topmost = stack[top--];
    return next;
}

// From node to node, to the next leaf, an instance or kNone. If the ray enters both children, it pushes one;
// if none, it pops an entry.
uint descend(inout Traversal traversal, uint current, uint budget, inout uint top, inout uint topmost) {
    precise float tEnd = traversal.ray.tMax * farPad();
    bool full = false;
    bool atNode = isNode(current) && traversal.trips < budget;
    do {
        if (takesPart(atNode)) {
            uint below = stack[top];
            Node node = loadNode(atNode ? current : 0u);
            float near0, near1, end = atNode ? tEnd : -1.0;
            bool hit0 = intersectBox(traversal.ray, traversal.frame, node.lo0, node.hi0, end, near0);
            bool hit1 = intersectBox(traversal.ray, traversal.frame, node.lo1, node.hi1, end, near1);
            if (kCollects) full = collect(node, hit0, hit1);
            bool swapped = isFarthestFirst(traversal) ? near0 < near1 : near1 < near0;
            bool both = hit0 && hit1;
            bool none = atNode && !hit0 && !hit1;
            bool takesFirst = hit0 && !(hit1 && swapped);
            uint next = takesFirst ? node.child0 : (hit1 ? node.child1 : topmost);
            if (takesPart(both)) stack[top + 1u] = topmost;
            current = atNode ? next : current;
            topmost = both ? (swapped ? node.child0 : node.child1) : (none ? below : topmost);
            top = both ? top + 1u : (none ? top - 1u : top);
            traversal.trips += atNode ? 1u : 0u;
            if (MODE_COST && atNode) traversal.cost += 2u;
        }
        atNode = isNode(current) && traversal.trips < budget && !full;
    } while (anyHasWork(atNode));
    return current;
}

// A ray at an instance, or at the end of one, waits there until all rays of the subgroup do: else every trip
// would pay for the transform (traversal/lanes.glsl).
bool isInSpace(uint child) { return child != kNone && !isInstance(child); }

// From the root. Returns kNone when finished, else 0: the slot to begin from again, with the hit so far.
uint traverse(inout Traversal traversal, uint root) {
    uint top = 1u;
    uint topmost = kNone;
    uint current = root;
    uint budget = dispatch.tripBudget;  // a local copy: see lanes.glsl
    uint pass = FEATURE_INSTANCES ? dispatch.tripsOfPass : 0u;
    do {
        bool goes = current != kNone && traversal.trips < budget;
        if (takesPart(goes)) {
            bool here;
            do {
                here = goes && isInSpace(current) && traversal.trips < budget;
                if (takesPart(here)) {
                    current = descend(traversal, current, budget, top, topmost);
                    if (kCollects) {
                        testLeaves(traversal);
                    } else if (here && isInSpace(current) && !isNode(current)) {
                        testLeaf(traversal, current);
                        current = pop(top, topmost);
                        if (settled(traversal)) current = kNone;
                    }
                    traversal.trips += here ? pass : 0u;
                }
                here = goes && isInSpace(current) && traversal.trips < budget;
            } while (FEATURE_INSTANCES && anyHasWork(here));
            if (FEATURE_INSTANCES) {
                // The way out of an instance may lead straight into the next.
                bool leaves = goes && current == kNone && traversal.instance != kNone && topmost != kNone &&
                              !settled(traversal);
                if (leaves) current = pop(top, topmost);
                bool enters = goes && current != kNone && isInstance(current);
                uint inner =
                    enterSpace(traversal, enters ? current & kLeafFirstMask : kNone, enters || leaves);
                if (takesPart(enters)) stack[top + 1u] = topmost;
                top += enters ? 1u : 0u;
                topmost = enters ? kNone : topmost;
                current = enters ? inner : current;
            }
            traversal.trips += goes ? pass + 1u : 0u;
        }
    } while (anyHasWork(current != kNone && traversal.trips < budget));
    if (FEATURE_INSTANCES) traversal.instance = kNone;
    return current == kNone ? kNone : 0u;
}

// Traces the ray. Returns kNone when finished, else the slot to resume from.
uint trace(inout Traversal traversal, Environment environment) {
    bool sound = prepare(traversal, environment);
    if (FEATURE_PLANES) testPlanes(traversal, sound ? environment.planeCount : 0u);
    bool inTree = sound && !settled(traversal);
    // The stackless traversal begins at slot 0 and tests all leaves again, but not the planes.
    Passage afterPlanes = traversal.passage;
    uint left = traverse(traversal, inTree ? environment.root : kNone);
    if (isShadowRay(traversal) && left != kNone) traversal.passage = afterPlanes;
    return left;
}

#endif
