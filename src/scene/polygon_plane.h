// The plane of a polygon.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>

namespace glint {

struct PolygonPlane {
    glm::dvec3 point;   // the mean of the vertices
    glm::dvec3 normal;  // unit, to the side from which the vertices run counter-clockwise, see polygonPlane
    double deviation = 0;  // the greatest distance of a vertex from the plane
    size_t farthest = 0;   // the vertex that has it
};

// By Newell's sum (I. Sutherland, R. Sproull, R. Schumacker, "A Characterization of Ten Hidden-Surface
// Algorithms", 1974), which takes all vertices into account, collinear and concave ones too. The sum counts
// areas inside a clockwise loop as negative. If an outline crosses itself, as a bow tie does, both kinds may
// cancel: little but rounding is left, and vertices lie off the plane. Then the plane is spanned by the first
// vertex, the one farthest from it and the one farthest from the line through these two. Its front is the
// side from which the greater area is counter-clockwise; if the areas differ by less than 1e-5, the side from
// which the first sharp corner turns left. Nothing if all vertices lie on a line within rounding.
std::optional<PolygonPlane> polygonPlane(std::span<const glm::dvec3> vertices);

// How far a vertex may lie off the plane. Coordinates written with six digits, as C's %g has it, are off by
// 5e-6 of the polygon's size, those computed in fp32 by 2^-24 of the greatest coordinate. Along a normal that
// is sqrt(3) times more, and the plane, made of such vertices, is off by as much again.
double planarTolerance(std::span<const glm::dvec3> vertices);

}  // namespace glint
