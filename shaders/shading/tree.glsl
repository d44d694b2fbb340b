// The tree of rays below a camera ray in depth-first order, without recursion: of two branches the outer one
// is followed first, and the inner one waits in rows of the path. Outer branches soon end, while an inner one
// may be reflected inside up to maxDepth, each time with a branch that leaves; so few branches wait.
#ifndef GLINT_TREE_GLSL
#define GLINT_TREE_GLSL

#include "path.glsl"
#include "shading/scatter.glsl"

uvec4 eyeMedia(Environment environment) {
    if (!FEATURE_TRANSMISSION) return uvec4(0u);
    return uvec4(environment.eyeMedium0, environment.eyeMedium1, environment.eyeMedium2,
                 environment.eyeMedium3);
}

// The rows kTreeRowLost and kTreeRowLostCounts of a path.
struct Ledger {
    vec4 sums;
    uvec4 counts;
    bool changed;  // since it was loaded
};

Ledger emptyLedger() { return Ledger(vec4(0.0), uvec4(0u), true); }

Ledger loadLedger(uint path) {
    Ledger ledger = Ledger(vec4(0.0), uvec4(0u), false);
    if (MODE_LEDGER) {
        ledger.sums = uintBitsToFloat(loadRow(treeRow(kTreeRowLost), path));
        ledger.counts = loadRow(treeRow(kTreeRowLostCounts), path);
    }
    return ledger;
}

void storeLedger(uint path, Ledger ledger) {
    if (MODE_LEDGER && ledger.changed) {
        storeRow(treeRow(kTreeRowLost), path, floatBitsToUint(ledger.sums));
        storeRow(treeRow(kTreeRowLostCounts), path, ledger.counts);
    }
}

const uint kLostCut = 0u;
const uint kLostDepth = 1u;
const uint kLostRoom = 2u;
const uint kLostMedia = 3u;

void book(inout Ledger ledger, bool lost, uint reason, float bound) {
    bvec4 here = equal(uvec4(reason), uvec4(0u, 1u, 2u, 3u));
    vec4 sums = ledger.sums + mix(vec4(0.0), vec4(bound), here);
    uvec4 counts = ledger.counts + mix(uvec4(0u), uvec4(1u), here);
    if (lost) {
        ledger.sums = sums;
        ledger.counts = counts;
        ledger.changed = true;
    }
}

// True if a branch that the surface needs is followed; otherwise the ledger records the reason. depth: rays
// before the one that hit the surface.
bool isFollowed(inout Ledger ledger, bool wanted, uint depth, vec3 throughput, Environment environment) {
    bool inDepth = depth < environment.maxDepth;
    if (!MODE_LEDGER) return wanted && inDepth;
    float most = greatestOf(abs(throughput));
    float bound = most < kLeastThroughput ? 0.0 : most * environment.radianceBound;
    bool enough = !(bound < environment.minContribution);
    book(ledger, wanted && !(inDepth && enough), inDepth ? kLostCut : kLostDepth, bound);
    return wanted && inDepth && enough;
}

struct Branch {
    vec3 origin;
    vec3 direction;
    uint source;
    uint sourceInstance;
    vec3 throughput;
    uvec4 media;
    uint depth;  // rays before this one
    uint kind;   // kRay..., with MODE_TALLY alone
};

uint waitingRow(uint slot, uint row) { return treeRow(kTreeRowWaiting + slot * kWaitingRows + row); }

void storeWaiting(uint path, uint slot, Branch branch) {
    storeRow(waitingRow(slot, kWaitingOrigin), path, packRow(branch.origin, branch.source));
    uint depth = MODE_TALLY ? branch.depth | branch.kind << kWaitingKindShift : branch.depth;
    storeRow(waitingRow(slot, kWaitingDirection), path, packRow(branch.direction, depth));
    storeRow(waitingRow(slot, kWaitingThroughput), path, packRow(branch.throughput, branch.sourceInstance));
    storeRow(waitingRow(slot, kWaitingMedia), path, branch.media);
}

