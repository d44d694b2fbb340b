// Four floats at once: boxes are 16-byte rows here, so that one minimum or maximum treats a whole corner.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

#if defined(__SSE2__)
#include <emmintrin.h>
#else
#include <cstring>
#endif

#include "bvh/bvh.h"

namespace glint {

#if defined(__SSE2__)

struct Lanes {
    __m128 v;

    static Lanes all(float x) { return {_mm_set1_ps(x)}; }
    static Lanes load(const float* aligned) { return {_mm_load_ps(aligned)}; }
    static Lanes of(float x, float y, float z) { return {_mm_setr_ps(x, y, z, 0.0f)}; }
    void store(float* aligned) const { _mm_store_ps(aligned, v); }
    // Rounds towards zero.
    void storeInts(int32_t* aligned) const {
        _mm_store_si128(reinterpret_cast<__m128i*>(aligned), _mm_cvttps_epi32(v));
    }
    static __m128 mask() { return _mm_castsi128_ps(_mm_setr_epi32(-1, -1, -1, 0)); }
    Lanes withoutW() const { return {_mm_and_ps(v, mask())}; }
    Lanes withWOf(Lanes other) const {
        return {_mm_or_ps(_mm_and_ps(v, mask()), _mm_andnot_ps(mask(), other.v))};
    }
};
inline Lanes min(Lanes a, Lanes b) {
    return {_mm_min_ps(a.v, b.v)};
}
inline Lanes max(Lanes a, Lanes b) {
    return {_mm_max_ps(a.v, b.v)};
}
inline Lanes operator+(Lanes a, Lanes b) {
    return {_mm_add_ps(a.v, b.v)};
}
inline Lanes operator-(Lanes a, Lanes b) {
    return {_mm_sub_ps(a.v, b.v)};
}
inline Lanes operator*(Lanes a, Lanes b) {
    return {_mm_mul_ps(a.v, b.v)};
}

#else

struct alignas(16) Lanes {
    float v[4];

    static Lanes all(float x) { return {{x, x, x, x}}; }
    // Bytes: the fourth word may be of another type.
    static Lanes load(const float* p) {
        Lanes a;
        std::memcpy(a.v, p, sizeof(a.v));
        return a;
    }
    static Lanes of(float x, float y, float z) { return {{x, y, z, 0.0f}}; }
    void store(float* p) const { std::memcpy(p, v, sizeof(v)); }
    void storeInts(int32_t* p) const {
        for (int i = 0; i < 4; ++i) p[i] = static_cast<int32_t>(v[i]);
    }
    Lanes withoutW() const { return {{v[0], v[1], v[2], 0.0f}}; }
    Lanes withWOf(Lanes other) const { return {{v[0], v[1], v[2], other.v[3]}}; }
};
template <class F>
Lanes lanewise(Lanes a, Lanes b, F f) {
    return {{f(a.v[0], b.v[0]), f(a.v[1], b.v[1]), f(a.v[2], b.v[2]), f(a.v[3], b.v[3])}};
}
inline Lanes min(Lanes a, Lanes b) {
    return lanewise(a, b, [](float x, float y) { return x < y ? x : y; });
}
inline Lanes max(Lanes a, Lanes b) {
    return lanewise(a, b, [](float x, float y) { return x > y ? x : y; });
}
inline Lanes operator+(Lanes a, Lanes b) {
    return lanewise(a, b, [](float x, float y) { return x + y; });
}
inline Lanes operator-(Lanes a, Lanes b) {
    return lanewise(a, b, [](float x, float y) { return x - y; });
}
inline Lanes operator*(Lanes a, Lanes b) {
    return lanewise(a, b, [](float x, float y) { return x * y; });
}

#endif

inline glm::vec3 toVec3(Lanes a) {
    alignas(16) float f[4];
    a.store(f);
    return {f[0], f[1], f[2]};
}

// A box in two registers, not empty unless it is the default. Words that are stored one by one and then
// copied two at a time make the processor wait, which a box that is read right after it was written would do
// at every node.
struct LaneBox {
    Lanes lo = Lanes::all(std::numeric_limits<float>::max());
    Lanes hi = Lanes::all(-std::numeric_limits<float>::max());

    static LaneBox of(const Box& box) {
        return {Lanes::of(box.lo.x, box.lo.y, box.lo.z), Lanes::of(box.hi.x, box.hi.y, box.hi.z)};
    }
    void include(Lanes a, Lanes b) {
        lo = min(lo, a);
        hi = max(hi, b);
    }
    void include(const LaneBox& b) { include(b.lo, b.hi); }
    Box box() const { return {toVec3(lo), toVec3(hi)}; }
    // Half the surface area of a non-empty box. Infinite or NaN beyond 1e38, which no comparison below
    // prefers.
    double halfArea() const {
        alignas(16) float d[4];
        (hi - lo).store(d);
        const double x = d[0], y = d[1], z = d[2];
        return x * y + (x + y) * z;
    }
};

}  // namespace glint
