// Loads and stores of path state in light.comp and packet_light.comp.
#ifndef GLINT_LIGHT_GLSL
#define GLINT_LIGHT_GLSL

#include "shading/lighting.glsl"
#include "path_rows.glsl"

Lit loadLit(uint path, bool present, uvec4 walkRow) {
    Interaction at = interactionAt(loadRay(path), loadHit(path, walkRow.y), loadMedia(path));
    return litAt(path, present && isAlive(at.ray), at, loadRow(kRowRadiance, path),
                 uintBitsToFloat(loadRow(kRowThroughput, path).xyz));
}

// Resume point of a path that has run out of trips; `slot` is kNone if it has not.
struct Rest {
    uint slot;
    uint light;
};

void store(Lit lit, Traversal traversal, Rest rest) {
    bool unfinished = lit.live && rest.slot != kNone;
    if (lit.changed) storeRow(kRowRadiance, lit.path, packRow(lit.radiance, lit.hits));
    // Not stored unless a later kernel reads it: a store has a cost (packet_intersect.comp).
    if (lit.live && (MODE_AOVS || MODE_COST || MODE_RESUME || unfinished)) {
        uvec4 walkRow = loadWalkRow(lit.path);
        storeRow(kRowWalk, lit.path,
                 uvec4(rest.slot, walkRow.y, walkRow.z + traversal.cost, walkRow.w | lit.shadowBits));
    }
    if (unfinished) {
        storeRow(kRowLight, lit.path, uvec4(rest.light, 0u, 0u, 0u));
        uint terms = floatBitsToUint(traversal.passage.terms);
        if (kFiltered) storeRow(treeRow(kTreeRowShadow), lit.path, packRow(traversal.passage.depth, terms));
        if (kFiltered) storeRow(treeRow(kTreeRowAround), lit.path, packRow(traversal.passage.around, 0u));
        storeInstanceRow(lit.path,
                         uvec4(loadInstanceRow(lit.path).xy, traversal.instance, traversal.worldSlot));
        atomicAdd(counters[kCounterUnfinished], 1u);
    }
}

#endif
