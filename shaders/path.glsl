// The path of an invocation: its pixel, and the rows of the path state.
#ifndef GLINT_PATH_GLSL
#define GLINT_PATH_GLSL

#include "storage.glsl"

layout(local_size_x = kWorkgroupSize, local_size_y = 1, local_size_z = 1) in;

uint pathIndex() { return gl_GlobalInvocationID.x; }

// Scenes whose paths go on after the first hit: these list the paths that do.
const bool kBounces = FEATURE_MIRRORS || FEATURE_TRANSMISSION;

// The pixel of a path in the image; false outside the region. Paths follow a Morton curve in the tile, so
// that 8 of them make a block of 4x2 pixels and 32 one of 8x4.
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

// Hit instance, source instance, and where an unfinished walk is: see dispatch.h.
uint rowInstance() { return MODE_ADAPTIVE ? kPathRowsAdaptive : (MODE_AOVS ? kPathRowsWithAovs : kPathRows); }

// Entries of two lists of paths, one read and one written by a dispatch.
uint rowList(uint list) { return rowInstance() + (FEATURE_INSTANCES ? 1u : 0u) + list; }

// kTreeRow...: after the others.
uint treeRow(uint row) { return rowList(kBounces ? kListRows : 0u) + row; }

#endif
