// How objects with transforms come to stand in the world: as shapes of their own there, or as instances.
#pragma once

#include <optional>

#include "scene/scene.h"

namespace glint {

// The shape under the transform, if it is one of the same kind: always of triangles, polygons, planes and
// meshes, of spheres and discs that stay round; not of quadrics.
std::optional<Shape> baked(const Shape& shape, const Affine& transform);

// How many times the rounding of a position grows when a ray is taken into the coordinates of an object and
// the hit back, in fp32: the greatest component of |A| |A^-1| e over that of e, where e = |A| h is the
// object's half size in the world along each axis and h that in its own coordinates. Below 5.2 for a
// similarity, whatever its factor; about the ratio of the stretches for stretches along slanted axes.
double transformLoss(const glm::dmat3& linear, const glm::dvec3& halfSize);

// True of quadrics, which are packed with an affine map of their own: they keep their transform and are no
// instances.
bool takesTransform(const Shape& shape);

// Half the box around a shape in its own coordinates; 1 along each axis for one that has no box here.
glm::dvec3 halfSizeOf(const Shape& shape);

// Decides how each object stands in the world. Afterwards an object that still has a transform, and is
// no quadric, is an instance: its shape is kept in its own coordinates, and rays are transformed. That is
// - a mesh that several objects share, each transform losing no more than kMaxMeshLoss, if instances save
//   kLeastSaving bytes or more: then all of these objects are instances, an untransformed one by the
//   identity;
// - a disc that does not stay round: it becomes the unit disc about 0 with normal z, so that all of them are
//   stored once.
// A sphere that does not stay round becomes an ellipsoid. Everything else is baked, in double. To do it twice
// changes nothing.
void placeObjects(Scene& scene);

// False if placeObjects would change anything.
bool isPlaced(const Scene& scene);

// The scene, if it is placed, else a copy of it that is, held by `copy`.
const Scene& placedScene(const Scene& scene, Scene& copy);

// More, and a mesh is baked instead: 6 of fp32's 24 bits, as for the local frame (pack/packed_scene.h).
inline constexpr double kMaxMeshLoss = 64;
// More, also as the condition number of a quadric, is refused: the shape would be off by 2^-10 of its size.
inline constexpr double kMaxTransformLoss = 16384;
// A ray pays for each instance it enters with a transform and a tree of its own, so little memory is not
// worth it.
inline constexpr double kLeastSaving = 256 * 1024;

}  // namespace glint
