// A scene as the window holds it, at the moments of its animation, and the files that it is made of.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "import/load.h"
#include "pack/build_tree.h"
#include "pack/packed_scene.h"
#include "scene/scene.h"
#include "view/camera_control.h"
#include "view/settings.h"
#include "view/view.h"

namespace glint::view {

struct ViewScene {
    std::filesystem::path path;
    Scene scene;
    PackedScene packed;  // as loaded: every light on
    // Features that the panel may switch on though the scene does without: mirrors, if a material reflects,
    // cameras with parallel rays, and a lens.
    SceneFeatures also;
    bool hasGlass = false;  // a material transmits light
};

// `memory`: of trees, may be null; see pack/build_tree.h.
std::shared_ptr<const ViewScene> packViewScene(const std::filesystem::path& path, Scene scene,
                                               BuildQuality quality, TreeMemory* memory = nullptr);

// Around everything that is finite; around eye and target if nothing is.
Ball boundsOf(const ViewScene& scene);
// Around an object; around `hit` (world), as large as a tenth of the way there, for one without end.
Ball boundsOf(const ViewScene& scene, uint32_t object, const glm::dvec3& hit, double distance);

struct Moment {
    std::optional<double> time;              // seconds; empty: as the file says it
    std::shared_ptr<const Scene> file;       // without the panel's changes
    SceneEdits edits;                        // that `scene` has
    std::shared_ptr<const ViewScene> scene;  // null: as before, the camera aside
};

// For one thread at a time.
class Moments {
  public:
    // Reads the file. Throws Error(Scene) as loadScene does.
    Moments(const std::filesystem::path& path, const Loading& loading, std::optional<double> time);

    // The scene as it is now, or at a time, with those of `edits` that differ from the file as it was,
    // `before`. Geometry that has not moved keeps its tree; if only the camera moves, nothing is packed.
    // Throws Error(Scene) where the animation comes to what is no scene; then the moment before stays.
    Moment show(std::optional<double> time = {}, const SceneEdits& edits = {}, const SceneEdits& before = {});

    uint64_t treesBuilt() const { return memory_.built(); }

  private:
    std::filesystem::path path_;
    Loading loading_;
    SceneReader reader_;
    std::optional<double> time_;
    TreeMemory memory_;
    bool remembers_ = false, moved_ = true;  // moved: since the last time that it was packed
    std::shared_ptr<const ViewScene> last_;  // that was packed
    SceneEdits lastEdits_;
};

// "?" for an unknown index.
std::string objectName(const Scene& scene, uint32_t object);
std::string materialName(const Scene& scene, uint32_t material);

}  // namespace glint::view
