#version 450
// What the lint of lint_test.cpp must find, each behind a constant of its own; without any of them a sum that
// carries no mark.
layout(local_size_x = 1, local_size_y = 1, local_size_z = 1) in;
layout(constant_id = 0) const bool DIVIDES = false;
layout(constant_id = 1) const bool SQUARE_ROOT = false;
layout(constant_id = 2) const bool POWER = false;
layout(constant_id = 3) const bool EXPONENTIAL = false;
layout(constant_id = 4) const bool LOGARITHM = false;
layout(constant_id = 5) const bool SINE = false;
layout(constant_id = 6) const bool DOT = false;
layout(constant_id = 7) const bool MIX = false;
layout(constant_id = 8) const bool FUSED = false;
layout(constant_id = 9) const bool REMAINDER = false;
layout(constant_id = 10) const bool LENGTH = false;
layout(constant_id = 11) const bool UNIT = false;
layout(constant_id = 12) const bool INVERSE_ROOT = false;
layout(constant_id = 13) const bool MATRIX = false;
layout(constant_id = 14) const bool CROSS = false;
layout(set = 0, binding = 0, std430) buffer Values {
    vec4 values[];
};

void main() {
    vec4 v = values[0];
    vec4 w = values[1];
    if (DIVIDES) v.x = v.x / w.x;
    if (SQUARE_ROOT) v.x = sqrt(w.x);
    if (POWER) v.x = pow(v.x, w.x);
    if (EXPONENTIAL) v.x = exp(v.x);
    if (LOGARITHM) v.x = log2(v.x);
    if (SINE) v.x = sin(v.x);
    if (DOT) v.x = dot(v, w);
    if (MIX) v = mix(v, w, 0.25);
    if (FUSED) v = fma(v, w, v);
    if (REMAINDER) v = mod(v, w);
    if (LENGTH) v.x = length(v);
    if (UNIT) v = normalize(v);
    if (INVERSE_ROOT) v.x = inversesqrt(v.x);
    if (MATRIX) v = mat4(v, w, v, w) * v;
    if (CROSS) v.xyz = cross(v.xyz, w.xyz);
    values[0] = floor(abs(min(v + w, 2.0)));
}
