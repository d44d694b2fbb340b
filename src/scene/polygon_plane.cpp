#include "scene/polygon_plane.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/vectors.h"

namespace glint {
namespace {

constexpr double kUnit = 0x1p-53;
// Coordinates written with six digits do not decide which side of an outline has the greater area where the
// areas differ by less than this part of them.
constexpr double kSameArea = 1e-5;

// Newell's sum, twice the vector area, and how far rounding may take it from zero.
struct Newell {
    glm::dvec3 sum{0}, mean{0};  // both measured from the first vertex
    double rounding = 0;
};

// Measured from the first vertex, so that coordinates far from the origin lose nothing.
Newell newell(std::span<const glm::dvec3> vertices) {
    Newell result;
    double terms = 0, length = 0, scale = 0;
    for (size_t i = 0; i < vertices.size(); ++i) {
        const glm::dvec3 p = vertices[i] - vertices[0];
        const glm::dvec3 q = vertices[(i + 1) % vertices.size()] - vertices[0];
        result.sum += glm::cross(p, q);
        result.mean += p / static_cast<double>(vertices.size());
        terms += glm::length(p) * glm::length(q);
        length += glm::length(q - p);
        scale = std::max(scale, greatestMagnitude(vertices[i]));
    }
    // Each cross product errs by 4 u of its terms and each addition by another u of them; a vertex that was
    // itself rounded, by u of its coordinates on each axis, turns the sum by that times the two edges it
    // ends.
    result.rounding = kUnit * ((static_cast<double>(vertices.size()) + 4) * terms +
                               2 * std::numbers::sqrt3 * scale * length);
    return result;
}

PolygonPlane planeOf(std::span<const glm::dvec3> vertices, const glm::dvec3& point,
                     const glm::dvec3& normal) {
    PolygonPlane plane;
    plane.normal = normal;
    plane.point = point;
    for (size_t i = 0; i < vertices.size(); ++i) {
        const double off = std::abs(glm::dot(plane.normal, vertices[i] - plane.point));
        if (off <= plane.deviation) continue;
        plane.deviation = off;
        plane.farthest = i;
    }
    return plane;
}

// Twice the vector area of the widest triangle that is cheap to find: the first vertex, the one farthest from
// it, and the one farthest from the line through both. Zero if rounding alone can give points of a line so
// much.
glm::dvec3 widestTriangle(std::span<const glm::dvec3> vertices) {
    glm::dvec3 ab(0), ac(0);
    double scale = greatestMagnitude(vertices[0]);
    for (const glm::dvec3& v : vertices) {
        scale = std::max(scale, greatestMagnitude(v));
        if (glm::length(v - vertices[0]) > glm::length(ab)) ab = v - vertices[0];
    }
    for (const glm::dvec3& v : vertices) {
        if (glm::length(glm::cross(ab, v - vertices[0])) > glm::length(glm::cross(ab, ac)))
            ac = v - vertices[0];
    }
    // Rounding error of one cross product of rounded vertices, as in newell().
    const double rounding = kUnit * (8 * glm::length(ab) * glm::length(ac) +
                                     4 * std::numbers::sqrt3 * scale * (glm::length(ab) + glm::length(ac)));
    const glm::dvec3 twice = glm::cross(ab, ac);
    return glm::length(twice) > rounding ? twice : glm::dvec3(0);
}

// True if `triangle` (widestTriangle) points to the front: Newell's side, or, if both areas are about equal,
// the side from which the first sharp corner turns left.
bool facesFront(const glm::dvec3& triangle, const glm::dvec3& sum, std::span<const glm::dvec3> vertices) {
    const double enough = kSameArea * glm::dot(triangle, triangle);
    if (std::abs(glm::dot(sum, triangle)) > enough) return glm::dot(sum, triangle) > 0;
    const size_t n = vertices.size();
    for (size_t i = 0; i < n; ++i) {
        const glm::dvec3 before = vertices[i] - vertices[(i + n - 1) % n];
        const glm::dvec3 after = vertices[(i + 1) % n] - vertices[i];
        const double turn = glm::dot(glm::cross(before, after), triangle);
        if (std::abs(turn) > enough) return turn > 0;
    }
    return true;
}

}  // namespace

std::optional<PolygonPlane> polygonPlane(std::span<const glm::dvec3> vertices) {
    const Newell all = newell(vertices);
    const glm::dvec3 point = vertices[0] + all.mean;
    const double area = glm::length(all.sum);
    const glm::dvec3 triangle = widestTriangle(vertices);
    const double widest = glm::length(triangle);
    std::optional<PolygonPlane> plane;
    if (area > all.rounding) plane = planeOf(vertices, point, all.sum / area);
    const bool fits = plane && plane->deviation <= planarTolerance(vertices);
    if (widest == 0 || (fits && area > kSameArea * widest)) return plane;

    const double sign = facesFront(triangle, all.sum, vertices) ? 1 : -1;
    const PolygonPlane spanned = planeOf(vertices, point, sign / widest * triangle);
    return fits || !plane || spanned.deviation < plane->deviation ? spanned : plane;
}

double planarTolerance(std::span<const glm::dvec3> vertices) {
    BoundingBox box;
    for (const glm::dvec3& v : vertices) box.include(v);
    const double size = greatestMagnitude(box.hi - box.lo),
                 scale = std::max(greatestMagnitude(box.lo), greatestMagnitude(box.hi));
    return 2 * std::numbers::sqrt3 * std::max(5e-6 * size, 0x1p-24 * scale);
}

}  // namespace glint
