// Closest hit, or any hit if GLINT_ANY_HIT is defined (as Traversal::any says with GLINT_BOTH_HITS), through
// the BVH and over the planes.
//
// lavapipe ends every loop once a subgroup has made 65,535 trips through all its loops together, without a
// word. So each lane counts its trips and gives up at dispatch.tripBudget (the host derives it,
// src/render/path_limits.cpp). A ray that gave up is finished by further dispatches of the same kernel with
// MODE_RESUME: a walk of the nodes in depth-first order that needs no stack, so that its whole state is one
// slot number. The order cannot matter, as the closest hit is the closest in any order.
#ifndef GLINT_TRAVERSAL_GLSL
#define GLINT_TRAVERSAL_GLSL

#ifdef GLINT_CROSSINGS
#include "crossings.glsl"
#endif
#ifdef GLINT_CERTIFY
#include "certainty.glsl"
#endif
#include "instance.glsl"
#include "intersect.glsl"
#include "lanes.glsl"
#include "material.glsl"
#include "primitives/all.glsl"
#include "wide_nodes.glsl"

// In the place of a slot: a ray that has not begun.
const uint kSlotFresh = 0xfffffffeu;

// Whether hits wait until it is decided whether the ray goes through them (answer): in scenes with holes, by
// walks with a stack of words.
#if defined(GLINT_CROSSINGS) || defined(GLINT_CERTIFY)
const bool kAsks = false;
#else
const bool kAsks = FEATURE_ALPHA_MASK && NODE_FORMAT != kNodesCompressed && !MODE_RESUME;
#endif
// The planes are then the first leaf of a walk that nobody goes on with, so that there is one place alone
// that decides.
#ifdef GLINT_WHOLE_PATHS
const bool kPlanesInWalk = FEATURE_OPEN_PLANES && kAsks;
#else
const bool kPlanesInWalk = false;
#endif
const uint kLeafOfPlanes = kLeafFlag | (kKindPlane << kLeafKindShift);

// With kAsks, of the leaf at hand: how many of its primitives have been tested, from which t on the next is,
// and a hit that waits; with kPlanesInWalk, the planes. No part of Traversal, which is copied with every
// call.
uint leafTested;
float leafAfter;
bool asking;
Hit asked;
uint planesInLeaf;

struct Traversal {
    Ray ray;  // in the coordinates of `instance`
    RayFrame frame;
    Hit hit;
    float nearest;  // t of the hit less its tSlip
    // With instances: where the ray is, kNone for the world; what primitives' ids count from there and
    // whether corners are exchanged; the ray as it is in the world; how much wider the world's boxes are;
    // and, of an unfinished walk within an instance, the slot where it goes on in the world.
    uint instance;
    uint idBase;
    bool mirrored;
    Ray world;
    float pad;
    uint worldSlot;
    uint trips;
    uint cost;
#ifdef GLINT_BOTH_HITS
    bool any;  // the same wherever a walk is written, so that each has the code of its kind alone
#endif
#ifdef GLINT_SHADOW_RAYS
    Passage passage;
#endif
#ifdef GLINT_CROSSINGS
    uint crossed;   // surfaces so far
    uint doubtful;  // 1: rounding decides about one of them
    uvec2 list;     // the first place of what is crossed, and how many there are
    uint aside;     // triangles put aside, and which
    uvec4 aside0, aside1;
#endif
#ifdef GLINT_CERTIFY
    Certainty certainty;
#endif
};

// True if there is no room for what another leaf may put aside.
bool asideIsFull(Traversal traversal) {
#ifdef GLINT_CROSSINGS
    return kPutsAside && traversal.aside > kRoomAside;
#else
    return false;
#endif
}

// In the place of the ray of a lane that has none while others go on (kConvergent): nothing is found.
void removeRay(inout Traversal traversal) {
    traversal.ray = Ray(vec3(0.0), vec3(0.0), 0.0, -1.0, kNone, kNone);
}

bool isNode(uint child) { return (child & kLeafFlag) == 0u; }

// A hit settles an any-hit ray.
bool settled(Traversal traversal) {
#if defined(GLINT_BOTH_HITS)
    return traversal.any && traversal.hit.primitive != kNone;
#elif defined(GLINT_ANY_HIT)
    return traversal.hit.primitive != kNone;
#else
    return false;
#endif
}

