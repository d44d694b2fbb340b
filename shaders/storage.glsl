// The arrays of a scene, the path state, and an invocation's place in it. Each array is a storage texel
// buffer, or, if ARRAYS_TOGETHER, one storage buffer holds all arrays but the samples, for devices with few
// bindings or small texel buffers (src/render/scene_buffers.h). The host removes the other variables from the
// kernel (src/gpu/specialize.h).
#ifndef GLINT_STORAGE_GLSL
#define GLINT_STORAGE_GLSL

#include "shared/dispatch.h"

layout(constant_id = GLINT_ARRAYS_TOGETHER) const bool ARRAYS_TOGETHER = false;

// Word `binding` of the buffer is the first row of that binding's array.
layout(set = 0, binding = 2, std430) readonly restrict buffer ArraysBlock { uvec4 arrays[]; };
layout(set = 0, binding = 3, std430) readonly restrict buffer SamplesBlock { uvec4 sampleRows[]; };
uvec4 loadTogether(uint array, uint index) {
    uvec4 row;
    if (array == kSamplesBinding)
        row = sampleRows[index];
    else
        row = arrays[arrays[array >> 2][array & 3u] + index];
    return row;
}

// The host binds at most 2^27 texels. The mask saves llvmpipe 8 of 44 instructions (sign extensions).
#define GLINT_READ_ARRAY(BINDING, name)                                                               \
    layout(set = 0, binding = BINDING, rgba32ui) readonly restrict uniform uimageBuffer name##Texels; \
    uvec4 name##Row(uint index) {                                                                     \
        uvec4 row;                                                                                    \
        if (ARRAYS_TOGETHER)                                                                          \
            row = loadTogether(uint(BINDING), index);                                                 \
        else                                                                                          \
            row = imageLoad(name##Texels, int(index & 0x07ffffffu));                                  \
        return row;                                                                                   \
    }

// ---- Structs from their row lists ----

#define GLINT_MEMBER_V3F(A, a, b) \
    vec3 a;                       \
    float b;
#define GLINT_MEMBER_V3U(A, a, b) \
    vec3 a;                       \
    uint b;
#define GLINT_MEMBER_U4(A, a, b, c, d) \
    uint a;                            \
    uint b;                            \
    uint c;                            \
    uint d;
#define GLINT_GLSL_STRUCT(binding, array, Name, ROWS)                \
    struct Name {                                                    \
        ROWS(GLINT_MEMBER_V3F, GLINT_MEMBER_V3U, GLINT_MEMBER_U4, 0) \
    };
GLINT_SCENE_ARRAYS(GLINT_GLSL_STRUCT)

// clang-format off
layout(push_constant) uniform DispatchBlock {
    GLINT_DISPATCH_ROWS(GLINT_MEMBER_V3F, GLINT_MEMBER_V3U, GLINT_MEMBER_U4, 0)
} dispatch;
// clang-format on

// ---- Loaders from the same lists ----

#define GLINT_COUNT_2(A, a, b) +1u
#define GLINT_COUNT_4(A, a, b, c, d) +1u
#define GLINT_LOAD_V3F(A, a, b)   \
    q = A##Row(row);              \
    s.a = uintBitsToFloat(q.xyz); \
    s.b = uintBitsToFloat(q.w);   \
    ++row;
#define GLINT_LOAD_V3U(A, a, b)   \
    q = A##Row(row);              \
    s.a = uintBitsToFloat(q.xyz); \
    s.b = q.w;                    \
    ++row;
#define GLINT_LOAD_U4(A, a1, b1, c1, d1) \
    q = A##Row(row);                     \
    s.a1 = q.x;                          \
    s.b1 = q.y;                          \
    s.c1 = q.z;                          \
    s.d1 = q.w;                          \
    ++row;
// The array `name`Array and Name loadName(uint index) from it.
#define GLINT_LOADER(BINDING, name, Name, ROWS)                                       \
    GLINT_READ_ARRAY(BINDING, name##Array)                                            \
    Name load##Name(uint index) {                                                     \
        Name s;                                                                       \
        uvec4 q;                                                                      \
        uint row = index * (0u ROWS(GLINT_COUNT_2, GLINT_COUNT_2, GLINT_COUNT_4, 0)); \
        ROWS(GLINT_LOAD_V3F, GLINT_LOAD_V3U, GLINT_LOAD_U4, name##Array)              \
        return s;                                                                     \
    }
GLINT_SCENE_ARRAYS(GLINT_LOADER)

// ---- Path state and counters ----

layout(set = 0, binding = 0, std430) restrict buffer CounterBlock { uint counters[kCounterCount]; };
layout(set = 0, binding = 1, rgba32ui) restrict uniform uimageBuffer pathTexels;
layout(set = 0, binding = 1, std430) restrict buffer PathBlock { uvec4 pathBlock[]; };

uvec4 loadPathRow(uint place) {
    uvec4 row;
    if (ARRAYS_TOGETHER)
        row = pathBlock[place];
    else
        row = imageLoad(pathTexels, int(place & 0x07ffffffu));
    return row;
}
void storePathRow(uint place, uvec4 value) {
    if (ARRAYS_TOGETHER)
        pathBlock[place] = value;
    else
        imageStore(pathTexels, int(place), value);
}
uvec4 loadRow(uint row, uint path) { return loadPathRow(row * dispatch.capacity + path); }
void storeRow(uint row, uint path, uvec4 value) { storePathRow(row * dispatch.capacity + path, value); }
uvec4 packRow(vec3 v, uint w) { return uvec4(floatBitsToUint(v), w); }

// ---- Specialization constants ----

#define GLINT_FEATURE_CONSTANT(ID, NAME, field) layout(constant_id = ID) const bool FEATURE_##NAME = true;
#define GLINT_MODE_CONSTANT(ID, NAME, field) layout(constant_id = ID) const bool MODE_##NAME = false;
#define GLINT_ARITHMETIC_CONSTANT(ID, NAME, field) layout(constant_id = ID) const bool NAME = false;
#define GLINT_CHOICE_CONSTANT(ID, NAME, field) layout(constant_id = ID) const uint NAME = 0u;
GLINT_FEATURES(GLINT_FEATURE_CONSTANT)
GLINT_MODES(GLINT_MODE_CONSTANT)
GLINT_CHOICES(GLINT_CHOICE_CONSTANT)
layout(constant_id = GLINT_CONVERGENT_ID) const bool CONVERGENT = false;
GLINT_ARITHMETIC(GLINT_ARITHMETIC_CONSTANT)

#include "arithmetic.glsl"

// ---- The path of an invocation: its pixel, and the rows of the path state ----

layout(local_size_x = kWorkgroupSize, local_size_y = 1, local_size_z = 1) in;

uint pathIndex() { return gl_GlobalInvocationID.x; }

// Scenes whose paths continue after the first hit: they list those paths.
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

// Hit instance, source instance, and where an unfinished traversal continues: see dispatch.h.
uint rowInstance() { return MODE_ADAPTIVE ? kPathRowsAdaptive : (MODE_AOVS ? kPathRowsWithAovs : kPathRows); }

// Entries of two lists of paths, one read and one written by a dispatch.
uint rowList(uint list) { return rowInstance() + (FEATURE_INSTANCES ? 1u : 0u) + list; }

// kTreeRow...: after the others.
uint treeRow(uint row) { return rowList(kBounces ? kListRows : 0u) + row; }

#endif
