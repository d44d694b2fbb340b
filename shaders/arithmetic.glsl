// Arithmetic with the same bits on every device. Vulkan rounds only `+`, `-`, `*`, conversions and integers
// correctly: a quotient may be off by 2.5 ulp, pow and exp by thousands, and dot may sum in any order
// (docs/design/numerics.md 1). Everything else is made of those here, which tests/render/lint_test.cpp
// checks. Sums and products need no further `precise`: glint marks them all (src/gpu/specialize.h).
#ifndef GLINT_ARITHMETIC_GLSL
#define GLINT_ARITHMETIC_GLSL

// ---- Quotients and square roots, correctly rounded ----

// Devices that do not round correctly by themselves (src/gpu/probe.cpp) use integers: a quotient of 25 bits,
// good to a few units by Newton's method, corrected by its remainder, which is exact modulo 2^32. Without
// branches, as SwiftShader's compiler would take minutes.

// A positive float is significand * 2^(exponent - 150), with 24 bits.
uint significandOf(uint bits, out int exponent) {
    bool tiny = bits < 0x00800000u;
    int missing = tiny ? 23 - findMSB(bits | 1u) : 0;
    exponent = tiny ? 1 - missing : int(bits >> 23);
    return tiny ? bits << missing : (bits & 0x007fffffu) | 0x00800000u;
}

float roundedQuotient(float dividend, float divisor) {
    const uint kInfinite = 0x7f800000u;
    uint a = floatBitsToUint(dividend) & 0x7fffffffu;
    uint b = floatBitsToUint(divisor) & 0x7fffffffu;
    uint sign = (floatBitsToUint(dividend) ^ floatBitsToUint(divisor)) & 0x80000000u;
    int exponentA, exponentB;
    uint n = significandOf(a, exponentA);
    uint d = significandOf(b, exponentB);
    uint doubled = n < d ? 1u : 0u;
    n <<= doubled;
    int exponent = exponentA - exponentB + 127 - int(doubled);
    // 1 / (d / 2^23), first within 12 %: the significand approximates its logarithm. Three steps leave 2^-22.
    float unit = uintBitsToFloat(0x3f800000u | (d & 0x007fffffu));
    float inverse = uintBitsToFloat(0x7ef311c7u - floatBitsToUint(unit));
    inverse = inverse * (2.0 - unit * inverse);
    inverse = inverse * (2.0 - unit * inverse);
    inverse = inverse * (2.0 - unit * inverse);
    // n / d in units of 2^-24, in [2^24, 2^25), off by a few; then by one at most.
    uint q = uint(float(n) * inverse * 2.0);
    int rest = int((n << 24) - q * d);
    int off = int(floor(float(rest) * inverse * 1.1920929e-7));
    rest -= off * int(d);
    int last = rest < 0 ? -1 : (rest >= int(d) ? 1 : 0);
    rest -= last * int(d);
    q += uint(off + last);
    // To 24 bits, or fewer for a denormal; ties to even.
    int dropped = clamp(2 - exponent, 1, 26);
    uint kept = q >> dropped;
    uint below = q << (32 - dropped);
    uint odd = rest != 0 ? 1u : kept & 1u;
    uint up = below > 0x80000000u - odd ? 1u : 0u;
    uint bits = (uint(max(exponent, 1) - 1) << 23) + kept + up;
    bits = exponent > 254 ? kInfinite : min(bits, kInfinite);
    bits = a == 0u || b == kInfinite ? 0u : (b == 0u || a == kInfinite ? kInfinite : bits);
    bool none = max(a, b) > kInfinite || (a == b && (a == 0u || a == kInfinite));
    return uintBitsToFloat(none ? 0x7fc00000u : bits | sign);
}

float roundedRoot(float square) {
    uint bits = floatBitsToUint(square);
    int exponent;
    uint n = significandOf(bits & 0x7fffffffu, exponent);
    uint odd = ~uint(exponent) & 1u;  // the exponent without its bias, 127, is
    n <<= odd;
    // n / 2^23, in [1, 4), and 1 over its root, first within 4 %, then 2^-22.
    float unit = float(n) * 1.1920929e-7;
    float inverse = uintBitsToFloat(0x5f375a86u - (floatBitsToUint(unit) >> 1));
    inverse = inverse * (1.5 - 0.5 * unit * inverse * inverse);
    inverse = inverse * (1.5 - 0.5 * unit * inverse * inverse);
    inverse = inverse * (1.5 - 0.5 * unit * inverse * inverse);
    // In units of 2^-24, in [2^24, 2^25); (root + off)^2 = root^2 + off (2 root + off).
    uint root = uint(unit * inverse * 16777216.0);
    int rest = int((n << 25) - root * root);
    int off = int(floor(float(rest) * (0.5 * inverse) * 5.9604645e-8));
    rest -= off * int(2u * root + uint(off));
    root += uint(off);
    root += uint(rest < 0 ? -1 : (rest > int(2u * root) ? 1 : 0));
    // No root of 24 bits lies in the middle between two floats: its square would have 49.
    uint result = (uint((exponent - 127 - int(odd)) / 2 + 126) << 23) + (root >> 1) + (root & 1u);
    bool itself = (bits & 0x7fffffffu) == 0u || bits == 0x7f800000u;
    return uintBitsToFloat(itself ? bits : (bits > 0x7f800000u ? 0x7fc00000u : result));
}

