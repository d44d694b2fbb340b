// Scattering of light at a surface, and the tree of rays that follows (docs/reference/shading.md). The
// reference's version is in src/reference/scatter.cpp.
#ifndef GLINT_SCATTER_GLSL
#define GLINT_SCATTER_GLSL

#include "shading/material.glsl"

// The end of a ray, at a surface or outside of the scene.
struct Interaction {
    Ray ray;
    Hit hit;
    bool isHit;         // false: the ray has left the scene; of the rest only `crossing` means anything
    bool entering;      // the ray comes from the outer side
    Surface surface;    // its normals are turned against the ray
    Material material;  // times its textures
    Crossing crossing;  // with FEATURE_TRANSMISSION alone
};

// media: those that the ray is in (loadMedia).
Interaction interactionAt(Ray ray, Hit hit, uvec4 media) {
    Interaction at;
    at.ray = ray;
    at.hit = hit;
    at.isHit = hit.primitive != kNone;
    at.surface = surfaceAt(ray, at.hit, true);
    at.entering = !(dot(at.surface.geometricNormal, ray.direction) > 0.0);
    faceForward(at.surface, ray.direction);
    at.material = materialAt(at.surface);
    if (FEATURE_TRANSMISSION)
        at.crossing = crossingAt(media, at.isHit ? at.material.medium : 0u, at.entering);
    return at;
}

// False for a surface inside a medium of greater priority: light passes as if it were not there.
bool counts(Interaction at) { return !FEATURE_TRANSMISSION || at.crossing.counts; }

// Transmittance of the medium along the ray.
vec3 transmittanceOfWay(Interaction at) {
    return transmittance(at.crossing.mediumBefore, at.isHit ? at.hit.t : kInfinity);
}

// ---- Light that the surface sends back along the ray ----

// Light that needs no ray to a light: ambient light, or that of the surroundings.
vec3 ownLight(Interaction at, Environment environment) {
    vec3 ambient = counts(at) ? at.material.ambient * environment.ambient : vec3(0.0);
    return at.isHit ? ambient : surroundings(environment, at.ray.direction);
}

// Samples that hit anything. The throughput of a camera ray is its sample's weight.
uint hitsAfter(uint hits, bool covers, float throughput) {
    if (MODE_SCATTERED) return covers ? floatBitsToUint(uintBitsToFloat(hits) + throughput) : hits;
    return hits + (covers ? 1u : 0u);
}

// The part of the light from `toLight`, a unit vector: Lambert's law, and the highlight of Blinn (J. Blinn,
// "Models of Light Reflection for Computer Synthesized Pictures", SIGGRAPH 1977).
vec3 evaluate(Interaction at, vec3 toLight) {
    vec3 part = at.material.diffuse * max(dot(at.surface.shadingNormal, toLight), 0.0);
    if (FEATURE_SPECULAR) {
        vec3 sum = toLight + -at.ray.direction;
        float size = length(sum);
        float cosine = quotient(dot(at.surface.shadingNormal, sum), max(size, 1e-30));
        float shininess = at.material.shininess;
        float power = shininess == 0.0 ? 1.0 : powerOf(clamp(cosine, 0.0, 1.0), shininess);
        if (size > 0.0 && cosine > 0.0) part += at.material.specular * power;
    }
    return part;
}

// ---- Further rays (T. Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6), 1980) ----

// Transmission of a surface of this medium.
vec3 transmissionAt(uint medium, Surface surface) {
    Optics optics = opticsOf(medium);
    return FEATURE_TEXTURED_GLASS ? optics.transmission * textureAt(optics.transmissionTexture, surface).xyz
                                  : optics.transmission;
}

// A reflected ray, on the ray's side of the surface, and a refracted one, on the other. Directions are unit
// vectors; what the rays bring counts by their weights.
struct Scattering {
    bool reflects;
    bool refracts;
    vec3 reflected;
    vec3 refracted;
    vec3 reflectedWeight;
    vec3 refractedWeight;
};

Scattering scatteringAt(Interaction at) {
    Scattering s =
        Scattering(at.isHit && any(greaterThan(at.material.mirror, vec3(0.0))), false,
                   mirrored(at.surface, at.ray.direction), at.ray.direction, at.material.mirror, vec3(0.0));
    if (FEATURE_TRANSMISSION) {
        bool dielectric = at.material.medium != 0u;
        float eta = quotient(iorOf(at.crossing.mediumBefore), iorOf(at.crossing.mediumAfter));
        bool splits = dielectric && at.crossing.counts && eta != 1.0;
        Split split = splitAt(at.surface, at.ray.direction, splits ? eta : 1.0);
        s.reflects = at.isHit && at.crossing.counts && (splits || s.reflects);
        s.refracts = at.isHit && dielectric && !split.total;
        if (splits) {
            s.reflected = split.reflected;
            s.reflectedWeight = min(at.material.mirror + split.reflectance, vec3(1.0));
        }
        s.refracted = split.refracted;
        s.refractedWeight = at.crossing.counts
                                ? (1.0 - split.reflectance) * transmissionAt(at.material.medium, at.surface)
                                : vec3(1.0);
    }
    return s;
}

// ---- The tree of rays below a camera ray ----

// In depth-first order: of two branches the outer one is followed first, and the inner one waits in rows of
// the path. Outer branches soon end, while an inner one may be reflected inside up to maxDepth, each time
// with a branch that leaves; so few branches wait.

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
    if (!MODE_LEDGER) return Ledger(vec4(0.0), uvec4(0u), false);
    return Ledger(uintBitsToFloat(loadRow(treeRow(kTreeRowLost), path)),
                  loadRow(treeRow(kTreeRowLostCounts), path), false);
}

