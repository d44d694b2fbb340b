#version 450
#extension GL_GOOGLE_include_directive : require
// Never run: declares every shared struct as an array in a std430 buffer, for layout_test to read the offsets
// from the SPIR-V.
#include "storage.glsl"

layout(local_size_x = 1, local_size_y = 1, local_size_z = 1) in;

#define GLINT_PROBE(binding_, array, Name, ROWS)              \
    layout(set = 1, binding = 0, std430) buffer Name##Probe { \
        Name items[];                                         \
    }                                                         \
    probe##Name;
GLINT_SCENE_ARRAYS(GLINT_PROBE)

void main() {
#define GLINT_TOUCH(binding_, array, Name, ROWS) probe##Name.items[1] = probe##Name.items[0];
    GLINT_SCENE_ARRAYS(GLINT_TOUCH)
    counters[0] = dispatch.firstTile;
}
