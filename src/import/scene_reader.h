// A scene file that is read once and shown at many times.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "import/load.h"
#include "scene/scene.h"

namespace glint {

class SceneReader {
  public:
    // Reads the file, as loadScene does, at a moment of its animation in seconds; without one, as it stands
    // in the file. Meshes and pictures are kept for later moments. The path "-" is a scene in JSON, which
    // options.source must have.
    SceneReader(const std::filesystem::path& path, const LoadOptions& options,
                std::optional<double> time = {});
    ~SceneReader();
    SceneReader(SceneReader&&) noexcept;

    const Scene& scene() const;

    // Parts of the scene that a later moment changes. Camera: only Scene::camera and cameras.
    enum class Change { Nothing, Camera, Scene };
    // Throws Error(Scene) where the file's rules forbid what the animation comes to; then the moment before
    // stays.
    Change moveTo(double time);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace glint
