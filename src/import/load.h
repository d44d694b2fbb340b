// From files to a Scene.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "import/scene_files.h"
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

// A scene file that is read once and shown at many times of its animation.
class SceneReader {
  public:
    // Reads the file as loadScene does, at `time` in seconds, or without `time` by the numbers in the file.
    // Keeps meshes and images for later times. The path "-" is a scene in JSON, which options.source must
    // have.
    SceneReader(const std::filesystem::path& path, const LoadOptions& options,
                std::optional<double> time = {});
    ~SceneReader();
    SceneReader(SceneReader&&) noexcept;

    const Scene& scene() const;
    Scene take();  // moves the scene out; for a single moment

    // Parts of the scene that a later moment changes. Camera: only Scene::camera and cameras.
    enum class Change { Nothing, Camera, Scene };
    // Throws Error(Scene) if the scene is invalid at that time, and keeps the scene as it was.
    Change moveTo(double time);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

// True if loadScene reads files with this extension.
bool isSceneFile(const std::filesystem::path& path);

}  // namespace glint
