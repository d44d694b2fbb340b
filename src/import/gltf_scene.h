// A glTF scene that is read once and shown at many times.
#pragma once

#include <filesystem>
#include <memory>

#include "import/readers.h"

namespace glint {

class GltfScene {
  public:
    // Reads the file as readGltf does: the scene as its nodes stand. `files` must outlive the object.
    GltfScene(const std::filesystem::path& path, SceneFiles& files);
    ~GltfScene();
    GltfScene(GltfScene&&) noexcept;

    // Returns the scene that was read; call it once.
    ImportedScene take();

    // Puts objects, and lights and cameras if the file has any, into `scene` as they are at that time in
    // seconds; all else stays. Not yet validated.
    void show(double time, Scene& scene);

  private:
    class Reader;
    std::unique_ptr<Reader> reader_;
};

}  // namespace glint