float quotient(float a, float b) {
    if (OWN_QUOTIENTS) return roundedQuotient(a, b);
    return a / b;
}
vec3 quotient(vec3 a, float b) { return vec3(quotient(a.x, b), quotient(a.y, b), quotient(a.z, b)); }
vec3 quotient(float a, vec3 b) { return vec3(quotient(a, b.x), quotient(a, b.y), quotient(a, b.z)); }
vec3 quotient(vec3 a, vec3 b) { return vec3(quotient(a.x, b.x), quotient(a.y, b.y), quotient(a.z, b.z)); }

float squareRoot(float x) {
    if (OWN_ROOTS) return roundedRoot(x);
    return sqrt(x);
}

// ---- Vectors ----

// glslang 12 refuses to redeclare GLSL's own functions.
float ownDot(vec2 a, vec2 b) { return a.x * b.x + a.y * b.y; }
float ownDot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
float ownLength(vec3 v) { return squareRoot(ownDot(v, v)); }
vec3 ownCross(vec3 a, vec3 b) {
    return vec3(a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y);
}
#define dot ownDot
#define length ownLength
#define cross ownCross

// ---- Powers: polynomials of S. L. Moshier's Cephes library (single/logf.c, log2f.c, expf.c, exp2f.c;
// netlib.org/cephes). Errors measured: docs/design/numerics.md 1.1. ----

// A normal x > 0 is m 2^n with m in [sqrt(1/2), sqrt(2)). Returns m - 1, which is exact.
float splitPower(float x, out float n) {
    uint bits = floatBitsToUint(x);
    int whole = int(bits - 0x3f3504f3u) >> 23;
    n = float(whole);
    return uintBitsToFloat(bits - (uint(whole) << 23)) - 1.0;
}

float logarithmSeries(float f) {
    float sum = 7.0376836292e-2;
    sum = sum * f - 1.1514610310e-1;
    sum = sum * f + 1.1676998740e-1;
    sum = sum * f - 1.2420140846e-1;
    sum = sum * f + 1.4249322787e-1;
    sum = sum * f - 1.6668057665e-1;
    sum = sum * f + 2.0000714765e-1;
    sum = sum * f - 2.4999993993e-1;
    sum = sum * f + 3.3333331174e-1;
    return f * (f * f * sum);
}

// Natural logarithm, within 1 ulp, of x clamped to the least normal float, whose exponential() is 0.
float logarithm(float x) {
    float n;
    float f = splitPower(max(x, 1.17549435e-38), n);
    // log(2) = 0.693359375, whose products with n are exact, less 2.1219444e-4.
    float rest = logarithmSeries(f) + n * -2.12194440e-4 - 0.5 * (f * f);
    return (f + rest) + n * 0.693359375;
}
vec3 logarithm(vec3 x) { return vec3(logarithm(x.x), logarithm(x.y), logarithm(x.z)); }

// Binary logarithm of a normal x > 0, within 1.5 ulp. 0.44269504 is log2(e) - 1.
float binaryLogarithm(float x) {
    float n;
    float f = splitPower(x, n);
    float rest = logarithmSeries(f) - 0.5 * (f * f);
    return (((rest * 0.44269504 + f * 0.44269504) + rest) + f) + n;
}

// x 2^n for x in [1/2, 2) and an integer n; 0 if the result might be denormal, which devices may flush.
float scaledBy(float x, float n) {
    return n < -125.0 ? 0.0 : uintBitsToFloat(floatBitsToUint(x) + (uint(int(n)) << 23));
}

// Within 1 ulp, for x clamped to +-88.
float exponential(float x) {
    float within = clamp(x, -88.0, 88.0);
    float n = floor(within * 1.44269504 + 0.5);
    float r = (within - n * 0.693359375) - n * -2.12194440e-4;
    float sum = 1.9875691500e-4;
    sum = sum * r + 1.3981999507e-3;
    sum = sum * r + 8.3334519073e-3;
    sum = sum * r + 4.1665795894e-2;
    sum = sum * r + 1.6666665459e-1;
    sum = sum * r + 5.0000001201e-1;
    return scaledBy((sum * (r * r) + r) + 1.0, n);
}
vec3 exponential(vec3 x) { return vec3(exponential(x.x), exponential(x.y), exponential(x.z)); }

// Within 1.2 ulp, for x clamped to [-126, 127].
float binaryExponential(float x) {
    float within = clamp(x, -126.0, 127.0);
    float n = floor(within + 0.5);
    float r = within - n;
    float sum = 1.535336188e-4;
    sum = sum * r + 1.339887440e-3;
    sum = sum * r + 9.618437358e-3;
    sum = sum * r + 5.550332471e-2;
    sum = sum * r + 2.402264791e-1;
    sum = sum * r + 6.931472029e-1;
    return scaledBy(sum * r + 1.0, n);
}

// For x in [0, 1] and y > 0. The relative error is at most 2e-6 for results down to 1e-6, and grows with
// their logarithm.
float powerOf(float x, float y) {
    return x < 1.17549435e-38 ? 0.0 : binaryExponential(y * binaryLogarithm(x));
}

#endif
