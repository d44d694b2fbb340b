// A glTF scene that is read once and shown at many times.
#pragma once

#include <filesystem>
#include <memory>

#include "import/gltf_animation.h"
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

    // Transforms of the animated nodes at a time in seconds.
    GltfPlaces placesAt(double time) const;
    // Puts objects, and lights and cameras if the file has any, into `scene` as these transforms place them;
    // all else stays. Not yet validated.
    void show(const GltfPlaces& places, Scene& scene);
    // False if the animation moves only cameras.
    bool movesObjects() const;

  private:
    class Reader;
    std::unique_ptr<Reader> reader_;
};

}  // namespace glint
