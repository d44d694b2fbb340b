#pragma once

#include <glm/glm.hpp>
#include <limits>

#include "pack/primitives.h"
#include "scene/scene.h"

namespace glint {

// Where the geometry and the eye are, in world coordinates, as chooseOrigin describes it.
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

// Of the finite geometry alone; `instances` may be null where there are none.
Extent geometryExtent(const Scene& scene, const PrimitiveNumbers& numbers, const Instances* instances,
                      unsigned threads);
// With the camera.
Extent withCamera(const Extent& geometry, const Scene& scene);
glm::dvec3 originOf(const Extent& extent);

// The point by which fp32 can best hold a plane that is used near `extent`: the given one, or, where that
// lies 16 times farther from the extent's centre than it need, the plane's point nearest the centre. normal:
// unit.
glm::dvec3 planeAnchor(const glm::dvec3& point, const glm::dvec3& normal, const Extent& extent);

}  // namespace glint
