// Checks for scenes that no tracer can render: the whole scene, or each part where the reader finds it.
#pragma once

#include <string>
#include <string_view>

#include "core/text_file.h"
#include "scene/scene.h"

namespace glint {

// Refuses what no tracer can render: non-finite numbers, non-positive radii, zero normals, eye == target, up
// parallel to the view direction, sizes, ranges, indices outside their arrays, and coordinates or sizes
// outside the supported range: |x| < 1e18, sphere radius in [1e-14, 1e18]. Vertices of meshes that are not
// finite are NOT refused: the triangles that use them are dropped when the scene is packed, with a warning.
// `name` stands for the file in messages.
void validateScene(const Scene& scene, const std::string& name);
// The same for a scene with a camera of frameModel's: what makes that useless is where the objects are.
void validateFramedScene(const Scene& scene, const std::string& name);

// Names the fault of a transform that is not finite, or whose condition number exceeds kMaxCondition; empty
// for a valid one.
std::string transformFault(const Affine& transform);

// Place of a value for messages: "FILE: POINTER/KEY: what".
struct Place {
    std::string file;
    std::string pointer;
    [[noreturn]] void failWith(std::string_view key, const std::string& what) const;
    template <typename... Parts>
    [[noreturn]] void fail(std::string_view key, const Parts&... what) const {
        failWith(key, concat(what...));
    }
};

void validateCamera(const Camera& camera, const Place& place);
void validateCameras(const Scene& scene, const std::string& name);  // its own and those with names
void validateMaterial(const Material& material, const Place& place);
// Coordinates and colours of the vertices. `name`: of what the mesh was read from.
void validateVertices(const Mesh& mesh, const std::string& name);
// Every vertex of a mesh is looked at; materials are checked against `materialCount`.
void validateShape(const Shape& shape, const Place& place, size_t materialCount);
// Throws for a plane counted twice, and for a surface that lies in a face of its bounds: no ray hits these
// quadrics reliably.
void checkEquation(const QuadricShape& shape, const Place& place);

}  // namespace glint
