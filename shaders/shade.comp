#version 450
#extension GL_GOOGLE_include_directive : require
// Ends a bounce: background or ambient light, the picture's other layers, and the mirrored ray.
#include "path.glsl"
#include "surface.glsl"

// FNV-1a over words (Fowler, Noll, Vo), see docs/shading.md.
uint hashStep(uint hash, uint word) { return (hash ^ word) * 16777619u; }

void storeAovs(uint path, bool isHit, Hit hit, Surface surface) {
    vec3 position = isHit ? surface.position : vec3(0.0);
    // The largest float stands for "no hit": shaders need not keep infinities.
    storeRow(kRowAovPosition, path, packRow(position, floatBitsToUint(isHit ? hit.t : kInfinity)));
    storeRow(kRowAovNormal, path, packRow(isHit ? surface.shadingNormal : vec3(0.0), isHit ? surface.material : kNone));
    storeRow(kRowAovIndices, path,
             uvec4(floatBitsToUint(isHit ? hit.u : 0.0), floatBitsToUint(isHit ? hit.v : 0.0),
                   isHit ? surface.object : kNone, isHit ? surface.primitive : kNone));
    storeRow(kRowAovGeometry, path, packRow(isHit ? surface.normal : vec3(0.0), 0u));
}

// The mirrored direction; about the geometric normal where the shading normal would send it through the surface.
vec3 mirrored(Surface surface, vec3 direction) {
    precise vec3 r = direction - 2.0 * dot(direction, surface.shadingNormal) * surface.shadingNormal;
    precise vec3 aboutNormal = direction - 2.0 * dot(direction, surface.normal) * surface.normal;
    precise vec3 chosen = dot(r, surface.normal) > 0.0 ? r : aboutNormal;
    precise vec3 unit = chosen / length(chosen);
    return unit;
}

void main() {
    uint path = pathIndex();
    Ray ray = loadRay(path);
    uvec4 walkRow = loadRow(kRowWalk, path);
    Hit hit = loadHit(path, walkRow.y);
    bool alive = isAlive(ray);
    bool isHit = hit.primitive != kNone;
    Environment environment = loadEnvironment(0u);
    Surface surface = surfaceAt(ray, hit);
    if (MODE_AOVS && alive && dispatch.bounce == 0u && dispatch.sampleIndex == 0u) storeAovs(path, isHit, hit, surface);
    faceForward(surface, ray.direction);
    Material material = loadMaterial(surface.material);

    uvec4 throughputRow = loadRow(kRowThroughput, path);
    vec3 throughput = uintBitsToFloat(throughputRow.xyz);
    uint hash = hashStep(throughputRow.w, isHit ? hit.id + 1u : 0u);
    uvec4 sum = loadRow(kRowRadiance, path);
    vec3 emitted = isHit ? material.ambient * environment.ambient : environment.background;
    bool counts = isHit && dispatch.bounce == 0u;
    uint hits = sum.w + (counts ? 1u : 0u);
    // The throughput of a camera ray is its sample's weight.
    if (MODE_SCATTERED) hits = counts ? floatBitsToUint(uintBitsToFloat(sum.w) + throughput.x) : sum.w;

    vec3 onward = throughput * material.mirror;
    bool goesOn = FEATURE_MIRRORS && alive && isHit && dispatch.bounce < environment.maxDepth &&
                  (material.mirror.x > 0.0 || material.mirror.y > 0.0 || material.mirror.z > 0.0);
    if (MODE_AOVS && alive && dispatch.sampleIndex == 0u) {
        storeRow(kRowAovCounts, path, uvec4(dispatch.bounce, walkRow.z, walkRow.w, hash));
    }
    if (alive) {
        storeRow(kRowRadiance, path, packRow(uintBitsToFloat(sum.xyz) + throughput * emitted, hits));
    }
    if (FEATURE_MIRRORS) {
        vec3 origin = offsetOrigin(surface.position, surface.error, surface.normal);
        storeRay(path, Ray(origin, mirrored(surface, ray.direction), goesOn ? 0.0 : kInfinity, kInfinity, hit.primitive));
        storeRow(kRowThroughput, path, packRow(onward, hash));
        storeRow(kRowWalk, path, uvec4(kNone, 0u, walkRow.z, walkRow.w));
        if (goesOn) atomicAdd(counters[kCounterAlive], 1u);
    }
}
