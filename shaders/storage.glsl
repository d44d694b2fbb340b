// Access to the arrays of a scene and to the path state. GLINT_TEXEL_LOADS reads them as storage texel
// buffers, which cost a fifth of a storage buffer's load on lavapipe; everywhere else they are storage
// buffers.
#ifndef GLINT_STORAGE_GLSL
#define GLINT_STORAGE_GLSL

#include "shared/dispatch.h"

#ifdef GLINT_TEXEL_LOADS
#define GLINT_READ_ARRAY(BINDING, name) \
    layout(set = 0, binding = BINDING, rgba32ui) readonly restrict uniform uimageBuffer name;
#define GLINT_READ_WRITE_ARRAY(BINDING, name) \
    layout(set = 0, binding = BINDING, rgba32ui) restrict uniform uimageBuffer name;
#define LOAD4(name, index) imageLoad(name, int(index))
#define STORE4(name, index, value) imageStore(name, int(index), value)
#else
#define GLINT_READ_ARRAY(BINDING, name) \
    layout(set = 0, binding = BINDING, std430) readonly restrict buffer name##_block { uvec4 name[]; };
#define GLINT_READ_WRITE_ARRAY(BINDING, name) \
    layout(set = 0, binding = BINDING, std430) restrict buffer name##_block { uvec4 name[]; };
#define LOAD4(name, index) name[index]
#define STORE4(name, index, value) name[index] = value
#endif

// ---- Structs from their row lists ----

#define GLINT_MEMBER_V3F(a, b) \
    vec3 a;                    \
    float b;
#define GLINT_MEMBER_V3U(a, b) \
    vec3 a;                    \
    uint b;
#define GLINT_MEMBER_U4(a, b, c, d) \
    uint a;                         \
    uint b;                         \
    uint c;                         \
    uint d;
#define GLINT_GLSL_STRUCT(Name, ROWS)                             \
    struct Name {                                                 \
        ROWS(GLINT_MEMBER_V3F, GLINT_MEMBER_V3U, GLINT_MEMBER_U4) \
    };
GLINT_STRUCTS(GLINT_GLSL_STRUCT)

// clang-format off
layout(push_constant) uniform DispatchBlock {
    GLINT_DISPATCH_ROWS(GLINT_MEMBER_V3F, GLINT_MEMBER_V3U, GLINT_MEMBER_U4)
} dispatch;
// clang-format on

// ---- Loaders from the same lists ----

#define GLINT_COUNT_2(a, b) +1u
#define GLINT_COUNT_4(a, b, c, d) +1u
#define GLINT_LOAD_V3F(a, b)          \
    q = LOAD4(GLINT_ARRAY_NAME, row); \
    s.a = uintBitsToFloat(q.xyz);     \
    s.b = uintBitsToFloat(q.w);       \
    ++row;
#define GLINT_LOAD_V3U(a, b)          \
    q = LOAD4(GLINT_ARRAY_NAME, row); \
    s.a = uintBitsToFloat(q.xyz);     \
    s.b = q.w;                        \
    ++row;
#define GLINT_LOAD_U4(a1, b1, c1, d1) \
    q = LOAD4(GLINT_ARRAY_NAME, row); \
    s.a1 = q.x;                       \
    s.b1 = q.y;                       \
    s.c1 = q.z;                       \
    s.d1 = q.w;                       \
    ++row;
// Name loadName(uint index) from the array that GLINT_ARRAY_NAME stands for where this is used.
#define GLINT_LOADER(Name, ROWS)                                                   \
    Name load##Name(uint index) {                                                  \
        Name s;                                                                    \
        uvec4 q;                                                                   \
        uint row = index * (0u ROWS(GLINT_COUNT_2, GLINT_COUNT_2, GLINT_COUNT_4)); \
        ROWS(GLINT_LOAD_V3F, GLINT_LOAD_V3U, GLINT_LOAD_U4)                        \
        return s;                                                                  \
    }

