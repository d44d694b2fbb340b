// destination[i] = source[count - 1 - i]: each invocation reads what another one wrote.
#version 450
layout(local_size_x = 64) in;

layout(push_constant) uniform Push {
    uint count;
}
push;

layout(set = 0, binding = 0, rgba32ui) uniform readonly uimageBuffer source;
layout(set = 0, binding = 1, std430) writeonly buffer Destination {
    uvec4 destination[];
};

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < push.count) destination[i] = imageLoad(source, int(push.count - 1u - i));
}
