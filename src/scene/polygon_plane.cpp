#include "scene/polygon_plane.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace glint {
namespace {

constexpr double kUnit = 0x1p-53;

double greatest(const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

std::optional<PolygonPlane> polygonPlane(std::span<const glm::dvec3> vertices) {
    // Measured from the first vertex, so that coordinates far from the origin lose nothing.
    glm::dvec3 sum(0), mean(0);
    double terms = 0, length = 0, scale = 0;
    for (size_t i = 0; i < vertices.size(); ++i) {
        const glm::dvec3 p = vertices[i] - vertices[0];
        const glm::dvec3 q = vertices[(i + 1) % vertices.size()] - vertices[0];
        sum += glm::cross(p, q);
        mean += p / static_cast<double>(vertices.size());
        terms += glm::length(p) * glm::length(q);
        length += glm::length(q - p);
        scale = std::max(scale, greatest(vertices[i]));
    }
    // Each cross product errs by 4 u of its terms and each addition by another u of them; a vertex that was
    // itself rounded, by u of its coordinates on each axis, turns the sum by that times the two edges it
    // ends.
    const double rounding = kUnit * ((static_cast<double>(vertices.size()) + 4) * terms +
                                     2 * std::numbers::sqrt3 * scale * length);
    const double area = glm::length(sum);
    if (!(area > rounding)) return std::nullopt;

    PolygonPlane plane;
    plane.normal = sum / area;
    plane.point = vertices[0] + mean;
    for (size_t i = 0; i < vertices.size(); ++i) {
        const double off = std::abs(glm::dot(plane.normal, vertices[i] - plane.point));
        if (off <= plane.deviation) continue;
        plane.deviation = off;
        plane.farthest = i;
    }
    return plane;
}

double planarTolerance(std::span<const glm::dvec3> vertices) {
    glm::dvec3 lo = vertices[0], hi = vertices[0];
    for (const glm::dvec3& v : vertices) {
        lo = glm::min(lo, v);
        hi = glm::max(hi, v);
    }
    const double size = greatest(hi - lo), scale = std::max(greatest(lo), greatest(hi));
    return 2 * std::numbers::sqrt3 * std::max(5e-6 * size, 0x1p-24 * scale);
}

}  // namespace glint
