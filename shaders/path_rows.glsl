// The rows of a path that one kernel leaves for the next: its ray, its hit, and the lists of paths that
// continue. whole.comp needs none of them.
#ifndef GLINT_PATH_ROWS_GLSL
#define GLINT_PATH_ROWS_GLSL

#include "traversal/ray.glsl"

// Row kRowWalk of a path. Only resume dispatches and renders with AOVs read its contents.
uvec4 loadWalkRow(uint path) {
    uvec4 row = uvec4(kNone, 0u, 0u, 0u);
    if (MODE_RESUME || MODE_AOVS || MODE_COST) row = loadRow(kRowWalk, path);
    return row;
}

// Rays of a caller before their traversal.
const bool kFirstGiven = MODE_GIVEN && !MODE_RESUME;

// A path that has ended keeps a ray whose interval is empty.
bool isAlive(Ray ray) { return ray.tMin < kInfinity; }

// The path of this invocation in kernels that may run over a list. Past its end `present` is false, and the
// path is one that may be read.
uint listedPath(out bool present) {
    uint path = pathIndex();
    present = true;
    if (kBounces) {
        bool isListed = dispatch.listed != 0u;
        present = !isListed || path < dispatch.listed;
        uint entry = loadRow(rowList(dispatch.listRead), path).x;
        path = isListed ? (present ? entry : 0u) : path;
    }
    return path;
}

void listPath(uint path) {
    storeRow(rowList(dispatch.listRead ^ 1u), atomicAdd(counters[kCounterAlive], 1u),
             uvec4(path, 0u, 0u, 0u));
}

uvec4 loadInstanceRow(uint path) {
    uvec4 row = uvec4(kNone);
    if (FEATURE_INSTANCES && !kFirstGiven) row = loadRow(rowInstance(), path);
    return row;
}

void storeInstanceRow(uint path, uvec4 row) {
    if (FEATURE_INSTANCES) storeRow(rowInstance(), path, row);
}

// tMax is in the hit row, but of given rays.
Ray loadRay(uint path) {
    uvec4 origin = loadRow(kRowOrigin, path);
    uvec4 direction = loadRow(kRowDirection, path);
    return Ray(uintBitsToFloat(origin.xyz), uintBitsToFloat(direction.xyz), uintBitsToFloat(direction.w),
               MODE_GIVEN ? uintBitsToFloat(origin.w) : kInfinity,
               MODE_GIVEN ? (MODE_LEAVES ? kElsewhere : kNone) : origin.w,
               MODE_GIVEN ? kNone : loadInstanceRow(path).y);
}

void storeRay(uint path, Ray ray) {
    storeRow(kRowOrigin, path, packRow(ray.origin, ray.source));
    storeRow(kRowDirection, path, packRow(ray.direction, floatBitsToUint(ray.tMin)));
    storeRow(kRowHit, path, uvec4(floatBitsToUint(ray.tMax), 0u, 0u, kNone));
    storeInstanceRow(path, uvec4(kNone, ray.sourceInstance, kNone, kNone));
}

// The sign of a hit row's t: a packet was given up with this hit, and the ray starts again.
const uint kStartAgain = 0x80000000u;

// The best hit so far; before any, t is the end of the ray's interval. `id` is in the walk row.
Hit loadHit(uint path, uint id) {
    uvec4 row = loadRow(kRowHit, path);
    return Hit(uintBitsToFloat(row.x), uintBitsToFloat(row.y), uintBitsToFloat(row.z), row.w,
               loadInstanceRow(path).x, id);
}

uvec4 hitRowOf(Hit hit) { return packRow(vec3(hit.t, hit.u, hit.v), hit.primitive); }

// The same of a ray that is about to be traced.
Hit hitBefore(Ray ray, uint path, uint id) {
    Hit hit = Hit(ray.tMax, 0.0, 0.0, kNone, kNone, 0u);
    if (!kFirstGiven) hit = loadHit(path, id);
    return hit;
}

uvec4 loadMedia(uint path) {
    return FEATURE_TRANSMISSION ? loadRow(treeRow(kTreeRowMedia), path) : uvec4(0u);
}

#endif
