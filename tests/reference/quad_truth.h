// Answers in quadruple precision, by other formulas than those of src/reference.
#pragma once

#include <cmath>
#include <optional>

#include "reference/tracer.h"

namespace glint::reference::test {

__extension__ typedef __float128 Quad;

struct QuadVec {
    Quad x, y, z;
    QuadVec(Quad a, Quad b, Quad c) : x(a), y(b), z(c) {}
    explicit QuadVec(const glm::dvec3& v) : x(v.x), y(v.y), z(v.z) {}
    QuadVec operator-(const QuadVec& b) const { return {x - b.x, y - b.y, z - b.z}; }
    QuadVec operator*(Quad s) const { return {x * s, y * s, z * s}; }
    Quad dot(const QuadVec& b) const { return x * b.x + y * b.y + z * b.z; }
};

inline Quad determinant(const QuadVec& a, const QuadVec& b, const QuadVec& c) {
    return a.x * (b.y * c.z - b.z * c.y) - b.x * (a.y * c.z - a.z * c.y) + c.x * (a.y * b.z - a.z * b.y);
}

// One Newton step from the long double root squares its error, 2^-64.
inline Quad squareRoot(Quad a) {
    if (a <= 0) return 0;
    const Quad s = std::sqrt(static_cast<long double>(a));
    return (s + a / s) / 2;
}

struct QuadRoot {
    Quad t, u, v;
};

// Cramer's rule for o + t d = v0 + u (v1 - v0) + v (v2 - v0). Inputs of 24 bits and like magnitude (as in
// these tests) leave the signs exact: products of three differences have 75 bits, quadruple precision 113.
inline std::optional<QuadRoot> triangleTruth(const glm::vec3& v0, const glm::vec3& v1, const glm::vec3& v2,
                                             const Ray& ray) {
    const QuadVec e1 = QuadVec(v1) - QuadVec(v0), e2 = QuadVec(v2) - QuadVec(v0), d(ray.direction);
    const QuadVec s = QuadVec(ray.origin) - QuadVec(v0), back = d * -1;
    const Quad det = determinant(e1, e2, back);
    if (det == 0) return std::nullopt;
    const QuadRoot root{determinant(e1, e2, s) / det, determinant(s, e2, back) / det,
                        determinant(e1, s, back) / det};
    if (root.u < 0 || root.v < 0 || root.u + root.v > 1 || root.t <= 0) return std::nullopt;
    return root;
}

struct QuadRoots {
    Quad t0, t1;
    Quad halfChord;  // in units of the direction
};

// |o + t d - center|^2 = r^2, both roots.
inline std::optional<QuadRoots> sphereTruth(const glm::dvec3& center, double radius, const Ray& ray) {
    const QuadVec w = QuadVec(center) - QuadVec(ray.origin), d(ray.direction);
    const Quad a = d.dot(d), b = w.dot(d), c = w.dot(w) - static_cast<Quad>(radius) * radius;
    const Quad disc = b * b - a * c;
    if (disc < 0) return std::nullopt;
    const Quad s = squareRoot(disc);
    return QuadRoots{(b - s) / a, (b + s) / a, s / a};
}

inline double distance(Quad a, double b) {
    return std::abs(static_cast<double>(a - static_cast<Quad>(b)));
}

}  // namespace glint::reference::test