// Takes the hit if it is closer, or in the same place with a lower id. t - tSlip is at most ray.tMax, the
// least t + tSlip so far.
void accept(inout Traversal traversal, float t, float u, float v, uint primitive, uint ownId) {
    uint id = ownId;
    if (FEATURE_INSTANCES) id = (traversal.idBase | (ownId & kDielectricRank)) + (ownId & ~kDielectricRank);
    precise float near = t - tSlip;
    precise float far = t + tSlip;
    bool isCloser = far < traversal.nearest;
    bool better = traversal.hit.primitive == kNone || isCloser || id < traversal.hit.id;
    if (better) {
        bool exchanged =
            FEATURE_INSTANCES && traversal.mirrored && primitive >> kPrimitiveKindShift == kKindTriangle;
        traversal.hit = Hit(t, exchanged ? v : u, exchanged ? u : v, primitive,
                            FEATURE_INSTANCES ? traversal.instance : kNone, id);
        traversal.nearest = near;
    }
    traversal.ray.tMax = far < traversal.ray.tMax ? far : traversal.ray.tMax;
}

bool isInstance(uint child) {
    return FEATURE_INSTANCES && (child >> kLeafKindShift) == ((kLeafFlag >> kLeafKindShift) | kKindInstance);
}

// Takes the ray into an instance, or back into the world for kNone. Returns the root of the tree there, kNone
// for the world's.
uint enterSpace(inout Traversal traversal, uint target, bool enters) {
    uint root = kNone;
    if (enters) {
        bool toWorld = target == kNone;
        Instance instance = loadInstance(toWorld ? 0u : target);
        vec3 origin = traversal.world.origin;
        vec3 direction = traversal.world.direction;
        if (!toWorld) enterInstance(instance, origin, direction);
        traversal.ray.origin = origin;
        traversal.ray.direction = direction;
        bool isHome = target == traversal.world.sourceInstance || traversal.world.source == kNone;
        traversal.ray.source = isHome ? traversal.world.source : kElsewhere;
        float pad = toWorld ? traversal.pad : 0.0;
#ifdef GLINT_CERTIFY
        pad = enterWithErrors(traversal.certainty, traversal.world, traversal.ray, instance, toWorld, pad);
#endif
        traversal.frame = makeFrame(origin, direction, pad);
        if (!toWorld) traversal.frame.slip = slipOfWayIn(instance, traversal.world.origin);
        traversal.instance = target;
        traversal.idBase = toWorld ? 0u : instance.idBase;
        traversal.mirrored = !toWorld && instance.mirrored != 0u;
        uint first = NODE_FORMAT == kNodesTwo || MODE_RESUME ? instance.root : instance.wideRoot;
        root = toWorld ? kNone : first;
        ++traversal.trips;
    }
    return root;
}

#include "leaf.glsl"

#include "descend.glsl"

// A ray that comes to an instance, or to the end of one, waits there until all rays of the subgroup do: on
// lavapipe the way in would else be paid for in every trip, by rays that are elsewhere.
bool isAtHand(uint child) { return child != kNone && !isInstance(child) && !(kAsks && asking); }

// What comes next from the stack, kNone at its end or if the ray is done.
uint takeNext(bool done, inout uint top, uint base) {
    bool ends = done || top == base;
    uint place = top == 0u ? 0u : top - 1u;
    uint word = stackAt(place);
    bool last = true;
    uint next = word;
    if (NODE_FORMAT == kNodesFour) {
        next = childOfFour(word);
        last = isLastOfFour(word);
        stackPut(place, ends ? word : withoutFirst(word));
    }
    top -= ends || !last ? 0u : 1u;
    return ends ? kNone : next;
}

// Rays that wait, before instances or for an answer, do so outside of a middle loop.
const bool kMiddleLoop = FEATURE_INSTANCES || kAsks;
#define GLINT_LOOPS_OF_KIND(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, crossings, \
                            loops, uv)                                                                      \
    trips += FEATURE_##FEATURE ? uint(loops) : 0u;
// What a trip of the middle loop counts for: itself, and each loop that stands in it, which lavapipe enters
// even if no ray has anything to do there (as src/render/path_limits.cpp).
uint tripsOfPass() {
    uint trips = 3u;
    GLINT_PRIMITIVES(GLINT_LOOPS_OF_KIND, 0)
    return trips;
}

uint afterLeaf(uint leaf, uint root, bool done, inout uint top, uint base) {
    uint next = takeNext(done, top, base);
    return kPlanesInWalk && leaf == kLeafOfPlanes && !done ? root : next;
}

