// Measures the configurations of one scene.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>

#include "gpu/device.h"
#include "pack/loaded_scene.h"
#include "reference/render.h"
#include "render/renderer.h"
#include "report/plan.h"
#include "trace/backend.h"
#include "trace/picture.h"

namespace glint::report {

struct SweepLimits {
    int repeats = 5;
    int truthSamples = 256;
    Backend truth = Backend::Cpu;
    std::function<bool()> late;  // no configuration is started any more
    std::function<bool()> cancelled;
    std::function<bool(const Configuration&)> wanted;
    std::function<void(double)> worked;  // samples times pictures done, for progress
};

class SceneSweep {
  public:
    // `path`: the scene's, for its name and hash; `width`: of the pictures, in pixels, the height follows the
    // scene's proportions.
    SceneSweep(const gpu::Device& device, const std::filesystem::path& path, LoadedScene loaded, int width,
               SweepLimits limits);
    ~SceneSweep();

    const std::vector<Batch>& batches() const { return batches_; }
    // What `worked` sums up to for the configurations of a batch that `report` lacks.
    double work(const Batch& batch, const SceneReport& report) const;
    // Sizes, names, hash; without measurements.
    SceneReport emptyReport() const;
    // Adds what `report` lacks of the batch. False if cancelled, and then what was not finished is missing.
    bool measure(const Batch& batch, SceneReport& report);

  private:
    struct Truth {
        std::vector<glm::dvec3> colors;
        std::vector<uint32_t> paths;
    };
    struct Run;

    Request requestFor(Sampler sampler, int spp, uint32_t seed) const;
    const Truth* truthOf(Sampler sampler, int spp, uint32_t seed);  // null: cancelled
    const Truth* converged();
    render::Renderer& rendererOf(const Configuration& configuration);
    bool renderOnce(Run& run, bool timed);
    bool judge(Run& run, const Picture& picture);
    bool warmUp(const Batch& batch, SceneReport& report, std::vector<Run>& runs);

    const gpu::Device& device_;
    std::filesystem::path path_;
    SweepLimits limits_;
    LoadedScene loaded_;
    shared::Camera camera_;
    std::vector<Batch> batches_;
    std::map<std::tuple<Sampler, int, uint32_t>, Truth> truths_;
    std::unique_ptr<Truth> deviceTruth_;
    std::map<std::string, std::unique_ptr<render::Renderer>> renderers_;  // by what a request cannot vary
};

}  // namespace glint::report
