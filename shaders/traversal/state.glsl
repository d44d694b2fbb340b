// A ray on its way through the BVH: its state, instances that it enters and leaves, its tests against
// primitives, and the hits that it accepts.
#ifndef GLINT_STATE_GLSL
#define GLINT_STATE_GLSL

#include "shading/material.glsl"
#include "traversal/lanes.glsl"

// In place of a slot: the ray has not begun.
const uint kSlotFresh = 0xfffffffeu;

struct Traversal {
    Ray ray;  // in the coordinates of `instance`
    RayFrame frame;
    Hit hit;         // the closest so far
    float nearest;   // its t less its tSlip; ray.tMax is the least t + tSlip of all hits so far
    uint instance;   // that the ray is in, kNone in the world
    uint idBase;     // added to the ids of the instance's primitives
    bool mirrored;   // the instance exchanges the second and third corner of triangles
    Ray world;       // the ray in world coordinates
    float pad;       // how much wider the world's boxes are
    uint worldSlot;  // where a stackless traversal continues after the instance
    uint trips;      // loop trips so far, at most dispatch.tripBudget
    uint cost;
    uint crossings;  // only of count queries: surfaces crossed so far
    // Only any-hit and shadow queries use these.
    bool any;         // in whole.comp: a shadow ray, a constant at each call
    Passage passage;  // light that is left after dielectrics
};

// Each kernel defines its query: true if any hit will do.
bool isAnyHit(Traversal traversal);

// True if dielectrics let the ray pass.
bool isShadowRay(Traversal traversal) { return GLINT_SHADOW_RAYS && isAnyHit(traversal); }

// True if the ray needs no further hit.
bool settled(Traversal traversal) { return isAnyHit(traversal) && traversal.hit.primitive != kNone; }

// Gives a lane without work a ray that hits nothing, while other lanes continue (kConvergent).
void removeRay(inout Traversal traversal) {
    traversal.ray = Ray(vec3(0.0), vec3(0.0), 0.0, -1.0, kNone, kNone);
}

bool isNode(uint child) { return (child & kLeafFlag) == 0u; }

bool isInstance(uint child) {
    return FEATURE_INSTANCES && (child >> kLeafKindShift) == ((kLeafFlag >> kLeafKindShift) | kKindInstance);
}

uint kindOfLeaf(uint leaf) { return (leaf >> kLeafKindShift) & kLeafKindMask; }
uint sizeOfLeaf(uint leaf) { return ((leaf >> kLeafCountShift) & kLeafCountMask) + 1u; }

// A hit of the traversal with its instance. If that exchanges corners of triangles, it exchanges u and v.
Hit inWorld(Traversal traversal, Hit hit) {
    if (!FEATURE_INSTANCES) return hit;
    bool exchanged = traversal.mirrored && kindOf(hit) == kKindTriangle;
    return Hit(hit.t, exchanged ? hit.v : hit.u, exchanged ? hit.u : hit.v, hit.primitive, traversal.instance,
               hit.id);
}

// Keeps the hit if it is closer, or in the same place with a lower id (traversal/ray.glsl). Every
// intersection test ensures that t - tSlip <= ray.tMax, so t + tSlip < nearest or the intervals of both hits
// overlap. Any-hit queries keep the primitive alone, which is 10 % faster (docs/lab/traversal.md).
void accept(inout Traversal traversal, Hit hit) {
    if (isAnyHit(traversal)) {
        if (hit.t <= traversal.ray.tMax) traversal.hit.primitive = hit.primitive;
        return;
    }
    uint id = hit.id;
    if (FEATURE_INSTANCES) id = (traversal.idBase | (id & kDielectricRank)) + (id & ~kDielectricRank);
    precise float near = hit.t - tSlip;
    precise float far = hit.t + tSlip;
    bool isFirst = traversal.hit.primitive == kNone;
    bool isCloser = far < traversal.nearest;
    bool isBeyondEnd = isFirst && hit.t > traversal.ray.tMax;  // the ray's own
    bool better = isFirst || isCloser || id < traversal.hit.id;
    if (better && !isBeyondEnd) {
        traversal.hit = inWorld(traversal, hit);
        traversal.hit.id = id;
        traversal.nearest = near;
    }
    traversal.ray.tMax = far < traversal.ray.tMax && !isBeyondEnd ? far : traversal.ray.tMax;
}

// Takes the ray into an instance, or back into the world for kNone. Returns the root of the instance's tree,
// kNone for the world.
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
        traversal.frame = makeFrame(origin, direction, toWorld ? traversal.pad : 0.0);
        if (!toWorld) traversal.frame.slip = slipOfWayIn(instance, traversal.world.origin);
        traversal.instance = target;
        traversal.idBase = toWorld ? 0u : instance.idBase;
        traversal.mirrored = !toWorld && instance.mirrored != 0u;
        root = toWorld ? kNone : instance.root;
        ++traversal.trips;
    }
    return root;
}

// Prepares the ray. Returns false if it cannot hit anything: its interval is empty, it is not finite or its
// direction is zero.
bool prepare(inout Traversal traversal, Environment environment) {
    vec3 size = abs(traversal.ray.direction);
    bool valid = isFinite(traversal.ray.origin) && isFinite(traversal.ray.direction) &&
                 max(size.x, max(size.y, size.z)) > 0.0;
    if (!valid) traversal.ray.tMax = -1.0;
    traversal.instance = kNone;
    traversal.idBase = 0u;
    traversal.mirrored = false;
    traversal.worldSlot = kNone;
    traversal.pad = 0.0;
    if (FEATURE_INSTANCES) {
        traversal.pad = environment.instancePad * greatestComponent(traversal.ray.origin) +
                        environment.instancePadAtOrigin;
        traversal.world = traversal.ray;
        if (traversal.ray.sourceInstance != kNone) traversal.ray.source = kElsewhere;
    }
    if (!MODE_RESUME) traversal.nearest = traversal.hit.t;  // else intersect.comp has set it
    traversal.frame = makeFrame(traversal.ray.origin, traversal.ray.direction, traversal.pad);
    return traversal.ray.tMax > traversal.ray.tMin;
}

// ---- Tests against primitives ----

// The surface at a hit of the traversal, in the world.
Surface surfaceOfHit(Traversal traversal, Hit hit) {
    Ray ray = traversal.ray;
    if (FEATURE_INSTANCES) ray = traversal.world;
    hit = inWorld(traversal, hit);
    return surfaceAt(ray, hit, false);
}

// Accepts or counts a hit, or lets the ray pass; true if further hits of the primitive matter.
bool goesOnAfter(inout Traversal traversal, Hit hit);

// Tests primitives `first` to `end` - 1 for a ray that may pass through hits, to further ones of the same
// primitive. One loop for all kinds: drivers' compilers would spend seconds on each copy of goesOnAfter.
void testEachHit(inout Traversal traversal, uint kind, uint first, uint end) {
    uint index = first;
    float after = traversal.ray.tMin;
    do {
        if (index < end) {
            Ray rest = traversal.ray;
            rest.tMin = after;
            Hit hit;
            bool further = hitPrimitive(rest, traversal.frame, kind, index, traversal.trips, hit);
            if (further) further = goesOnAfter(traversal, hit) && hit.t > after && hasFurtherHits(kind);
            after = further ? hit.t : traversal.ray.tMin;
            index += further ? 0u : 1u;
            traversal.trips += 2u;  // of this loop, and of those in the tests
            if (MODE_COST && !further) ++traversal.cost;
        }
    } while (index < end);
}

#endif
