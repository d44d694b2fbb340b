// Loads the scene that the command line names, opens devices, and renders on a device or with the reference.
#pragma once

#include <future>
#include <iosfwd>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "app/options.h"
#include "converge/converge.h"
#include "core/error.h"
#include "gpu/device.h"
#include "import/load.h"
#include "pack/build_tree.h"
#include "pack/loaded_scene.h"
#include "reference/model.h"
#include "render/renderer.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace glint::app {

// A scene at any moment of its animation.
class AnimatedScene {
  public:
    // Reads and packs the scene at a time in seconds; without one, as its file states it.
    // Warnings go to `err`, one line each and each once. `options` and `err` must outlive the object.
    AnimatedScene(const SceneOptions& options, std::optional<double> time, std::ostream& err);

    // The scene of the current frame; its arrays change in place. Its camera is that of the last frame that
    // was packed.
    const LoadedScene& loaded() const { return loaded_; }
    const Camera& camera() const { return reader_->scene().camera; }  // of the current frame
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

// Opens the chosen device. Throws Error(Device) too if the requested validation layer is missing.
gpu::Device openDevice(const DeviceChoice& choice, bool keepPrograms = true);

// Throws Error(Device) with the messages of the validation layer, if there are any.
void checkValidation(const gpu::Device& device, const DeviceChoice& choice);

struct DrawingFacts {
    Backend backend = Backend::Gpu;             // that rendered
    std::string device, driver;                 // empty if nothing was rendered
    std::string traversal;                      // empty on the host
    std::optional<gpu::Arithmetic> arithmetic;  // the device's
    render::StageTimes times;
    bool sharesBits() const { return arithmetic && arithmetic->sharesBits(); }
};

// The job of --error for the scene's image; `request` becomes like those of its batches. Empty without
// --error. `backend`: for the rounding error.
std::optional<converge::Job> jobOf(const converge::Target& target, const LoadedScene& loaded, Backend backend,
                                   Request& request);

class Drawing {
  public:
    // Starts to open the device, which needs nothing of the scene (50 ms for lavapipe, whose libraries are
    // large). load() throws the device's errors, so that the scene's errors come first. `choice` must outlive
    // the object.
    explicit Drawing(const DeviceChoice& choice);

    // Uploads the scene, which must outlive its images, and translates kernels for `expected`. The device
    // keeps the programs of kernels that an earlier scene needed too. `cameraRays`: as in render::Options.
    void load(const LoadedScene& loaded, const Request& expected, uint64_t cameraRays = 0);

    // An image of the scene that was loaded.
    Picture draw(const Request& request);

    // Facts of all images so far.
    DrawingFacts facts() const;

    void checkValidation() const;

  private:
    Backend backend_;
    const DeviceChoice& choice_;
    std::future<gpu::Device> opening_;
    std::optional<gpu::Device> device_;
    std::optional<render::Renderer> renderer_;
    const LoadedScene* loaded_ = nullptr;
    std::shared_ptr<reference::Model> truth_;  // the host's model, made for the first image
    Request expected_;
    double hostSeconds_ = 0;
};

}  // namespace glint::app
