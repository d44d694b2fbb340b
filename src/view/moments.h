// A scene file at the moments of its animation, packed for the window with what the panel has changed.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "import/scene_reader.h"
#include "pack/tree_memory.h"
#include "view/edits.h"
#include "view/view_scene.h"

namespace glint::view {

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

    // As it is now, and as it is then with those of `edits` that differ from the file as it was, `before`.
    // What has not moved keeps its tree, and if nothing but the camera has, nothing is packed. Throws
    // Error(Scene) where the animation comes to what is no scene; then the moment before stays.
    Moment show();
    Moment show(std::optional<double> time, const SceneEdits& edits, const SceneEdits& before);

    uint64_t treesBuilt() const { return memory_.built(); }

  private:
    Moment packed(Moment moment);

    std::filesystem::path path_;
    Loading loading_;
    SceneReader reader_;
    std::optional<double> time_;
    TreeMemory memory_;
    bool remembers_ = false, moved_ = true;  // moved: since the last time that it was packed
    std::shared_ptr<const ViewScene> last_;  // that was packed
    SceneEdits lastEdits_;
};

}  // namespace glint::view
