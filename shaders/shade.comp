#version 450
#extension GL_GOOGLE_include_directive : require
// Ends a bounce: background or ambient light, the picture's other layers, and the next ray of the path.
#include "path.glsl"
#include "material.glsl"
#include "tree.glsl"

// FNV-1a over words (Fowler, Noll, Vo), see docs/reference/shading.md.
uint hashStep(uint hash, uint word) { return (hash ^ word) * 16777619u; }

void storeAovs(uint path, bool isHit, Hit hit, Surface surface) {
    vec3 position = isHit ? surface.position : vec3(0.0);
    vec2 uv = hit.primitive >> kPrimitiveKindShift == kKindTriangle ? vec2(hit.u, hit.v) : surface.uv;
    // The largest float stands for "no hit": shaders need not keep infinities.
    storeRow(kRowAovPosition, path, packRow(position, floatBitsToUint(isHit ? hit.t : kInfinity)));
    storeRow(kRowAovNormal, path,
             packRow(isHit ? surface.shadingNormal : vec3(0.0), isHit ? surface.material : kNone));
    storeRow(kRowAovIndices, path,
             uvec4(floatBitsToUint(isHit ? uv.x : 0.0), floatBitsToUint(isHit ? uv.y : 0.0),
                   isHit ? surface.object : kNone, isHit ? surface.primitive : kNone));
    storeRow(kRowAovGeometry, path, packRow(isHit ? surface.normal : vec3(0.0), 0u));
}

void main() {
    bool present;
    uint path = listedPath(present);
    Ray ray = loadRay(path);
    uvec4 walkRow = loadWalkRow(path);
    Hit hit = loadHit(path, walkRow.y);
    bool alive = present && isAlive(ray);
    bool isHit = hit.primitive != kNone;
    Environment environment = loadEnvironment(0u);
    Surface surface = surfaceAt(ray, hit);
    if (MODE_AOVS && alive && dispatch.bounce == 0u && dispatch.sampleIndex == 0u)
        storeAovs(path, isHit, hit, surface);
    bool entering = !(dot(surface.normal, ray.direction) > 0.0);
    faceForward(surface, ray.direction);
    Material material = materialAt(surface);

    uvec4 throughputRow = loadRow(kRowThroughput, path);
    vec3 throughput = uintBitsToFloat(throughputRow.xyz);
    Crossing crossing;
    if (FEATURE_TRANSMISSION) {
        crossing = crossingAt(loadMedia(path), isHit ? material.medium : 0u, entering);
        throughput *= fading(crossing.mediumBefore, isHit ? hit.t : kInfinity);
    }
    uint hash = hashStep(throughputRow.w, isHit ? hit.id + 1u : 0u);
    uvec4 sum = loadRow(kRowRadiance, path);
    vec3 emitted = isHit ? material.ambient * environment.ambient : surroundings(environment, ray.direction);
    if (FEATURE_TRANSMISSION && isHit && !crossing.counts) emitted = vec3(0.0);
    bool covers = isHit && dispatch.bounce == 0u;
    uint hits = sum.w + (covers ? 1u : 0u);
    // The throughput of a camera ray is its sample's weight.
    if (MODE_SCATTERED)
        hits = covers ? floatBitsToUint(uintBitsToFloat(sum.w) + uintBitsToFloat(throughputRow.x)) : sum.w;

    if (MODE_AOVS && alive && dispatch.sampleIndex == 0u) {
        storeRow(kRowAovCounts, path, uvec4(dispatch.bounce, walkRow.z, walkRow.w, hash));
    }
    if (alive) {
        storeRow(kRowRadiance, path, packRow(uintBitsToFloat(sum.xyz) + throughput * emitted, hits));
    }
    Branch next;
    bool goesOn = false;
    if (FEATURE_TRANSMISSION) {
        goesOn = nextBranch(path, alive, alive && isHit, ray, hit, surface, entering, material, crossing,
                            throughput, environment, next);
    } else if (FEATURE_MIRRORS) {
        next.throughput = throughput * material.mirror;
        goesOn = isFollowed(path, alive && isHit && greatestOf(material.mirror) > 0.0, dispatch.bounce,
                            next.throughput, environment);
        next.origin = offsetOrigin(surface.position, surface.error, surface.normal);
        next.direction = mirrored(surface, ray.direction);
        next.source = hit.primitive;
        next.sourceInstance = hit.instance;
    }
    if (FEATURE_TRANSMISSION || FEATURE_MIRRORS) {
        if (alive)
            storeRow(kRowDirection, path, packRow(next.direction, floatBitsToUint(goesOn ? 0.0 : kInfinity)));
        if (goesOn) {
            storeRow(kRowOrigin, path, packRow(next.origin, next.source));
            storeInstanceRow(path, uvec4(kNone, next.sourceInstance, kNone, kNone));
            storeRow(kRowThroughput, path, packRow(next.throughput, hash));
            if (MODE_AOVS || MODE_COST) storeRow(kRowWalk, path, uvec4(kNone, 0u, walkRow.z, walkRow.w));
            listPath(path);
        }
    }
}
