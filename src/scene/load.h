// From files to a Scene.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "scene/scene.h"

namespace glint {

// Loads a glint scene (.json), a scene of another program (.gltf, .glb, .nff) or a model alone (.obj, .ply,
// .stl), chosen by extension, any case. Relative paths inside a file are relative to that file. A model alone
// gets a camera that frames it and a light (frameModel), a scene of another program what it lacks of these.
// Throws Error(Scene) with one line "file: where: what" for anything wrong: docs/scene-format.md.
Scene loadScene(const std::filesystem::path& path);

// Parses scene text; `name` stands for the file in messages, `folder` is where relative paths start.
Scene parseScene(std::string_view text, const std::string& name, const std::filesystem::path& folder);

// Refuses what no tracer can render: non-finite numbers, non-positive radii, zero normals, eye == target, up
// parallel to the view direction, sizes, ranges, indices outside their arrays, and coordinates or sizes
// outside the supported range: |x| < 1e18, sphere radius in [1e-14, 1e18]. Vertices of meshes that are not
// finite are NOT refused: the triangles that use them are dropped when the scene is packed, with a warning.
// `name` stands for the file in messages.
void validateScene(const Scene& scene, const std::string& name);

// What surrounds a model that says nothing about it: an unlit side is still seen.
inline constexpr Color kModelBackground{0.42, 0.50, 0.60};
inline constexpr Color kModelAmbient{0.2};

// A camera and, if there is none, a light that show all of `scene`'s finite geometry: frameCamera and
// lightModel; background and ambient light as above.
void frameModel(Scene& scene);

// A view from the front, above and to the right, 40 degrees, that holds all finite geometry but planes.
void frameCamera(Scene& scene);

// Adds a directional light from the upper left of `scene.camera`'s picture, which must be valid.
void lightModel(Scene& scene);

}  // namespace glint
