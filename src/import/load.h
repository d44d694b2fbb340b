// From files to a Scene.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "import/scene_files.h"
#include "scene/frame_model.h"
#include "scene/scene.h"

namespace glint {

// Loads a glint scene (.json), a scene of another program (.gltf, .glb, .nff) or a model alone (.obj, .ply,
// .stl), chosen by extension, any case. Relative paths inside a file are relative to that file. A model alone
// gets a camera that frames it and a light (frameModel); a scene of another program gets those that it lacks.
// Throws Error(Scene) "file: where: what" (docs/reference/scene-format.md), and Error(Argument) if the file
// has no camera of the name options.camera. Without options.allowOutside, all files must lie in the scene's
// folder or below.
Scene loadScene(const std::filesystem::path& path, const LoadOptions& options = {});

// Parses scene text; `name` stands for the file in messages, `folder` is where relative paths start.
Scene parseScene(std::string_view text, const std::string& name, const std::filesystem::path& folder,
                 const LoadOptions& options = {});
Scene parseScene(std::string_view text, const std::string& name, const std::filesystem::path& folder,
                 SceneFiles& files);

}  // namespace glint
