// A glTF scene that is read once and shown at many times: its animation moves nodes.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "import/gltf_file.h"
#include "import/readers.h"
#include "scene/scene.h"

namespace glint {

// Animated transform of a node. A part that is absent keeps the value of the node's file.
struct GltfPlace {
    std::optional<std::vector<double>> translation, rotation, scale;  // 3, 4 (x y z w) and 3 numbers
    bool operator==(const GltfPlace&) const = default;
};
using GltfPlaces = std::map<size_t, GltfPlace>;  // by node

class GltfScene {
  public:
    virtual ~GltfScene() = default;

    // Returns the scene that was read, as its nodes stand; call it once.
    virtual ImportedScene take() = 0;

    // Transforms of the animated nodes at a time in seconds.
    virtual GltfPlaces placesAt(double time) const = 0;
    // Puts objects, and lights and cameras if the file has any, into `scene` as these transforms place them;
    // all else stays. Not yet validated.
    virtual void show(const GltfPlaces& places, Scene& scene) = 0;
    // False if the animation moves only cameras.
    virtual bool movesObjects() const = 0;
};

// docs/reference/file-formats.md describes the mapping and the warnings. `files` must outlive the object.
// Throws Error(Scene) "FILE: /JSON/POINTER: ...".
std::unique_ptr<GltfScene> openGltf(const std::filesystem::path& path, SceneFiles& files);

}  // namespace glint
