#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace glint {

// Exact area vector for nearly degenerate polygons.
glm::dvec3 exactAreaVector(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

// (v1 - v0) x (v2 - v0), along the triangle's normal with twice its area as length. It is exactly zero if and
// only if the three rounded points are collinear or coincide. Otherwise every component is within 2^-28 of
// the largest one's magnitude for triangles of any shape, so fp32 normals of needles are as accurate as those
// of other triangles.
inline glm::dvec3 areaVector(const glm::vec3& v0, const glm::vec3& v1, const glm::vec3& v2) {
    const glm::dvec3 a(v0), b(v1), c(v2);
    const glm::dvec3 e1 = b - a, e2 = c - a;
    const glm::dvec3 p(e1.y * e2.z, e1.z * e2.x, e1.x * e2.y);
    const glm::dvec3 q(e1.z * e2.y, e1.x * e2.z, e1.y * e2.x);
    const glm::dvec3 n = p - q;
    const glm::dvec3 terms = glm::abs(p) + glm::abs(q);
    // With u = 2^-53: each edge is off by u, each product by 3u + O(u^2), so n is off by less than 4u (|p| +
    // |q|) + u |n|, which is under 2^-28 max|n| where |p| + |q| <= 2^22 max|n|. Nothing underflows: floats
    // are at least 2^-149.
    const double largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
    if (std::max({terms.x, terms.y, terms.z}) <= 0x1p22 * largest) return n;
    return exactAreaVector(a, b, c);
}

// The unit normal of such a triangle; false if it has none, or a corner is not finite. Needs no scaling
// (unitVector): components of area vectors are 0 or from 2^-298 to 2^259, whose squares double can hold.
inline bool triangleNormal(const glm::vec3& v0, const glm::vec3& v1, const glm::vec3& v2, glm::vec3& normal) {
    const glm::dvec3 n = areaVector(v0, v1, v2);
    const double square = n.x * n.x + n.y * n.y + n.z * n.z;
    if (!(square > 0 && std::isfinite(square))) return false;
    const double inverse = 1 / std::sqrt(square);
    normal.x = static_cast<float>(n.x * inverse);
    normal.y = static_cast<float>(n.y * inverse);
    normal.z = static_cast<float>(n.z * inverse);
    return true;
}

}  // namespace glint
