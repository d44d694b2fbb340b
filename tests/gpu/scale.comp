// values[i] = values[i] * FACTOR + addend for i < count, in every component; values are 32-bit and wrap.
#version 450
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint FACTOR = 1u;
layout(constant_id = 1) const bool ADDS = false;

layout(push_constant) uniform Push {
    uint count;
    uint addend;
}
push;

#ifdef GLINT_TEXEL_LOADS
layout(set = 0, binding = 0, rgba32ui) uniform uimageBuffer values;
uvec4 load(uint i) {
    return imageLoad(values, int(i));
}
void store(uint i, uvec4 value) {
    imageStore(values, int(i), value);
}
#else
layout(set = 0, binding = 0, std430) buffer Values {
    uvec4 values[];
};
uvec4 load(uint i) {
    return values[i];
}
void store(uint i, uvec4 value) {
    values[i] = value;
}
#endif

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= push.count) return;
    uvec4 value = load(i) * FACTOR;
    if (ADDS) value += uvec4(push.addend);
    store(i, value);
}
