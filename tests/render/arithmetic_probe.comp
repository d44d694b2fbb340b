#version 450
#extension GL_GOOGLE_include_directive : require
// What shaders/arithmetic.glsl makes of operands that the host has chosen.
layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;
layout(constant_id = 0) const bool OWN_QUOTIENTS = false;
layout(constant_id = 1) const bool OWN_ROOTS = false;
// GLSL's own powers, for comparison.
layout(constant_id = 2) const bool BUILT_IN = false;
#include "arithmetic.glsl"

// a, b, c, 0 before; a / b, sqrt(c), pow(|a|, |b|), 0 and exp(-|a|), log(|a|), log2(|a|), exp2(-|a|) after.
layout(set = 0, binding = 0, std430) restrict buffer Cases {
    uvec4 rows[];
};

void main() {
    uint row = 2u * gl_GlobalInvocationID.x;
    vec3 given = uintBitsToFloat(rows[row].xyz);
    float a = abs(given.x);
    float b = abs(given.y);
    vec4 powers = BUILT_IN ? vec4(exp(-a), log(a), log2(a), exp2(-a))
                           : vec4(exponential(-a), logarithm(a), binaryLogarithm(a), binaryExponential(-a));
    float power = BUILT_IN ? pow(min(a, 1.0), b) : powerOf(min(a, 1.0), b);
    rows[row] = floatBitsToUint(vec4(quotient(given.x, given.y), squareRoot(given.z), power, 0.0));
    rows[row + 1u] = floatBitsToUint(powers);
}
