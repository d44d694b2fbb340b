// values[i] = twisted(values[i]). A workgroup for each, as lavapipe gives lanes that leave a loop before
// others what the others computed (docs/design/traversal.md).
#version 450
#extension GL_GOOGLE_include_directive : require
layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) buffer Values {
    uint values[];
};

#define GLINT_INOUT(T) inout T
#include "twists.h"

void main() {
    uint result = twisted(values[gl_WorkGroupID.x]);
    barrier();
    if (gl_LocalInvocationID.x == 0u) values[gl_WorkGroupID.x] = result;
}
