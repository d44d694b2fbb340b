// Boxes in world coordinates: of the objects of a scene, and the origin that they suggest.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "pack/packed_scene.h"

namespace glint {

class PrimitiveNumbers;

// The point by which fp32 can best hold a plane that is used near `extent`: the given one, or, where that
// lies 16 times farther from the extent's centre than it need, the plane's point nearest the centre. normal:
// unit.
glm::dvec3 planeAnchor(const glm::dvec3& point, const glm::dvec3& normal, const Extent& extent);

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
