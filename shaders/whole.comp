#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_shuffle : require
// A sample from its camera ray to the end of its path in one kernel, without passing the path's state through
// memory as generate.comp, intersect.comp, light.comp and shade.comp do. If a path runs out of trips or rays,
// the host renders the slice again by those four.
#define GLINT_SHADOW_RAYS true
#include "primitives/robust.glsl"
#include "shading/camera.glsl"
#include "traversal/leaf.glsl"
#include "traversal/stack.glsl"
#include "shading/lighting.glsl"

// Closest hits and shadow rays in turn.
bool isAnyHit(Traversal traversal) { return traversal.any; }

// All lights of a hit. False if the trips did not suffice.
bool castShadows(inout Lit lit, inout Traversal traversal, Environment environment) {
    uint index = 0u;
    uint end = environment.lightCount;
    uint budget = dispatch.tripBudget;
    bool finished = true;
    bool going = lit.live && index < end;
    traversal.any = true;
    do {
        if (takesPart(going)) {
            Sight sight = kNoSight;
            if (going) sight = aim(lit, index, true, traversal);
            if (kConvergent && !going) removeRay(traversal);
            uint left = trace(traversal, environment);
            if (going) {
                finished = left == kNone || settled(traversal) || !sight.facing;
                take(lit, index, sight, traversal, finished);
                ++index;
                going = finished && index < end && traversal.trips < budget;
            }
        }
    } while (anyHasWork(going));
    return finished && (!lit.live || index >= end);
}

// True if another ray follows; it takes the place of the previous ray.
bool goesOn(uint path, Interaction at, Environment environment, inout Ledger ledger, inout bool complete,
            inout uvec2 state, inout uvec4 media, inout vec3 throughput, inout Ray ray, inout uint followed) {
    Branch next;
    bool follows = nextBranch(path, ledger, complete, at, state, throughput, environment, next);
    media = next.media;
    // The host has counted the trips of so many rays (src/render/path_limits.cpp).
    complete = complete && !(follows && followed == dispatch.mostFollowed);
    follows = follows && complete;
    ray = next.ray;
    throughput = next.throughput;
    followed += follows ? 1u : 0u;
    return follows;
}

void main() {
    uint path = pathIndex();
    uvec2 pixel;
    bool takes = pixelOf(path, pixel);
    if (MODE_ADAPTIVE && dispatch.sampleIndex != 0u) takes = takes && loadRow(kRowSpread, path).w == 1u;
    Environment environment = loadEnvironment(0u);
    vec3 throughput;
    Ray ray = cameraRay(pixel, throughput);
    uvec4 sum = uvec4(0u);
    // Loads ignore conditions (traversal/lanes.glsl): the first sample loads one row, not untouched pages.
    uint summed = dispatch.sampleIndex == 0u ? 0u : path;
    if (!MODE_ADAPTIVE && dispatch.sampleIndex != 0u) sum = loadRow(kRowRadiance, summed);
    Ledger ledger = dispatch.sampleIndex == 0u ? emptyLedger() : loadLedger(path);
    Traversal traversal;
    traversal.trips = 0u;
    traversal.cost = 0u;
    uint followed = 0u;       // rays after the camera's
    uvec2 state = uvec2(0u);  // as in kTreeRowBranch
    uvec4 media = eyeMedia(environment);
    bool alive = takes;
    bool complete = true;
    do {
        if (takesPart(alive)) {
            traversal.ray = ray;
            traversal.hit = Hit(ray.tMax, 0.0, 0.0, kNone, kNone, 0u);
            traversal.any = false;
            if (kConvergent && !alive) removeRay(traversal);
            bool finished = trace(traversal, environment) == kNone;
            if (alive) complete = finished;
            Interaction at = interactionAt(ray, traversal.hit, media);
            vec3 transmittance = vec3(1.0);
            if (kHasLights) {
                Lit lit = litAt(path, alive && complete, at, sum, throughput);
                complete = castShadows(lit, traversal, environment) && complete;
                sum = packRow(lit.radiance, lit.hits);
                transmittance = lit.transmittance;
            } else if (FEATURE_TRANSMISSION) {
                transmittance = transmittanceOfWay(at);
            }
            if (alive) {
                uint hits = hitsAfter(sum.w, at.isHit && followed == 0u, throughput.x);
                if (FEATURE_TRANSMISSION) throughput *= transmittance;
                sum = packRow(uintBitsToFloat(sum.xyz) + throughput * ownLight(at, environment), hits);
                alive = false;
                if (kBounces)
                    alive = goesOn(path, at, environment, ledger, complete, state, media, throughput, ray,
                                   followed);
            }
        }
    } while (anyHasWork(alive));
    if (takes) {
        storeRow(kRowRadiance, path, sum);
        storeLedger(path, ledger);
    }
    if (kBounces && followed > 0u) atomicAdd(counters[kCounterAlive], followed);
    if (!complete) atomicAdd(counters[kCounterUnfinished], 1u);
}
