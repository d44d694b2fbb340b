#version 450
#extension GL_GOOGLE_include_directive : require
// Writes the words of element 1 of every array of the scene, as the loaders see them, then those of the push
// constants.
#include "storage.glsl"

layout(local_size_x = 1, local_size_y = 1, local_size_z = 1) in;

layout(set = 0, binding = GLINT_BINDING_COUNT, std430) writeonly buffer WordsBlock {
    uint words[];
};

uint next = 0u;

void put(uint word) {
    words[next] = word;
    ++next;
}
void put(vec3 v) {
    put(floatBitsToUint(v.x));
    put(floatBitsToUint(v.y));
    put(floatBitsToUint(v.z));
}

#define GLINT_PUT_V3F(A, a, b) \
    put(s.a);                  \
    put(floatBitsToUint(s.b));
#define GLINT_PUT_V3U(A, a, b) \
    put(s.a);                  \
    put(s.b);
#define GLINT_PUT_U4(A, a1, b1, c1, d1) \
    put(s.a1);                          \
    put(s.b1);                          \
    put(s.c1);                          \
    put(s.d1);
#define GLINT_PUT_STRUCT(binding, array, Name, ROWS)        \
    {                                                       \
        Name s = load##Name(1u);                            \
        ROWS(GLINT_PUT_V3F, GLINT_PUT_V3U, GLINT_PUT_U4, 0) \
    }

void main() {
    GLINT_SCENE_ARRAYS(GLINT_PUT_STRUCT)
#define s dispatch
    GLINT_DISPATCH_ROWS(GLINT_PUT_V3F, GLINT_PUT_V3U, GLINT_PUT_U4, 0)
}
