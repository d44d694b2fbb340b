#pragma once

#include <glm/glm.hpp>
#include <limits>

#include "pack/primitives.h"
#include "scene/scene.h"

namespace glint {

// Where the geometry and the eye are, in world coordinates, as chooseOrigin describes it.
struct Region {
    glm::dvec3 lo{std::numeric_limits<double>::infinity()};
    glm::dvec3 hi{-std::numeric_limits<double>::infinity()};

    // Takes in a point that is finite and within the range of fp32.
    void include(const glm::dvec3& p);
    void include(const Region& r);
    bool empty() const { return lo.x > hi.x; }
    glm::dvec3 center() const { return 0.5 * lo + 0.5 * hi; }
    double halfExtent() const;  // along the longest edge
};

// Of the finite geometry alone; `instances` may be null where there are none.
Region geometryRegion(const Scene& scene, const PrimitiveNumbers& numbers, const Instances* instances,
                      unsigned threads);
Region sceneRegion(const Scene& scene, const PrimitiveNumbers& numbers, const Instances* instances,
                   unsigned threads);
glm::dvec3 originOf(const Region& region);

// The point by which fp32 can best hold a plane that is used near `region`: the given one, or, where that
// lies 16 times farther from the region's centre than it need, the plane's point nearest the centre. normal:
// unit.
glm::dvec3 planeAnchor(const glm::dvec3& point, const glm::dvec3& normal, const Region& region);

}  // namespace glint