void storeLedger(uint path, Ledger ledger) {
    if (MODE_LEDGER && ledger.changed) {
        storeRow(treeRow(kTreeRowLost), path, floatBitsToUint(ledger.sums));
        storeRow(treeRow(kTreeRowLostCounts), path, ledger.counts);
    }
}

const uint kLostCut = 0u, kLostDepth = 1u, kLostRoom = 2u, kLostMedia = 3u;

void book(inout Ledger ledger, bool lost, uint reason, float bound) {
    bvec4 here = equal(uvec4(reason), uvec4(0u, 1u, 2u, 3u));
    if (lost) {
        ledger.sums += mix(vec4(0.0), vec4(bound), here);
        ledger.counts += uvec4(here);
        ledger.changed = true;
    }
}

// True if a branch that the surface needs is followed; otherwise the ledger records the reason. depth: rays
// before the one that hit the surface.
bool isFollowed(inout Ledger ledger, bool wanted, uint depth, vec3 throughput, Environment environment) {
    bool inDepth = depth < environment.maxDepth;
    if (!MODE_LEDGER) return wanted && inDepth;
    float most = greatestComponent(throughput);
    float bound = most < kLeastThroughput ? 0.0 : most * environment.radianceBound;
    bool enough = !(bound < environment.minContribution);
    book(ledger, wanted && !(inDepth && enough), inDepth ? kLostCut : kLostDepth, bound);
    return wanted && inDepth && enough;
}

struct Branch {
    Ray ray;
    vec3 throughput;
    uvec4 media;
    uint depth;  // rays before this one
    uint kind;   // kRay..., with MODE_TALLY alone
};

uint waitingRow(uint slot, uint row) { return treeRow(kTreeRowWaiting + slot * kWaitingRows + row); }

void storeWaiting(uint path, uint slot, Branch branch) {
    storeRow(waitingRow(slot, kWaitingOrigin), path, packRow(branch.ray.origin, branch.ray.source));
    uint depth = MODE_TALLY ? branch.depth | branch.kind << kWaitingKindShift : branch.depth;
    storeRow(waitingRow(slot, kWaitingDirection), path, packRow(branch.ray.direction, depth));
    storeRow(waitingRow(slot, kWaitingThroughput), path,
             packRow(branch.throughput, branch.ray.sourceInstance));
    storeRow(waitingRow(slot, kWaitingMedia), path, branch.media);
}

Branch loadWaiting(uint path, uint slot) {
    uvec4 origin = loadRow(waitingRow(slot, kWaitingOrigin), path);
    uvec4 direction = loadRow(waitingRow(slot, kWaitingDirection), path);
    uvec4 throughput = loadRow(waitingRow(slot, kWaitingThroughput), path);
    Ray ray = Ray(uintBitsToFloat(origin.xyz), uintBitsToFloat(direction.xyz), 0.0, kInfinity, origin.w,
                  throughput.w);
    return Branch(ray, uintBitsToFloat(throughput.xyz), loadRow(waitingRow(slot, kWaitingMedia), path),
                  MODE_TALLY ? direction.w & ((1u << kWaitingKindShift) - 1u) : direction.w,
                  MODE_TALLY ? direction.w >> kWaitingKindShift : 0u);
}

// Ray::source of a ray that leaves an interaction on its own side, or on the other.
uint sourceOf(Interaction at, bool through) {
    bool inwards = FEATURE_QUADRICS && kindOf(at.hit) == kKindQuadric && (at.hit.u == kLeaves) != through;
    return at.hit.primitive | (inwards ? kStartsInwards : 0u);
}

// The ray that leaves an interaction on the side that `outwards` points to. depth: rays before it.
Branch branchFrom(Interaction at, vec3 outwards, vec3 direction, vec3 throughput, uvec4 media, uint depth,
                  uint kind) {
    vec3 origin = offsetOrigin(at.surface.position, at.surface.error, outwards);
    Ray ray = Ray(origin, direction, 0.0, kInfinity, sourceOf(at, kind == kRayRefracted), at.hit.instance);
    return Branch(ray, throughput, media, depth, kind);
}

// The path's next ray: one that leaves the interaction, or one that has waited; false at the path's end.
// state: rays before the current one on the way from the eye; branches waiting.
bool nextBranch(uint path, inout Ledger ledger, bool alive, Interaction at, inout uvec2 state,
                vec3 throughput, Environment environment, out Branch next) {
    Scattering s = scatteringAt(at);
    Branch mirrorBranch =
        branchFrom(at, at.surface.geometricNormal, s.reflected, throughput * s.reflectedWeight,
                   FEATURE_TRANSMISSION ? at.crossing.before : uvec4(0u), state.x + 1u, kRayMirrored);
    bool reflects = isFollowed(ledger, alive && s.reflects, state.x, mirrorBranch.throughput, environment);
    if (!FEATURE_TRANSMISSION) {
        next = mirrorBranch;
        ++state.x;
        return reflects;
    }
    if (MODE_LEDGER) book(ledger, alive && at.isHit && at.crossing.crowded, kLostMedia, 0.0);
    Branch innerBranch =
        branchFrom(at, -at.surface.geometricNormal, s.refracted, throughput * s.refractedWeight,
                   at.crossing.after, state.x + 1u, kRayRefracted);
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
    float weakest = min(greatestComponent(next.throughput), greatestComponent(second.throughput));
    if (MODE_LEDGER) book(ledger, crowded, kLostRoom, weakest * environment.radianceBound);
    if (crowded && greatestComponent(second.throughput) > greatestComponent(next.throughput)) next = second;
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
