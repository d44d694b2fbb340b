// Four floats at once: boxes are 16-byte rows here, so that one minimum or maximum treats a whole corner.
#pragma once

#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>
#include <limits>

#include "bvh/bvh.h"

namespace glint {

// By the vector extension of GCC and Clang, which has the same results on every processor.
struct Lanes {
    typedef float Floats __attribute__((vector_size(16)));
    typedef int32_t Ints __attribute__((vector_size(16)));
    Floats v;

    static Lanes all(float x) { return {Floats{x, x, x, x}}; }
    static Lanes of(float x, float y, float z) { return {Floats{x, y, z, 0.0f}}; }
    // Bytes: the fourth word may be of another type.
    static Lanes load(const float* p) {
        Lanes a;
        std::memcpy(&a.v, p, sizeof(a.v));
        return a;
    }
    void store(float* p) const { std::memcpy(p, &v, sizeof(v)); }
    // Rounds towards zero.
    void storeInts(int32_t* p) const {
        const Ints ints = __builtin_convertvector(v, Ints);
        std::memcpy(p, &ints, sizeof(ints));
    }
    Lanes withoutW() const { return {Floats{v[0], v[1], v[2], 0.0f}}; }
    Lanes withWOf(Lanes other) const { return {Floats{v[0], v[1], v[2], other.v[3]}}; }
};
inline Lanes min(Lanes a, Lanes b) {
    return {a.v < b.v ? a.v : b.v};
}
inline Lanes max(Lanes a, Lanes b) {
    return {a.v > b.v ? a.v : b.v};
}
inline Lanes operator+(Lanes a, Lanes b) {
    return {a.v + b.v};
}
inline Lanes operator-(Lanes a, Lanes b) {
    return {a.v - b.v};
}
inline Lanes operator*(Lanes a, Lanes b) {
    return {a.v * b.v};
}

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
