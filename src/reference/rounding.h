// Bounds on the fp32 error of hit points and of shading, derived from the formulas and not from the shaders.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace glint::reference {

inline constexpr double kFloatUnit = 0x1p-24;  // of fp32; kUnitRoundoff is that of double

// ---- Points: the fp32 error of a hit point (docs/design/numerics.md 2.9) is a box around it, and rays that
// leave the point begin at the box's edge. It is in the primitive's coordinates until an instance transforms
// it to the world.

// The relative error of n roundings.
constexpr double gammaOf(double n) {
    return n * kFloatUnit / (1 - n * kFloatUnit);
}

// Error box of a point that is formed as an anchor plus an offset on the surface.
inline glm::dvec3 errorBox(const glm::dvec3& offset, const glm::dvec3& anchor) {
    return gammaOf(7) * (glm::abs(offset) + glm::abs(anchor));
}

// How far along the unit normal of its surface a ray begins from a point.
inline double clearanceOf(const glm::dvec3& error, const glm::dvec3& normal) {
    return glm::dot(glm::abs(normal), error);
}

// ---- Shading, for given rays and hits: absolute errors, in units of 2^-24. Jitter covers the effect of
// errors of rays, points and normals on a colour.

// A colour, or a factor of one, with a bound on its error.
struct RoundedColor {
    glm::dvec3 value{0}, error{0};

    RoundedColor& operator+=(const RoundedColor& other) {
        value += other.value;
        error += other.error;
        return *this;
    }
    friend RoundedColor operator*(const RoundedColor& a, const RoundedColor& b) {
        return {a.value * b.value, a.error * b.value + a.value * b.error};
    }
};
// A value that errs by so many units of itself.
inline RoundedColor roundedColor(const glm::dvec3& value, double units) {
    return {value, units * value};
}

// Error of the texture coordinates of a known hit, in units of the numbers that they sum (Surface::uvScale,
// at least 1). A point errs by 7 units on each axis (errorBox), products with the object's frame and their
// sums by 4, and the longitude of a normal by 8 to 12.
inline constexpr double kUvRoundings = 16;

// A texel's bilinear mixture takes 7 roundings, its product with a colour one, with the vertices' colour
// four, with the throughput one, and a sum three: 16 of a product of colours.
inline constexpr double kProductRoundings = 16;
// Fresnel's reflectance, of cosines that are given: (a - b) / (a + b) errs by 2.5 ulp of division and three
// roundings of a and b, at most 11 units; twice that for its square, and for the sum of two, halved, as much.
inline constexpr double kReflectanceError = 32;

// Error of the direction to a light: 5 units for subtraction, length and division (a sum of squares errs by
// 3, its root by half of that and one), and the error of the hit point, 9 units of the numbers that it is a
// sum of (Site::offset), seen from the light. scale: of the point. Infinite distance: a light whose direction
// is given.
inline double lightTurn(double scale, double distance) {
    return std::isinf(distance) ? 1 : 5 + 9 * scale / distance;
}

// Error of a unit normal: 4 units for its arithmetic, plus the turn by the point's error on a surface of this
// `bend` (Surface): o + t d errs by 8 units of the numbers it is a sum of. Jitter moves it along rulings, or
// not at all. gain: of the instance's transform that normals return by.
inline double normalError(double bend, double scale, double gain) {
    return (4 + 8 * bend * scale) * (1 + gain);
}

// Error of the cosine between unit vectors: a sum of three products errs by 3 units of the sum of their
// magnitudes, at most sqrt(3); the normal by `normal`, the other vector by `turn`.
inline double cosineError(double turn, double normal) {
    return 6 + normal + turn;
}

// Error of cosine^n, where cosine is that of the normal and the half vector of two directions whose sum has
// `length`; one errs by `turn`, the other by 4 units. n times the relative error of the cosine, plus the
// power's own (docs/design/numerics.md 1.1): log2 errs by 1.5 ulp, at most 3 units, its product y with n by
// one more, which exp2 makes 4 |y| log(2), and by 1.2 ulp itself; then the product with the light.
inline double powerError(double cosine, double n, double power, double length, double turn, double normal) {
    const double sway = cosineError(2 * (turn + 6) / length, normal) / cosine;
    const double y = 1.45 * n * std::max(1 - cosine, 0.0) / cosine;  // at least n |log2(cosine)|
    const double relative = n * sway + 2.8 * y + 2.4 + 2;
    return std::min(power * relative, 0x1p24);
}

// Error of e^-x for an x that sums magnitudes `sum` with 8 roundings each; exp errs by an ulp, at most 2
// units, and its product with the light by one. `ends`: error of the ends of the path through a medium, each
// 9 units of the numbers that its point is a sum of (lightTurn), times the attenuation per unit. For a
// triangle whose corners are a hundred times as far away as the hit they exceed the path itself.
inline double exponentialRoundings(double sum, double ends) {
    return 4 + 8 * sum + 9 * ends;
}

}  // namespace glint::reference