// From the root with a stack. Returns kNone when finished, else the slot to resume from:
// 0, the beginning; what is known by then keeps the second pass short.
uint traverse(inout Traversal traversal, uint root) {
    uint top = 0u;
    uint base = 0u;  // what of the stack is the world's while the ray is in an instance
    uint current = root;
    uint budget = dispatch.tripBudget;  // lavapipe reads it lane by lane, each time
    uint tripsOfMiddle = kMiddleLoop ? tripsOfPass() : 0u;
    // What is looked at in vain is to be the word of a node.
    if (NODE_FORMAT == kNodesFour) stackPut(0u, 0u);
    if (kPlanesInWalk && planesInLeaf > 0u) current = kLeafOfPlanes;
    // One round, or with kPutsAside as often as there is no more room.
    do {
        do {
            bool goes = current != kNone && traversal.trips < budget && !asideIsFull(traversal);
            if (kConvergent || goes) {
                do {
                    bool here = goes && isAtHand(current) && traversal.trips < budget;
                    if (kConvergent || here) {
                        current = descend(traversal, current, base, budget, top);
                        if (here && isAtHand(current) && !isNode(current)) {
                            testLeaf(traversal, current);
                            if (!kAsks || !asking) {
                                current = afterLeaf(current, root, settled(traversal), top, base);
                                if (kAsks) leafTested = 0u;
                            }
                        }
                        traversal.trips += here ? tripsOfMiddle : 0u;
                    }
                } while (kMiddleLoop && anyGoesOn(goes && isAtHand(current) && traversal.trips < budget));
                if (kAsks && asking) {
                    answer(traversal);
                    if (settled(traversal) || leafTested >= sizeOfLeaf(current)) {
                        current = afterLeaf(current, root, settled(traversal), top, base);
                        leafTested = 0u;
                    }
                }
                if (FEATURE_INSTANCES) {
                    // The way out of an instance may lead straight into the next.
                    bool leaves = goes && current == kNone && traversal.instance != kNone && top > 0u &&
                                  !settled(traversal);
                    uint outside = takeNext(!leaves, top, 0u);
                    if (leaves) current = outside;
                    bool enters = goes && current != kNone && isInstance(current);
                    uint inner =
                        enterSpace(traversal, enters ? current & kLeafFirstMask : kNone, enters || leaves);
                    if (enters) current = inner;
                    base = enters ? top : (leaves ? 0u : base);
                }
                traversal.trips += goes ? tripsOfMiddle + 1u : 0u;
            }
        } while (anyGoesOn(current != kNone && traversal.trips < budget && !asideIsFull(traversal)));
        settleAside(traversal);
    } while (kPutsAsideHere && current != kNone && traversal.trips < budget);
    if (FEATURE_INSTANCES) traversal.instance = kNone;
    return current == kNone ? kNone : 0u;
}

// The same set of leaves in depth-first order from `slot` on, without a stack. Returns where it stopped,
// kNone at the end.
uint walk(inout Traversal traversal, uint slot) {
    uint budget = dispatch.tripBudget;
    do {
        if (slot != kNone && traversal.trips < budget && !asideIsFull(traversal)) {
            Node node = loadNode(slot >> 1);
            bool second = (slot & 1u) != 0u;
            uint child = second ? node.child1 : node.child0;
            precise float tEnd = traversal.ray.tMax * farPad();
            float near;
            bool entered = intersectBox(traversal.ray, traversal.frame, second ? node.lo1 : node.lo0,
                                        second ? node.hi1 : node.hi0, tEnd, near);
            uint next = second ? node.escape : slot + 1u;
            if (entered && isNode(child)) next = child << 1;
            bool leaf = entered && child != kNone && !isNode(child) && !isInstance(child);
            if (leaf) testLeaf(traversal, child);
            slot = settled(traversal) ? kNone : next;
            if (FEATURE_INSTANCES) {
                bool enters = entered && child != kNone && isInstance(child);
                if (enters) traversal.worldSlot = next;
                bool leaves = !enters && slot == kNone && traversal.instance != kNone && !settled(traversal);
                uint root = enterSpace(traversal, enters ? child & kLeafFirstMask : kNone, enters || leaves);
                slot = enters ? root << 1 : (leaves ? traversal.worldSlot : slot);
            }
            ++traversal.trips;
            if (MODE_COST) ++traversal.cost;
        }
    } while (slot != kNone && traversal.trips < budget && !asideIsFull(traversal));
    settleAside(traversal);
    return slot;
}

#include "compressed.glsl"
#ifdef GLINT_CROSSINGS
#include "crossings_walk.glsl"
#endif

