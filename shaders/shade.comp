#version 450
#extension GL_GOOGLE_include_directive : require
// Ends a bounce: background or ambient light, the image's other layers, and the next ray of the path.
#include "path_rows.glsl"
#include "shading/scatter.glsl"

uint hashStep(uint hash, uint word) { return (hash ^ word) * kHashPrime; }

// Normals in images are the outward ones.
void storeAovs(uint path, Interaction at) {
    vec3 position = at.isHit ? at.surface.position : vec3(0.0);
    float side = at.entering ? 1.0 : -1.0;
    bool isTriangle = kindOf(at.hit) == kKindTriangle;
    vec2 uv = isTriangle ? vec2(at.hit.u, at.hit.v) : at.surface.uv;
    // The largest float stands for "no hit": shaders need not keep infinities.
    storeRow(kRowAovPosition, path, packRow(position, floatBitsToUint(at.isHit ? at.hit.t : kInfinity)));
    storeRow(kRowAovNormal, path,
             packRow(at.isHit ? side * at.surface.shadingNormal : vec3(0.0),
                     at.isHit ? at.surface.material : kNone));
    storeRow(kRowAovIndices, path,
             uvec4(floatBitsToUint(at.isHit ? uv.x : 0.0), floatBitsToUint(at.isHit ? uv.y : 0.0),
                   at.isHit ? at.surface.object : kNone, at.isHit ? at.surface.primitive : kNone));
    float clear = at.isHit ? clearance(at.surface.error, at.surface.geometricNormal) : 0.0;
    storeRow(kRowAovGeometry, path,
             packRow(at.isHit ? side * at.surface.geometricNormal : vec3(0.0), floatBitsToUint(clear)));
}

void main() {
    bool present;
    uint path = listedPath(present);
    uvec4 walkRow = loadWalkRow(path);
    Interaction at = interactionAt(loadRay(path), loadHit(path, walkRow.y), loadMedia(path));
    Environment environment = loadEnvironment(0u);
    bool alive = present && isAlive(at.ray);
    bool keepsAovs = MODE_AOVS && alive && dispatch.sampleIndex == 0u;
    if (keepsAovs && dispatch.bounce == 0u) storeAovs(path, at);

    uvec4 throughputRow = loadRow(kRowThroughput, path);
    vec3 throughput = uintBitsToFloat(throughputRow.xyz);
    if (FEATURE_TRANSMISSION) throughput *= transmittanceOfWay(at);
    uint hash = hashStep(throughputRow.w, at.isHit ? at.hit.id + 1u : 0u);
    uvec4 sum = loadRow(kRowRadiance, path);
    uint hits = hitsAfter(sum.w, at.isHit && dispatch.bounce == 0u, uintBitsToFloat(throughputRow.x));
    if (keepsAovs) storeRow(kRowAovCounts, path, uvec4(dispatch.bounce, walkRow.z, walkRow.w, hash));
    if (alive) {
        storeRow(kRowRadiance, path,
                 packRow(uintBitsToFloat(sum.xyz) + throughput * ownLight(at, environment), hits));
    }

    Branch next;
    bool goesOn = false;
    Ledger ledger = loadLedger(path);
    uvec2 state = uvec2(dispatch.bounce, 0u);
    if (FEATURE_TRANSMISSION) state = loadRow(treeRow(kTreeRowBranch), path).xy;
    if (kBounces) goesOn = nextBranch(path, ledger, alive, at, state, throughput, environment, next);
    if (FEATURE_TRANSMISSION && goesOn) {
        storeRow(treeRow(kTreeRowBranch), path, uvec4(state, MODE_TALLY ? next.kind : 0u, 0u));
        storeRow(treeRow(kTreeRowMedia), path, next.media);
    }
    storeLedger(path, ledger);
    if (kBounces) {
        if (alive)
            storeRow(kRowDirection, path,
                     packRow(next.ray.direction, floatBitsToUint(goesOn ? 0.0 : kInfinity)));
        if (goesOn) {
            storeRow(kRowOrigin, path, packRow(next.ray.origin, next.ray.source));
            storeInstanceRow(path, uvec4(kNone, next.ray.sourceInstance, kNone, kNone));
            storeRow(kRowThroughput, path, packRow(next.throughput, hash));
            if (MODE_AOVS || MODE_COST) storeRow(kRowWalk, path, uvec4(kNone, 0u, walkRow.z, walkRow.w));
            listPath(path);
        }
    }
}
