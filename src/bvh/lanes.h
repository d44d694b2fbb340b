// Four floats at once: boxes are 16-byte rows here, so that one minimum or maximum treats a whole corner.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#if defined(__SSE2__)
#include <emmintrin.h>
#else
#include <cstring>
#endif

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

}  // namespace glint
