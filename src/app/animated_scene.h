// A scene at any moment of its animation.
#pragma once

#include <iosfwd>
#include <optional>
#include <set>
#include <string>

#include "app/option_groups.h"
#include "import/scene_reader.h"
#include "pack/loaded_scene.h"
#include "pack/tree_memory.h"

namespace glint::app {

class AnimatedScene {
  public:
    // Reads and packs the scene as it is at that moment, in seconds; without one, as its file says it.
    // Warnings go to `err`, one line each and each once, unless quiet. `options` and `err` must outlive the
    // object.
    AnimatedScene(const SceneOptions& options, std::optional<double> time, std::ostream& err, bool quiet);

    // The scene of the current frame; its arrays change in place.
    const LoadedScene& loaded() const { return loaded_; }
    LoadedScene take() && { return std::move(loaded_); }

    using Change = SceneReader::Change;
    // Camera: the arrays are those of before. A picture has the bits that it has if the scene is read at that
    // moment.
    Change moveTo(double time);

    // Trees that were built so far.
    uint64_t treesBuilt() const { return memory_.built(); }

  private:
    void pack();
    void warn();

    const SceneOptions& options_;
    std::ostream* err_;  // null: quiet
    std::set<std::string> warned_;
    LoadedScene loaded_;
    std::optional<SceneReader> reader_;
    TreeMemory memory_;
};

}  // namespace glint::app
