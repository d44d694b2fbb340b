// The closest hit, or any hit, of a ray through the BVH: each lane traverses the binary tree with a stack of
// its own, the nearer child first. Aila, Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG
// 2009: an inner loop over nodes up to the next leaf, an outer loop over leaves. A ray that runs out of trips
// is finished by further dispatches without a stack (traversal/stackless.glsl).
#ifndef GLINT_TRAVERSAL_GLSL
#define GLINT_TRAVERSAL_GLSL

#include "traversal/leaf.glsl"

// One entry for each level of the tree at most, and a free place above it.
uint stack[kMaxBvhDepth + 1u];

// Any-hit rays take the farther child first: the neighbourhood of the surface that they leave seldom shades
// them. Not if dielectrics filter the light, whose sum depends on the order.
bool isFarthestFirst(Traversal traversal) { return isAnyHit(traversal) && !FEATURE_COLORED_SHADOWS; }

// Returns the first of the node's children that the ray enters, or kNone, and pushes the other. `none` saves
// a comparison with kNone, 6 % of the time of scenes/instances.json.
uint enterNode(Traversal traversal, uint index, float tEnd, inout uint top, out bool none) {
    Node node = loadNode(index);
    float near0, near1;
    bool hit0 = intersectBox(traversal.ray, traversal.frame, node.lo0, node.hi0, tEnd, near0);
    bool hit1 = intersectBox(traversal.ray, traversal.frame, node.lo1, node.hi1, tEnd, near1);
    bool swapped = isFarthestFirst(traversal) ? near0 < near1 : near1 < near0;
    uint first = swapped ? node.child1 : node.child0;
    uint second = swapped ? node.child0 : node.child1;
    bool both = hit0 && hit1;
    if (takesPart(both)) stack[top] = second;
    top += both ? 1u : 0u;
    none = !hit0 && !hit1;
    return both ? first : (hit0 ? node.child0 : (hit1 ? node.child1 : kNone));
}

// The topmost entry above `base`; kNone if the stack is empty or the ray is done.
uint pop(bool done, inout uint top, uint base) {
    bool ends = done || top == base;
    uint next = stack[top == 0u ? 0u : top - 1u];
    top -= ends ? 0u : 1u;
    return ends ? kNone : next;
}

// From node to node, to the next leaf, an instance or kNone.
uint descend(inout Traversal traversal, uint current, uint base, uint budget, inout uint top) {
    bool goesOn;
    do {
        bool atNode = isNode(current) && traversal.trips < budget;
        if (takesPart(atNode)) {
            precise float tEnd = traversal.ray.tMax * farPad();
            uint height = top;
            bool none;
            uint next = enterNode(traversal, atNode ? current : 0u, tEnd, height, none);
            bool empty = height == base;
            uint popped = stack[empty ? 0u : height - 1u];
            height -= none && !empty ? 1u : 0u;
            next = none ? (empty ? kNone : popped) : next;
            current = atNode ? next : current;
            top = atNode ? height : top;
            traversal.trips += atNode ? 1u : 0u;
            if (MODE_COST && atNode) traversal.cost += 2u;
        }
        goesOn = isNode(current) && traversal.trips < budget;
    } while (anyHasWork(goesOn));
    return current;
}

// A ray at an instance, or at the end of one, waits there until all rays of the subgroup do: else every trip
// would pay for the transform (traversal/lanes.glsl).
bool isInSpace(uint child) { return child != kNone && !isInstance(child); }

// From the root. Returns kNone when finished, else 0: the slot to begin from again, with the hit so far.
uint traverse(inout Traversal traversal, uint root) {
    uint top = 0u;
    uint base = 0u;  // of the stack within an instance: entries below belong to the world
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
                    current = descend(traversal, current, base, budget, top);
                    if (here && isInSpace(current) && !isNode(current)) {
                        testLeaf(traversal, current);
                        current = pop(settled(traversal), top, base);
                    }
                    traversal.trips += here ? pass : 0u;
                }
                here = goes && isInSpace(current) && traversal.trips < budget;
            } while (FEATURE_INSTANCES && anyHasWork(here));
            if (FEATURE_INSTANCES) {
                // The way out of an instance may lead straight into the next.
                bool leaves = goes && current == kNone && traversal.instance != kNone && top > 0u &&
                              !settled(traversal);
                uint outside = pop(!leaves, top, 0u);
                if (leaves) current = outside;
                bool enters = goes && current != kNone && isInstance(current);
                uint inner =
                    enterSpace(traversal, enters ? current & kLeafFirstMask : kNone, enters || leaves);
                if (enters) current = inner;
                base = enters ? top : (leaves ? 0u : base);
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
