#version 450
// Results of the device's own arithmetic for operands that the host has chosen; see src/gpu/probe.cpp.
layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

// Three rows per case: a, b, c, 0, which the host writes; a + b, a * b, a * b + c, 0; a / b, sqrt(|c|), 0, 0.
layout(set = 0, binding = 0, std430) restrict buffer Cases { uvec4 rows[]; };

void main() {
    uint row = 3u * gl_GlobalInvocationID.x;
    vec3 given = uintBitsToFloat(rows[row].xyz);
    precise float sum = given.x + given.y;
    precise float product = given.x * given.y;
    precise float both = given.x * given.y + given.z;
    rows[row + 1u] = uvec4(floatBitsToUint(sum), floatBitsToUint(product), floatBitsToUint(both), 0u);
    rows[row + 2u] = uvec4(floatBitsToUint(given.x / given.y), floatBitsToUint(sqrt(abs(given.z))), 0u, 0u);
}
