// The tree of rays below a camera ray, walked in depth-first order without recursion: of two branches one is
// followed at once, the other waits in rows of the path's own. The first is the one on the outer side of the
// surface: what it meets outside soon ends, while the inner one may be reflected to and fro inside for as
// long as maxDepth allows, each time with a branch to leave; so few branches wait.
#ifndef GLINT_TREE_GLSL
#define GLINT_TREE_GLSL

#include "material.glsl"
#include "optics.glsl"
#include "path.glsl"

float greatestOf(vec3 v) { return max(v.x, max(v.y, v.z)); }

uvec4 loadMedia(uint path) {
    return FEATURE_TRANSMISSION ? loadRow(treeRow(kTreeRowMedia), path) : uvec4(0u);
}

void startTree(uint path, Environment environment) {
    if (MODE_LEDGER && dispatch.sampleIndex == 0u) {
        storeRow(treeRow(kTreeRowLost), path, uvec4(0u));
        storeRow(treeRow(kTreeRowLostCounts), path, uvec4(0u));
    }
    if (FEATURE_TRANSMISSION) {
        storeRow(treeRow(kTreeRowMedia), path,
                 uvec4(environment.eyeMedium0, environment.eyeMedium1, environment.eyeMedium2,
                       environment.eyeMedium3));
        storeRow(treeRow(kTreeRowBranch), path, uvec4(0u));
    }
}

const uint kLostCut = 0u;
const uint kLostDepth = 1u;
const uint kLostRoom = 2u;
const uint kLostMedia = 3u;

void book(uint path, bool lost, uint reason, float bound) {
    uvec4 sums = loadRow(treeRow(kTreeRowLost), path);
    uvec4 counts = loadRow(treeRow(kTreeRowLostCounts), path);
    vec4 added =
        uintBitsToFloat(sums) + mix(vec4(0.0), vec4(bound), equal(uvec4(reason), uvec4(0u, 1u, 2u, 3u)));
    counts += mix(uvec4(0u), uvec4(1u), equal(uvec4(reason), uvec4(0u, 1u, 2u, 3u)));
    if (lost) {
        storeRow(treeRow(kTreeRowLost), path, floatBitsToUint(added));
        storeRow(treeRow(kTreeRowLostCounts), path, counts);
    }
}

// Whether a branch that the surface asks for is followed; if not, the ledger says why. depth: rays before the
// one that met the surface.
bool isFollowed(uint path, bool wanted, uint depth, vec3 throughput, Environment environment) {
    bool inDepth = depth < environment.maxDepth;
    if (!MODE_LEDGER) return wanted && inDepth;
    float bound = greatestOf(abs(throughput)) * environment.radianceBound;
    bool enough = !(bound < environment.minContribution);
    book(path, wanted && !(inDepth && enough), inDepth ? kLostCut : kLostDepth, bound);
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

vec3 transmissionAt(uint medium, Surface surface) {
    Optics optics = opticsOf(medium);
    return kHasTextures ? optics.transmission * textureAt(optics.transmissionTexture, surface).xyz
                        : optics.transmission;
}

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

// From the surface that a path has met (`met`; if not, it has left the scene) to the path's next ray, if
// there is one. Returns false if not.
bool nextBranch(uint path, bool alive, bool met, Ray ray, Hit hit, Surface surface, bool entering,
                Material material, Crossing crossing, vec3 throughput, Environment environment,
                out Branch next) {
    uvec4 state = loadRow(treeRow(kTreeRowBranch), path);
    bool dielectric = material.medium != 0u;
    float eta = iorOf(crossing.mediumBefore) / iorOf(crossing.mediumAfter);
    bool splits = dielectric && crossing.counts && eta != 1.0;
    Split split = splitAt(surface, ray.direction, splits ? eta : 1.0);
    vec3 reflectWeight = splits ? min(material.mirror + split.reflectance, vec3(1.0)) : material.mirror;
    vec3 refractWeight =
        crossing.counts ? (1.0 - split.reflectance) * transmissionAt(material.medium, surface) : vec3(1.0);
    bool reflects = met && crossing.counts && (splits || greatestOf(material.mirror) > 0.0);
    bool refracts = met && dielectric && !split.total;
    if (MODE_LEDGER) book(path, met && crossing.crowded, kLostMedia, 0.0);

    Branch mirrorBranch =
        Branch(offsetOrigin(surface.position, surface.error, surface.normal),
               splits ? split.reflected : mirrored(surface, ray.direction), hit.primitive, hit.instance,
               throughput * reflectWeight, crossing.before, state.x + 1u, kRayMirrored);
    Branch innerBranch =
        Branch(offsetOrigin(surface.position, surface.error, -surface.normal), split.refracted, hit.primitive,
               hit.instance, throughput * refractWeight, crossing.after, state.x + 1u, kRayRefracted);
    reflects = isFollowed(path, reflects, state.x, mirrorBranch.throughput, environment);
    refracts = isFollowed(path, refracts, state.x, innerBranch.throughput, environment);

    bool both = reflects && refracts;
    bool mirrorFirst = both ? entering : reflects;
    next = innerBranch;
    Branch second = mirrorBranch;
    if (mirrorFirst) {
        next = mirrorBranch;
        second = innerBranch;
    }
    bool crowded = both && state.y >= kMaxWaiting;
    float weakest = min(greatestOf(abs(next.throughput)), greatestOf(abs(second.throughput)));
    if (MODE_LEDGER) book(path, crowded, kLostRoom, weakest * environment.radianceBound);
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
    if (goesOn) {
        storeRow(treeRow(kTreeRowBranch), path, uvec4(next.depth, waiting, MODE_TALLY ? next.kind : 0u, 0u));
        storeRow(treeRow(kTreeRowMedia), path, next.media);
    }
    if (MODE_TALLY && goesOn && next.kind == kRayRefracted) atomicAdd(counters[kCounterRefracted], 1u);
    return goesOn;
}

#endif
