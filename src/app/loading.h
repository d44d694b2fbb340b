// Loads the scene that the command line names, and makes the request for its image.
#pragma once

#include <iosfwd>
#include <optional>
#include <set>
#include <string>

#include "app/options.h"
#include "import/load.h"
#include "pack/build_tree.h"
#include "pack/loaded_scene.h"
#include "trace/request.h"

namespace glint::app {

// A scene at any moment of its animation.
class AnimatedScene {
  public:
    // Reads and packs the scene as it is at that moment, in seconds; without one, as its file says it.
    // Warnings go to `err`, one line each and each once. `options` and `err` must outlive the object.
    AnimatedScene(const SceneOptions& options, std::optional<double> time, std::ostream& err);

    // The scene of the current frame; its arrays change in place.
    const LoadedScene& loaded() const { return loaded_; }
    LoadedScene take() && { return std::move(loaded_); }

    using Change = SceneReader::Change;
    // Camera: the arrays are those of before. An image has the bits that it has if the scene is read at that
    // moment.
    Change moveTo(double time);

    // Trees that were built so far.
    uint64_t treesBuilt() const { return memory_.built(); }

  private:
    void pack();
    void warn();

    const SceneOptions& options_;
    std::ostream& err_;
    std::set<std::string> warned_;
    LoadedScene loaded_;
    std::optional<SceneReader> reader_;
    TreeMemory memory_;
};

// Loads, at a moment of the animation if one is given, and packs; warnings go to `err`, one line each.
LoadedScene loadAndPack(const SceneOptions& options, std::ostream& err);

// Throws Error(Scene) if there is no such file, and names one that is called alike.
void checkScene(const std::filesystem::path& scene);

// The whole image of the scene, with the wishes of the command line. Throws Error(Argument) for sampler,
// samples and filter that contradict each other. `untilError`: --error chooses the number of samples.
Request requestOf(const LoadedScene& loaded, const SceneOptions& options, bool untilError = false);

// Features that a request needs of a device though the scene's own depth does without them.
SceneFeatures alsoFor(const LoadedScene& loaded, const Request& request);

}  // namespace glint::app
