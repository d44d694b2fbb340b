// Boxes in world coordinates: of the objects of a scene, and the origin that they suggest.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "core/context.h"
#include "core/vectors.h"
#include "scene/scene.h"

namespace glint {

class PrimitiveNumbers;

// A box in world coordinates.
struct Extent : BoundingBox {
    // Takes in a point that is finite and within the range of fp32; leaves out others.
    void include(const glm::dvec3& p);
    void include(const Extent& other);
    glm::dvec3 center() const { return 0.5 * lo + 0.5 * hi; }
    double halfSize() const;  // along the longest edge
};

// The point by which fp32 can best hold a plane that is used near `extent`: the given one, or, where that
// lies 16 times farther from the extent's centre than it need, the plane's point nearest the centre. normal:
// unit.
glm::dvec3 planeAnchor(const glm::dvec3& point, const glm::dvec3& normal, const Extent& extent);

// Bounds of the finite geometry, and of most of it.
struct Geometry {
    Extent extent;
    glm::dvec3 middle{0};  // the median, axis by axis, of the centres of the nearer half of the objects
    double reach = 0;      // half of all objects lie no farther from there in any axis, with all their parts
};

// The corners of the box around an instance, in the world (Instances::corners).
using CornersOf = std::function<std::vector<glm::dvec3>(uint32_t object)>;
// Bounds of each object, empty for planes. `corners` may be empty if there are no instances.
std::vector<Extent> objectExtents(const Scene& scene, const PrimitiveNumbers& numbers,
                                  const CornersOf& corners, const Context& context);
Geometry geometryOf(const Scene& scene, std::vector<Extent> objects);
// With the camera.
Extent withCamera(const Extent& geometry, const Scene& scene);

// The origin of local coordinates, in the world. Let m be the median, in each axis, of the centres of the
// nearer half of all objects except planes (nearer to the median of all centres, with all their parts). Let e
// be the greatest distance from m, in any axis, of half of all objects. Without such objects, m and e are the
// centre and half the greatest edge of the box around the eye, its target and the point of each plane that is
// nearest the eye.
// The origin is 0 unless the largest |component| of m exceeds four times both e and the eye's distance from m
// in any axis, which would cost at least 2 of the 24 bits of fp32. An eye farther than 4096 e from all
// geometry does not count. Otherwise the origin is m rounded to a multiple of the power of two in (e, 2e]: at
// most e away from m in any axis, and exact in fp32 if |m| < 2^24 e. So neither a planet among small objects
// decides, nor a grain far from all.
glm::dvec3 originOf(const Geometry& geometry, const glm::dvec3& eye);
// looksFrom: how far the eye is from the middle.
glm::dvec3 originOf(const glm::dvec3& middle, double reach, double looksFrom);

}  // namespace glint