// Makes the ray ready. False for one with nothing to find: an empty interval, or not finite, or without
// direction.
bool prepare(inout Traversal traversal, Environment environment) {
    vec3 size = abs(traversal.ray.direction);
    bool valid = isFinite(traversal.ray.origin) && isFinite(traversal.ray.direction) &&
                 max(size.x, max(size.y, size.z)) > 0.0;
    if (!valid) traversal.ray.tMax = -1.0;
    traversal.instance = kNone;
    traversal.idBase = 0u;
    traversal.mirrored = false;
    traversal.worldSlot = kNone;
    if (kAsks) {
        leafTested = 0u;
        leafAfter = traversal.ray.tMin;
        asking = false;
    }
    traversal.pad = 0.0;
    if (FEATURE_INSTANCES) {
        traversal.pad = environment.instancePad * greatestComponent(traversal.ray.origin) +
                        environment.instancePadAtOrigin;
        traversal.world = traversal.ray;
        if (traversal.ray.sourceInstance != kNone) traversal.ray.source = kElsewhere;
    }
#ifdef GLINT_CERTIFY
    traversal.pad += boxPad(traversal.certainty);
#endif
    traversal.nearest = traversal.hit.t;
    traversal.frame = makeFrame(traversal.ray.origin, traversal.ray.direction, traversal.pad);
    return traversal.ray.tMax > traversal.ray.tMin;
}

// Triangles come first in the list. (No constant among the terms: glslang 12 folds those of specialization
// constants wrongly.)
#define GLINT_IN_TREE(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, crossings, loops, \
                      uv)                                                                                    \
    GLINT_IN_TREE_##ROLE(FEATURE)
#define GLINT_IN_TREE_TRIANGLES(FEATURE) FEATURE_##FEATURE
#define GLINT_IN_TREE_PACKETS(FEATURE) || FEATURE_##FEATURE
#define GLINT_IN_TREE_LEAVES(FEATURE) || FEATURE_##FEATURE
#define GLINT_IN_TREE_INSTANCES(FEATURE) || FEATURE_##FEATURE
#define GLINT_IN_TREE_UNBOUNDED(FEATURE)
const bool kHasTree = GLINT_PRIMITIVES(GLINT_IN_TREE, 0);

// Runs the ray, or goes on with it from `slot` in MODE_RESUME, or begins it there for kSlotFresh. A ray that
// is not finite or has no direction misses. `place`: the instance and the slot of the world where an
// unfinished walk is. Returns kNone when finished, else the slot to resume from.
uint trace(inout Traversal traversal, Environment environment, uint slot, uvec2 place) {
    bool sound = prepare(traversal, environment);
#ifdef GLINT_CROSSINGS
    traversal.aside = 0u;
    traversal.aside0 = traversal.aside1 = uvec4(kNone);
#endif
    if (MODE_RESUME) {
#ifdef GLINT_SHADOW_RAYS
        bool begins = slot == kSlotFresh;
        if (FEATURE_PLANES) testPlanes(traversal, sound && begins ? environment.planeCount : 0u);
        if (begins) slot = kHasTree && environment.root != kNone && !settled(traversal) ? 0u : kNone;
        if (begins) place = uvec2(kNone);
#endif
        if (FEATURE_INSTANCES) {
            uint trips = traversal.trips;
            traversal.worldSlot = place.y;
            enterSpace(traversal, place.x, sound && slot != kNone && place.x != kNone);
            // Not counted, or with a budget of one trip the walk would stay where it is for ever.
            traversal.trips = trips;
        }
        return walk(traversal, sound ? slot : kNone);
    }
    if (kPlanesInWalk) planesInLeaf = sound ? environment.planeCount : 0u;
    if (FEATURE_PLANES && !kPlanesInWalk) testPlanes(traversal, sound ? environment.planeCount : 0u);
#ifdef GLINT_SHADOW_RAYS
    // A walk from slot 0 comes by all leaves again, but not by the planes.
    Passage afterPlanes = traversal.passage;
#endif
#ifdef GLINT_CROSSINGS
    uint afterPlanesCrossed = traversal.crossed;
#endif
    bool inTree = kHasTree && sound && !settled(traversal);
    uint root = inTree ? environment.root : kNone;
    uint left;
    if (NODE_FORMAT == kNodesCompressed) {
        left = traverseCompressed(traversal, root);
#ifdef GLINT_CROSSINGS
    } else if (kLeavesWait) {
        left = traverseAll(traversal, root);
#endif
    } else {
        left = traverse(traversal, root);
    }
#ifdef GLINT_SHADOW_RAYS
    if (left != kNone) traversal.passage = afterPlanes;
#endif
#ifdef GLINT_CROSSINGS
    if (left != kNone) traversal.crossed = afterPlanesCrossed;
#endif
    return left;
}

#endif
