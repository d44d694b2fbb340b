// A scene file that is read once and shown at many times of its animation.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "import/load.h"
#include "scene/scene.h"

namespace glint {

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

    // Parts of the scene that a later moment changes. Camera: only Scene::camera and cameras.
    enum class Change { Nothing, Camera, Scene };
    // Throws Error(Scene) if the scene is invalid at that time, and keeps the scene as it was.
    Change moveTo(double time);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace glint
