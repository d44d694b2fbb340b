// The path state: which pixel an invocation works on, and its rows.
#ifndef GLINT_PATH_GLSL
#define GLINT_PATH_GLSL

#include "traversal/ray.glsl"
#include "storage.glsl"

layout(local_size_x = kWorkgroupSize, local_size_y = 1, local_size_z = 1) in;

uint pathIndex() { return gl_GlobalInvocationID.x; }

// Scenes whose paths go on after the first hit: these list the paths that do.
const bool kBounces = FEATURE_MIRRORS || FEATURE_TRANSMISSION;

// The pixel of a path in the whole picture; false outside the region. A path keeps its column in the state
// for as long as it lives, listed or not, so every kernel may ask. Paths follow a Morton curve in the tile,
// so that 8 of them make a block of 4x2 pixels and 32 one of 8x4.
bool pixelOf(uint path, out uvec2 pixel) {
    uint group = path / kWorkgroupSize;
    uint tile = dispatch.firstTile + (group % dispatch.run) * dispatch.interleave + group / dispatch.run;
    uint tilesX = (dispatch.regionWidth + kTileSize - 1u) / kTileSize;
    uint lane = path % kWorkgroupSize;
    uvec2 inTile = uvec2((lane & 1u) | ((lane >> 1) & 2u) | ((lane >> 2) & 4u),
                         ((lane >> 1) & 1u) | ((lane >> 2) & 2u) | ((lane >> 3) & 4u));
    uvec2 local = uvec2(tile % tilesX, tile / tilesX) * kTileSize + inTile;
    pixel = local + uvec2(dispatch.regionX, dispatch.regionY);
    return tile < dispatch.firstTile + dispatch.tileCount && local.x < dispatch.regionWidth &&
           local.y < dispatch.regionHeight;
}

// Row kRowWalk of a path. Only resume dispatches and renders with AOVs read its contents.
uvec4 loadWalkRow(uint path) {
    uvec4 row = uvec4(kNone, 0u, 0u, 0u);
    if (MODE_RESUME || MODE_AOVS || MODE_COST) row = loadRow(kRowWalk, path);
    return row;
}

// Rays of a caller's at the beginning of their walk: nothing is known of them but themselves.
const bool kFirstGiven = MODE_GIVEN && !MODE_RESUME;

// A path that has ended keeps a ray whose interval is empty.
bool isAlive(Ray ray) { return ray.tMin < kInfinity; }

// Hit instance, source instance, and where an unfinished walk is: see dispatch.h.
uint rowInstance() { return MODE_ADAPTIVE ? kPathRowsAdaptive : (MODE_AOVS ? kPathRowsWithAovs : kPathRows); }

// Entries of two lists of paths, one read and one written by a dispatch.
uint rowList(uint list) { return rowInstance() + (FEATURE_INSTANCES ? 1u : 0u) + list; }

// kTreeRow...: after the others.
uint treeRow(uint row) { return rowList(kBounces ? kListRows : 0u) + row; }

// The path that this invocation works on in kernels that may run over a list. `present` is false past the
// list's end; the path is then one that may be read.
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
               MODE_GIVEN ? uintBitsToFloat(origin.w) : kInfinity, MODE_GIVEN ? kNone : origin.w,
               MODE_GIVEN ? kNone : loadInstanceRow(path).y);
}

void storeRay(uint path, Ray ray) {
    storeRow(kRowOrigin, path, packRow(ray.origin, ray.source));
    storeRow(kRowDirection, path, packRow(ray.direction, floatBitsToUint(ray.tMin)));
    storeRow(kRowHit, path, uvec4(floatBitsToUint(ray.tMax), 0u, 0u, kNone));
    storeInstanceRow(path, uvec4(kNone, ray.sourceInstance, kNone, kNone));
}

// In the sign of a hit row's t, which is else positive: a packet was given up with this hit, and the ray is
// to be started again.
const uint kStartAgain = 0x80000000u;

// The best hit so far; before any, t is the end of the ray's interval. `id` is in the walk row.
Hit loadHit(uint path, uint id) {
    uvec4 row = loadRow(kRowHit, path);
    return Hit(uintBitsToFloat(row.x), uintBitsToFloat(row.y), uintBitsToFloat(row.z), row.w,
               loadInstanceRow(path).x, id);
}

// The same of a ray that is about to be traced.
Hit hitBefore(Ray ray, uint path, uint id) {
    Hit hit = Hit(ray.tMax, 0.0, 0.0, kNone, kNone, 0u);
    if (!kFirstGiven) hit = loadHit(path, id);
    return hit;
}

#endif
