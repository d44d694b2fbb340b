// Affine transforms of scene objects, in double.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "scene/scene.h"

namespace glint {

Affine scaling(const glm::dvec3& factors);
Affine translation(const glm::dvec3& offset);
// Turns by `degrees` about `axis` (not zero, any length), counter-clockwise seen from its tip. Exact for
// quarter turns.
Affine rotation(const glm::dvec3& axis, double degrees);
// Turns by a quaternion x y z w of any length, as files hold seven digits; nothing if its squared length is 0
// or not finite.
std::optional<Affine> rotation(const glm::dvec4& quaternion);
glm::dvec3 apply(const Affine& transform, const glm::dvec3& point);
// The magnitudes of the elements.
glm::dmat3 magnitudes(const glm::dmat3& m);
// First `first`, then `second`.
Affine then(const Affine& first, const Affine& second);

// `linear` must be regular.
Affine inverse(const Affine& transform);

// |A| |A^-1| in the Frobenius norm: 3 for a similarity, 1 to 3 times the spectral condition number in
// general, infinite for a singular matrix and NaN for one that is not finite.
double conditionNumber(const glm::dmat3& linear);

// The factor of a transform that scales all directions alike (it may also turn and mirror), within 1e-6, so
// that matrices written with seven digits pass; otherwise nothing.
std::optional<double> similarityFactor(const glm::dmat3& linear);

// A unit vector across a unit vector.
glm::dvec3 tangentOf(const glm::dvec3& normal);

// The factor by which a disc with this normal (any length but zero) grows, if it stays round: if, within
// 1e-6, the transform scales all directions of the disc's plane alike.
std::optional<double> discFactor(const glm::dvec3& normal, const glm::dmat3& linear);

// The object under the transform; its inside stays inside. Normals go by the inverse transpose. A mirroring
// transform (negative determinant) turns the winding of triangles around, so the second and third corner are
// exchanged, and the outlines of polygons reversed: outward normals stay outward and agree with the
// transformed vertex normals. `linear` must be regular. Nothing for a sphere or disc that does not stay
// round.
TriangleShape transformed(const TriangleShape& triangle, const Affine& transform);
PlaneShape transformed(const PlaneShape& plane, const Affine& transform);
std::optional<SphereShape> transformed(const SphereShape& sphere, const Affine& transform);
std::optional<DiscShape> transformed(const DiscShape& disc, const Affine& transform);
PolygonShape transformed(const PolygonShape& polygon, const Affine& transform);
Mesh transformed(const Mesh& mesh, const Affine& transform);

}  // namespace glint