Branch loadWaiting(uint path, uint slot) {
    uvec4 origin = loadRow(waitingRow(slot, kWaitingOrigin), path);
    uvec4 direction = loadRow(waitingRow(slot, kWaitingDirection), path);
    uvec4 throughput = loadRow(waitingRow(slot, kWaitingThroughput), path);
    return Branch(uintBitsToFloat(origin.xyz), uintBitsToFloat(direction.xyz), origin.w, throughput.w,
                  uintBitsToFloat(throughput.xyz), loadRow(waitingRow(slot, kWaitingMedia), path),
                  MODE_TALLY ? direction.w & ((1u << kWaitingKindShift) - 1u) : direction.w,
                  MODE_TALLY ? direction.w >> kWaitingKindShift : 0u);
}

// The ray that leaves an interaction on the side that `outwards` points to. depth: rays before it.
Branch branchFrom(Interaction at, vec3 outwards, vec3 direction, vec3 throughput, uvec4 media, uint depth,
                  uint kind) {
    vec3 origin = offsetOrigin(at.surface.position, at.surface.error, outwards);
    return Branch(origin, direction, at.hit.primitive, at.hit.instance, throughput, media, depth, kind);
}

// The path's next ray in scenes without transmission; false at the path's end. depth: rays before the one
// that hit the surface.
bool nextReflection(inout Ledger ledger, bool alive, Interaction at, uint depth, vec3 throughput,
                    Environment environment, out Branch next) {
    Scattering s = scatteringAt(at);
    next = branchFrom(at, at.surface.geometricNormal, s.reflected, throughput * s.reflectedWeight, uvec4(0u),
                      depth + 1u, kRayMirrored);
    return isFollowed(ledger, alive && s.reflects, depth, next.throughput, environment);
}

// The path's next ray: one that leaves the interaction, or one that has waited; false at the path's end.
// state: rays before the current one on the way from the eye; branches waiting.
bool nextBranch(uint path, inout Ledger ledger, bool alive, Interaction at, inout uvec2 state,
                vec3 throughput, Environment environment, out Branch next) {
    Scattering s = scatteringAt(at);
    if (MODE_LEDGER) book(ledger, alive && at.isHit && at.crossing.crowded, kLostMedia, 0.0);
    Branch mirrorBranch =
        branchFrom(at, at.surface.geometricNormal, s.reflected, throughput * s.reflectedWeight,
                   at.crossing.before, state.x + 1u, kRayMirrored);
    Branch innerBranch =
        branchFrom(at, -at.surface.geometricNormal, s.refracted, throughput * s.refractedWeight,
                   at.crossing.after, state.x + 1u, kRayRefracted);
    bool reflects = isFollowed(ledger, alive && s.reflects, state.x, mirrorBranch.throughput, environment);
    bool refracts = isFollowed(ledger, alive && s.refracts, state.x, innerBranch.throughput, environment);

    bool both = reflects && refracts;
    bool mirrorFirst = both ? at.entering : reflects;
    next = innerBranch;
    Branch second = mirrorBranch;
    if (mirrorFirst) {
        next = mirrorBranch;
        second = innerBranch;
    }
    // If a second branch exceeds the room for waiting branches, drop the weaker of the two.
    bool crowded = both && state.y >= kMaxWaiting;
    float weakest = min(greatestOf(abs(next.throughput)), greatestOf(abs(second.throughput)));
    if (MODE_LEDGER) book(ledger, crowded, kLostRoom, weakest * environment.radianceBound);
    if (crowded && greatestOf(abs(second.throughput)) > greatestOf(abs(next.throughput))) next = second;
    uint waiting = state.y;
    if (both && !crowded) {
        storeWaiting(path, waiting, second);
        ++waiting;
    }
    bool fetch = alive && !reflects && !refracts && waiting > 0u;
    Branch fetched = loadWaiting(path, waiting == 0u ? 0u : waiting - 1u);
    if (fetch) {
        next = fetched;
        --waiting;
    }
    bool goesOn = reflects || refracts || fetch;
    state = uvec2(next.depth, waiting);
    if (MODE_TALLY && goesOn && next.kind == kRayRefracted) atomicAdd(counters[kCounterRefracted], 1u);
    return goesOn;
}

#endif
