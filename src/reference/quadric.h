// Ray against quadric. Not the shader's way: the quadric is one symmetric form of four homogeneous
// coordinates, its three values on a ray give the equation at the ray's own origin, with digits enough that
// nothing has to be moved, and every root and every cap is asked on its own whether it lies within the
// bounds.
#pragma once

#include "reference/intersect.h"

namespace glint::reference {

// b^2 - a c without the cancellation: the rounding errors of both products are found and added (W. Kahan, "On
// the Cost of Floating-Point Computation Without Extra-Precise Arithmetic", 2004, sec. 2; C.-P. Jeannerod, N.
// Louvet, J.-M. Muller, "Further Analysis of Kahan's Algorithm", Math. Comp. 82, 2013: the error is at
// most 1.5 ulp).
template <class T>
T discriminant(T a, T b, T c) {
    const T square = b * b, product = a * c;
    return (square - product) + (std::fma(b, b, -square) - std::fma(a, c, -product));
}

// Roots of a t^2 + 2 b t + c = 0 for a discriminant that is not negative, smaller first; how many. A double
// root counts as two, an equation without unknown has none.
template <class T>
int solveQuadratic(T a, T b, T c, T disc, T (&roots)[2]) {
    if (a == 0) {
        if (b == 0) return 0;
        roots[0] = -c / (2 * b);
        return 1;
    }
    const T q = b + std::copysign(std::sqrt(disc), b);
    roots[0] = q == 0 ? 0 : -c / q;
    roots[1] = -q / a;
    if (roots[0] > roots[1]) std::swap(roots[0], roots[1]);
    return 2;
}

// `source`: the primitive that the ray starts on, and the part of it; `primitive`: this quadric. part: of the
// hit, shared::kPart....
bool intersectQuadric(const rows::Quadric& quadric, const PreparedRay& ray, uint32_t primitive,
                      uint32_t source, double tMax, Root& root, uint32_t& part);

// The surface next to `point`, moved onto it; normal outward, of length 1. direction: of the ray, against
// which the surface faces where it has no normal (the apex of a cone, a double plane).
// bend: at most how far the normal turns for a unit of way. error: along the normal, of the value of the
// equation there, in fp32 (error_box.h).
struct QuadricPoint {
    glm::dvec3 position, normal;
    double bend = 0;
    double error = 0;
};
QuadricPoint quadricPoint(const rows::Quadric& quadric, uint32_t part, const glm::dvec3& point,
                          const glm::dvec3& direction);

// How far its clipping box reaches from its point, in any coordinate.
double quadricReach(const rows::Quadric& quadric);

}  // namespace glint::reference
