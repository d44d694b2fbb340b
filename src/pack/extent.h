// A box in world coordinates, and the planes near it.
#pragma once

#include <glm/glm.hpp>
#include <limits>

namespace glint {

double largestComponent(const glm::dvec3& v);  // in magnitude
// The plane's point nearest to `from`. normal: unit.
glm::dvec3 nearestOnPlane(const glm::dvec3& from, const glm::dvec3& point, const glm::dvec3& normal);

// A box in world coordinates.
struct Extent {
    glm::dvec3 lo{std::numeric_limits<double>::infinity()};
    glm::dvec3 hi{-std::numeric_limits<double>::infinity()};

    // Takes in a point that is finite and within the range of fp32; leaves out others.
    void include(const glm::dvec3& p);
    void include(const Extent& other);
    bool empty() const { return lo.x > hi.x; }
    glm::dvec3 center() const { return 0.5 * lo + 0.5 * hi; }
    double halfSize() const;  // along the longest edge
};

// The point by which fp32 can best hold a plane that is used near `extent`: the given one, or, where that
// lies 16 times farther from the extent's centre than it need, the plane's point nearest the centre. normal:
// unit.
glm::dvec3 planeAnchor(const glm::dvec3& point, const glm::dvec3& normal, const Extent& extent);

}  // namespace glint
