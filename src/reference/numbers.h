// Number types beyond double, vectors of any number type, sums with their rounding error, and random numbers.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <type_traits>

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
    if constexpr (std::is_floating_point_v<T>)
        return std::abs(a);
    else
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

// A polynomial, with the sum of the magnitudes of its monomials. If no monomial passes more than n roundings,
// the value errs by at most gamma_n of that sum (Higham 2002, sec. 3.1).
template <class T>
struct Sum {
    T value{}, terms{};

    Sum() = default;
    Sum(T number) : value(number), terms(magnitude(number)) {}
    T bound(double roundings) const { return static_cast<T>(roundings * kRoundoff<T>) * terms; }
    // 0 if so many roundings leave the sign open.
    int sign(double roundings) const {
        return value > bound(roundings) ? 1 : value < -bound(roundings) ? -1 : 0;
    }
    friend Sum operator+(const Sum& a, const Sum& b) { return {a.value + b.value, a.terms + b.terms}; }
    friend Sum operator-(const Sum& a, const Sum& b) { return {a.value - b.value, a.terms + b.terms}; }
    friend Sum operator*(const Sum& a, const Sum& b) { return {a.value * b.value, a.terms * b.terms}; }

  private:
    Sum(T v, T t) : value(v), terms(t) {}
};

// Differences and other numbers that are to count as one monomial each.
template <class T>
Vec<Sum<T>> sums(const Vec<T>& v) {
    return {v.x, v.y, v.z};
}
// a.b, its three products as monomials.
template <class T>
Sum<T> sumOfProducts(const Vec<T>& a, const Vec<T>& b) {
    return Sum<T>(a.x * b.x) + Sum<T>(a.y * b.y) + Sum<T>(a.z * b.z);
}

// The symmetric matrix with these elements on the diagonal, and off it: yz, zx, xy.
inline glm::dmat3 symmetric(const glm::dvec3& squares, const glm::dvec3& products) {
    return {squares.x,  products.z, products.y, products.z, squares.y,
            products.x, products.y, products.x, squares.z};
}

// splitmix64: G. Steele, D. Lea, C. Flood, "Fast Splittable Pseudorandom Number Generators", OOPSLA 2014.
inline constexpr uint64_t kUniformStride = 0x9e3779b97f4a7c15u;
inline uint64_t randomWord(uint64_t& state) {
    state += kUniformStride;
    uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}
// In [-1, 1).
inline double uniform(uint64_t& state) {
    return static_cast<double>(randomWord(state) >> 11) * 0x1p-52 - 1;
}

}  // namespace glint::reference
