// Number types beyond double, and vectors of any number type.
#pragma once

#include <glm/glm.hpp>
#include <limits>

namespace glint::reference {

// Quadruple precision where the compiler has it; long double elsewhere is still at least as good as double.
#ifdef __SIZEOF_FLOAT128__
__extension__ typedef __float128 Quad;
#else
using Quad = long double;
#endif
using Extended = long double;

// The relative error of a rounding in T.
template <class T>
inline constexpr double kRoundoff = static_cast<double>(std::numeric_limits<T>::epsilon() / 2);
#ifdef __SIZEOF_FLOAT128__
template <>
inline constexpr double kRoundoff<Quad> = 0x1p-113;
#endif
inline constexpr double kUnitRoundoff = kRoundoff<double>;

// std::abs has no overload for Quad.
template <class T>
T magnitude(T a) {
    return a < 0 ? -a : a;
}

// glm refuses __float128 (no std::numeric_limits in strict mode) and GMP's numbers.
template <class T>
struct Vec {
    T x, y, z;
};

template <class T>
Vec<T> toVec(const glm::dvec3& v) {
    return {static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z)};
}
template <class T>
Vec<T> toVec(const double (&v)[3]) {
    return {static_cast<T>(v[0]), static_cast<T>(v[1]), static_cast<T>(v[2])};
}
template <class T>
Vec<T> operator+(const Vec<T>& a, const Vec<T>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
Vec<T> operator-(const Vec<T>& a, const Vec<T>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
Vec<T> operator*(const T& s, const Vec<T>& a) {
    return {s * a.x, s * a.y, s * a.z};
}
template <class T>
T dot(const Vec<T>& a, const Vec<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
Vec<T> cross(const Vec<T>& a, const Vec<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
Vec<T> magnitudes(const Vec<T>& a) {
    return {magnitude(a.x), magnitude(a.y), magnitude(a.z)};
}
inline glm::dmat3 magnitudes(const glm::dmat3& m) {
    return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])};
}

}  // namespace glint::reference
