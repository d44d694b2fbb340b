// From files to a Scene.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "scene/scene.h"

namespace glint {

// Loads a glint scene (.json) or a model alone (.obj, .ply), chosen by extension, any case. Relative paths
// inside a scene file are relative to that file. A model alone gets a camera that frames it and a light
// (frameModel). Throws Error(Scene) with one line "file: where: what" for anything wrong:
// docs/scene-format.md.
Scene loadScene(const std::filesystem::path& path);

// Parses scene text; `name` stands for the file in messages, `folder` is where relative paths start.
Scene parseScene(std::string_view text, const std::string& name, const std::filesystem::path& folder);

// Refuses what no tracer can render: non-finite numbers, non-positive radii, zero normals, eye == target, up
// parallel to the view direction, sizes, ranges, indices outside their arrays, and coordinates or sizes
// outside the supported range: |x| < 1e18, sphere radius in [1e-14, 1e18]. Vertices of meshes that are not
// finite are NOT refused: the triangles that use them are dropped when the scene is packed, with a warning.
// `name` stands for the file in messages.
void validateScene(const Scene& scene, const std::string& name);

// A camera and a light that show all of `scene`'s finite geometry: view from the front, above and to the
// right, 40 degrees, background and ambient set so that an unlit side is still seen.
void frameModel(Scene& scene);

}  // namespace glint
