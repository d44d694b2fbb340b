// Measures the settings of one scene.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "bench/measure.h"
#include "gpu/device.h"
#include "pack/loaded_scene.h"
#include "render/renderer.h"
#include "report/plan.h"
#include "trace/picture.h"

namespace glint::report {

class SceneSweep {
  public:
    // The height of the images follows the scene's proportions. `truthSeconds`: for the converged image.
    // `options` must outlive the object.
    SceneSweep(const gpu::Device& device, std::filesystem::path path, LoadedScene loaded,
               const Options& options, double truthSeconds);

    const std::vector<Setting>& settings() const { return settings_; }
    // Sizes, names, hash; without measurements.
    SceneReport emptyReport() const;
    // Bytes of memory for the images, beside the scene itself; a bound.
    uint64_t memory() const;

    // Done: one more run of the setting is in the report. Skipped: no time is left for it, or rounding alone
    // exceeds its --error.
    enum class Outcome { Done, Skipped, Cancelled };
    Outcome run(const Setting& setting, SceneReport& report);

  private:
    // The reference's image of the same samples.
    struct SameSamples {
        std::vector<glm::dvec3> colors;
        std::vector<uint32_t> paths;
    };

    Request requestFor(const Setting& setting, uint32_t seed) const;
    render::Renderer* rendererOf(const Setting& setting);  // null: the reference
    Picture draw(const Setting& setting, const Request& request);
    bench::Timing drawTimed(const Setting& setting, uint32_t seed, Picture& picture);
    double secondsOf(const Setting& setting);
    double predictedSeconds(const Setting& setting, const Measured* known);
    const SameSamples* sameSamples(const Setting& setting);  // null: cancelled
    bool drawTruth(SceneReport& report);                     // false: cancelled, or no time
    bool judgeArithmetic(const Setting& setting, Measured& measured);
    bool addRun(const Setting& setting, Measured& measured, const SceneReport& report);

    const gpu::Device& device_;
    std::filesystem::path path_;
    const Options& options_;
    double truthSeconds_;
    LoadedScene loaded_;
    ImageSettings image_;                    // of the report's images, but for sampler, samples and seed
    uint64_t arrayBytes_ = 0;                // of the scene, for each renderer
    double kappa_ = 0, compileSeconds_ = 0;  // the most for a setting so far
    std::vector<Setting> settings_;
    std::map<std::tuple<Sampler, int>, SameSamples> sameSamples_;
    std::vector<glm::dvec3> converged_;                            // empty before drawTruth
    Image convergedImage_;                                         // the same
    std::map<bool, double> seconds_;                               // by onReference
    std::map<bool, std::unique_ptr<render::Renderer>> renderers_;  // by leaveOut
};

}  // namespace glint::report