GLINT_READ_ARRAY(2, nodesArray)
#define GLINT_ARRAY_NAME nodesArray
GLINT_LOADER(Node, GLINT_NODE_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(3, trianglesArray)
#define GLINT_ARRAY_NAME trianglesArray
GLINT_LOADER(Triangle, GLINT_TRIANGLE_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(4, triangleSurfacesArray)
#define GLINT_ARRAY_NAME triangleSurfacesArray
GLINT_LOADER(TriangleSurface, GLINT_TRIANGLE_SURFACE_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(5, vertexNormalsArray)
#define GLINT_ARRAY_NAME vertexNormalsArray
GLINT_LOADER(VertexNormals, GLINT_VERTEX_NORMALS_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(6, spheresArray)
#define GLINT_ARRAY_NAME spheresArray
GLINT_LOADER(Sphere, GLINT_SPHERE_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(7, planesArray)
#define GLINT_ARRAY_NAME planesArray
GLINT_LOADER(Plane, GLINT_PLANE_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(8, materialsArray)
#define GLINT_ARRAY_NAME materialsArray
GLINT_LOADER(Material, GLINT_MATERIAL_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(9, lightsArray)
#define GLINT_ARRAY_NAME lightsArray
GLINT_LOADER(Light, GLINT_LIGHT_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(10, environmentArray)
#define GLINT_ARRAY_NAME environmentArray
GLINT_LOADER(Environment, GLINT_ENVIRONMENT_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(11, cameraArray)
#define GLINT_ARRAY_NAME cameraArray
GLINT_LOADER(Camera, GLINT_CAMERA_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(12, discsArray)
#define GLINT_ARRAY_NAME discsArray
GLINT_LOADER(Disc, GLINT_DISC_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(13, polygonsArray)
#define GLINT_ARRAY_NAME polygonsArray
GLINT_LOADER(Polygon, GLINT_POLYGON_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(14, polygonVerticesArray)
#define GLINT_ARRAY_NAME polygonVerticesArray
GLINT_LOADER(PolygonVertex, GLINT_POLYGON_VERTEX_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(15, quadricsArray)
#define GLINT_ARRAY_NAME quadricsArray
GLINT_LOADER(Quadric, GLINT_QUADRIC_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(16, instancesArray)
#define GLINT_ARRAY_NAME instancesArray
GLINT_LOADER(Instance, GLINT_INSTANCE_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(23, opticsArray)
#define GLINT_ARRAY_NAME opticsArray
GLINT_LOADER(Optics, GLINT_OPTICS_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(18, texturesArray)
#define GLINT_ARRAY_NAME texturesArray
GLINT_LOADER(Texture, GLINT_TEXTURE_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(19, texelsArray)
#define GLINT_ARRAY_NAME texelsArray
GLINT_LOADER(Texel, GLINT_TEXEL_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(20, vertexAttributesArray)
#define GLINT_ARRAY_NAME vertexAttributesArray
GLINT_LOADER(VertexAttribute, GLINT_VERTEX_ATTRIBUTE_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(21, objectFramesArray)
#define GLINT_ARRAY_NAME objectFramesArray
GLINT_LOADER(ObjectFrame, GLINT_OBJECT_FRAME_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(22, samplesArray)
#define GLINT_ARRAY_NAME samplesArray
GLINT_LOADER(Sample, GLINT_SAMPLE_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(17, packetCornersArray)
#define GLINT_ARRAY_NAME packetCornersArray
GLINT_LOADER(PacketCorner, GLINT_PACKET_CORNER_ROWS)
#undef GLINT_ARRAY_NAME

GLINT_READ_ARRAY(24, wideRowsArray)
#define GLINT_ARRAY_NAME wideRowsArray
GLINT_LOADER(WideRow, GLINT_WIDE_ROW_ROWS)
#undef GLINT_ARRAY_NAME

// ---- Path state and counters ----

layout(set = 0, binding = 0, std430) restrict buffer CounterBlock { uint counters[kCounterCount]; };
GLINT_READ_WRITE_ARRAY(1, pathRows)

uvec4 loadRow(uint row, uint path) { return LOAD4(pathRows, row * dispatch.capacity + path); }
void storeRow(uint row, uint path, uvec4 value) { STORE4(pathRows, row * dispatch.capacity + path, value); }
uvec4 packRow(vec3 v, uint w) { return uvec4(floatBitsToUint(v), w); }

// ---- Specialization constants ----

#define GLINT_FEATURE_CONSTANT(ID, NAME, field) layout(constant_id = ID) const bool FEATURE_##NAME = true;
#define GLINT_MODE_CONSTANT(ID, NAME, field) layout(constant_id = ID) const bool MODE_##NAME = false;
#define GLINT_CHOICE_CONSTANT(ID, NAME, field) layout(constant_id = ID) const uint NAME = 0u;
GLINT_FEATURES(GLINT_FEATURE_CONSTANT)
GLINT_MODES(GLINT_MODE_CONSTANT)
GLINT_CHOICES(GLINT_CHOICE_CONSTANT)
GLINT_LANE_WALK(GLINT_CHOICE_CONSTANT)

#endif
