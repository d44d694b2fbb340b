// Measures the configurations of one scene.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include "gpu/device.h"
#include "pack/loaded_scene.h"
#include "reference/render.h"
#include "render/renderer.h"
#include "report/plan.h"
#include "trace/backend.h"
#include "trace/picture.h"

namespace glint::report {

struct SweepLimits {
    int repeats = 10;
    int truthSamples = 0;      // 0: as many as truthSeconds allow
    double truthSeconds = 20;  // for the converged picture
    Backend truth = Backend::Cpu;
    std::vector<DeviceBeside> devices;    // that configurations name
    std::function<double()> secondsLeft;  // a batch that would take longer is left out; infinite: none is
    std::function<bool()> cancelled;
    std::function<bool(const Configuration&)> wanted;
    std::function<void(double)> worked;  // what work() counts
};

// Bytes that measuring takes beside the scenes themselves.
struct MemoryNeed {
    uint64_t kept = 0;     // until the report is written
    uint64_t passing = 0;  // at most, of one batch at a time
    uint64_t device = 0;   // at most, of the device's own memory; 0 where that is the processor's
};

// The converged picture in what work() counts, beside samples of pictures.
inline constexpr double kTruthWork = 500;
// Of a pixel, where samples are taken until an error is reached.
inline constexpr double kMostErrorSamples = 1024;

class SceneSweep {
  public:
    // `path`: the scene's, for its name and hash; `width`: of the pictures, in pixels, the height follows the
    // scene's proportions.
    SceneSweep(const gpu::Device& device, const std::filesystem::path& path, LoadedScene loaded, int width,
               SweepLimits limits);
    ~SceneSweep();

    const std::vector<Batch>& batches() const { return batches_; }
    // What `worked` sums up to for all batches that `report` lacks.
    double work(const SceneReport& report) const;
    // Sizes, names, hash; without measurements.
    SceneReport emptyReport() const;
    // Of pictures of that width, whatever `report` has of them.
    MemoryNeed memory(int width) const;
    // Measures the batch, unless `report` has all of it or no time is left for it. False if cancelled, and
    // then all of the batch is missing.
    bool measure(const Batch& batch, SceneReport& report);

  private:
    // A double-precision picture of the very same samples.
    struct Truth {
        std::vector<glm::dvec3> colors;
        std::vector<uint32_t> paths;
    };
    struct Run;

    Request requestFor(const Configuration& configuration, uint32_t seed) const;
    int heightOf(int width) const;
    uint64_t pathBytes(const Configuration& configuration, const Region& region) const;
    const Truth* truthOf(const Configuration& configuration);  // null: cancelled
    bool drawTruth(SceneReport& report);                       // false: cancelled
    int truthSamples(const SceneReport& report);
    Picture drawHalfOfTruth(int samples, uint32_t seed);
    // A run's picture, against the converged one; or, of a filter, against the one of the run before.
    void judgeByTruth(Measured& measured, const Picture& picture) const;
    void judgeByRuns(Run& run, const Picture& picture) const;
    // Of a picture of one sample of each pixel, by who draws the configuration.
    double secondsOf(const Configuration& configuration);
    double predictedSamples(const Configuration& configuration, const SceneReport& report) const;
    bool fits(const Batch& batch, const SceneReport& report);

    const gpu::Device& deviceOf(const Configuration& configuration) const;
    render::Renderer& rendererOf(const Configuration& configuration);
    Run begin(const Configuration& configuration, const SceneReport& report);
    Picture draw(Run& run, uint32_t seed);
    bool judge(Run& run);
    bool warmUp(Run& run);
    bool drawTimed(Run& run, uint32_t seed);
    bool takeTurns(std::vector<Run>& runs);
    void finish(Run& run, const SceneReport& report) const;

    const gpu::Device& device_;
    std::filesystem::path path_;
    SweepLimits limits_;
    LoadedScene loaded_;
    int ownWidth_, ownHeight_;  // of the scene, in whose proportions pictures are
    shared::Camera camera_;
    uint64_t arrayBytes_ = 0;  // of the scene, for each renderer
    gpu::Access access_ = gpu::Access::StorageBuffer;
    std::vector<Batch> batches_;
    std::map<std::tuple<Sampler, int>, Truth> truths_;
    std::vector<glm::dvec3> converged_;      // colours; empty before drawTruth
    Image convergedImage_;                   // the same
    std::map<std::string, double> seconds_;  // secondsOf, by who draws
    double kappa_ = 0;
    std::map<std::string, std::unique_ptr<render::Renderer>> renderers_;  // by what a request cannot vary
};

}  // namespace glint::report
