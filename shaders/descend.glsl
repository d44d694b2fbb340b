// A ray's way from node to node, for walks with a stack of words (traversal.glsl).
#ifndef GLINT_DESCEND_GLSL
#define GLINT_DESCEND_GLSL

// Any-hit rays, most of which leave a surface that they graze at first: nearest first they would look through
// its neighbourhood, which seldom shades them. Not where what light passes is summed in the order of the
// walk.
bool isFarthestFirst(Traversal traversal) {
#if defined(GLINT_BOTH_HITS)
    return traversal.any && !FEATURE_COLORED_SHADOWS;
#elif defined(GLINT_ANY_HIT)
    return !FEATURE_COLORED_SHADOWS;
#else
    return false;
#endif
}

// Pushes what the ray enters of a node's children but the first, or may leave it in the free place above the
// stack, and returns that one, kNone if there is none: which `none` says too, as comparing with kNone takes
// 6 % of the time of scenes/instances.json on lavapipe.
uint stepTwo(Traversal traversal, uint index, float tEnd, inout uint top, out bool none) {
    Ray ray = traversal.ray;
    RayFrame frame = traversal.frame;
    Node node = loadNode(index);
    float near0, near1;
    bool hit0 = intersectBox(ray, frame, node.lo0, node.hi0, tEnd, near0);
    bool hit1 = intersectBox(ray, frame, node.lo1, node.hi1, tEnd, near1);
    bool swapped = isFarthestFirst(traversal) ? near0 < near1 : near1 < near0;
    uint first = swapped ? node.child1 : node.child0;
    uint second = swapped ? node.child0 : node.child1;
    bool both = hit0 && hit1;
    if (kConvergent || both) stackPut(top, second);
    top += both ? 1u : 0u;
    none = !hit0 && !hit1;
    return both ? first : (hit0 ? node.child0 : (hit1 ? node.child1 : kNone));
}

// The first child that the ray enters, or else what comes next from the stack, kNone at its end. The other
// children that it enters are one word there. One store for both, which is made whatever comes of it: a place
// that is not taken is written over. On lavapipe a store that hangs on a condition jumps lane by lane.
// Without `goes` the stack stays as it is, but for the free place above it.
uint stepFour(Traversal traversal, uint index, float tEnd, uint base, bool goes, inout uint top) {
    FourEntered entered = enterFour(traversal.ray, traversal.frame, index, tEnd, isFarthestFirst(traversal));
    bool empty = top == base;
    uint place = empty ? 0u : top - 1u;
    uint word = stackAt(place);
    bool popped = entered.none;
    uint next = childOfFour(popped ? word : entered.first);
    stackPut(popped && !empty && goes ? place : top, popped ? withoutFirst(word) : entered.others);
    if (popped) {
        top = empty || !isLastOfFour(word) ? top : place;
    } else {
        top += entered.more ? 1u : 0u;
    }
    return popped && empty ? kNone : next;
}

// Goes on from node to node, to a leaf, an instance or kNone, the end of the stack from `base` on.
uint descend(inout Traversal traversal, uint current, uint base, uint budget, inout uint top) {
    const bool kFour = NODE_FORMAT == kNodesFour;
    // There is one entry for each level at most: what is left of a node on the current path.
    const bool kMayOverflow = STACK_PLACE == kStackShared || kOwnWords <= kMaxBvhDepth;
    bool atNode, atLeaf;
    do {
        bool goes = isNode(current) && traversal.trips < budget;
        if (kConvergent || goes) {
            precise float tEnd = traversal.ray.tMax * farPad();
            uint height = top;
            uint next;
            if (kFour) {
                next = stepFour(traversal, goes ? current : 0u, tEnd, base, goes, height);
            } else {
                bool none;
                next = stepTwo(traversal, goes ? current : 0u, tEnd, height, none);
                bool empty = height == base;
                uint popped = stackAt(empty ? 0u : height - 1u);
                height -= none && !empty ? 1u : 0u;
                next = none ? (empty ? kNone : popped) : next;
            }
            current = goes ? next : current;
            top = goes ? height : top;
            traversal.trips += goes ? 1u : 0u;
            // No room for what the next node may push: the ray is started again, by the walk without a stack.
            if (kMayOverflow && top + 1u > stackWords()) traversal.trips = budget;
            if (MODE_COST && goes) traversal.cost += kFour ? 4u : 2u;
        }
        bool goesOn = traversal.trips < budget;
        atNode = isNode(current) && goesOn;
        atLeaf = current != kNone && !isNode(current) && goesOn;
    } while (anyGoesOnThroughNodes(atNode, atLeaf));
    return current;
}

#endif
