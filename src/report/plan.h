// The options of a report, the settings that it measures, and the results.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/available_memory.h"
#include "core/image.h"
#include "core/quartiles.h"
#include "gpu/device.h"
#include "pack/packed_scene.h"
#include "scene/scene.h"
#include "trace/methods.h"
#include "trace/request.h"

namespace glint::report {

struct Options {
    std::filesystem::path folder;   // exists and is writable
    std::string version;            // of the program; a report of another version is not resumed
    int width = 256;                // of the images, in pixels
    int repeats = 10;               // runs of each setting
    int truthSamples = 0;           // per pixel of the converged image; 0: as time allows
    std::vector<std::string> only;  // first words of families; empty: all
    std::function<double()> secondsLeft = [] { return std::numeric_limits<double>::infinity(); };
    std::function<bool()> cancelled = [] { return false; };
    std::function<uint64_t()> memory = [] { return availableMemory(); };  // bytes that may be taken
    std::function<void(double)> progress = [](double) {};                 // share of the runs, 0..1
};

inline constexpr std::array kSamplers = {Sampler::Grid, Sampler::Jittered, Sampler::LowDiscrepancy};

struct Setting {
    std::string family;  // its curve or group: the sampler's name, "triangles: projection", "depth" ...
    Sampler sampler = Sampler::LowDiscrepancy;
    int spp = 4;
    Methods methods;
    PathLimits limits;
    bool leaveOut = true;            // render::Options::leaveOut
    std::optional<double> error;     // instead of `spp` samples: --error
    std::optional<double> contrast;  // adaptive sampling from `spp` samples
    bool onReference = false;        // rendered by the reference, in double precision
};

inline constexpr const char* kDefaultMethods = "default methods";

// A name that no other setting of the plan has: "grid, 4 spp", "depth 2, 4 spp".
std::string keyOf(const Setting& setting);

// True if its rounding error is measured, against the reference's image of the same samples. The rounding
// error does not depend on the number of samples, so settings of more than 4 are left out.
bool hasArithmetic(const Setting& setting);

// In order of importance.
std::vector<Setting> planScene(const SceneFeatures& features, bool hasTree, int sceneDepth);

// The first words of all families, for --only: "grid", ..., "default", "triangles" ...
const std::vector<std::string>& familyStarts();

// Errors of the pixels that count and are finite in both images, as `picture` - truth; all 0 without such a
// pixel.
struct ErrorMeasures {
    uint64_t pixels = 0;
    uint64_t notFinite = 0;  // pixels left out because a channel is not finite
    double rmse = 0;         // root mean square over pixels and channels
    // Mean over pixels and channels of d^2 / (truth^2 + kRelativeFloor), see core/image_diff.h.
    double relMse = 0;
    double max = 0;             // greatest channel of any pixel
    double percentVisible = 0;  // of the pixels, greatest channel above 1/255
    double bias = 0;            // mean over pixels and channels
};

// `truth`: one colour for each pixel of `picture`, row by row; `counts`: which pixels to take, empty for all.
ErrorMeasures measureError(const Image& picture, std::span<const glm::dvec3> truth,
                           std::span<const uint8_t> counts = {});

// Against the double-precision image of the same samples.
struct ArithmeticError {
    ErrorMeasures all, samePath, otherPath;  // by the path of the pixel's first sample
};
ArithmeticError measureArithmetic(const Image& picture, std::span<const uint32_t> paths,
                                  std::span<const glm::dvec3> truth, std::span<const uint32_t> truthPaths);

// A setting and its runs.
struct Measured {
    std::string key, family, sampler;
    int spp = 0, depth = 0;
    double minContribution = 0;
    std::optional<ArithmeticError> arithmetic;
    ErrorMeasures total;         // of the first run, against the converged image
    double error = 0;            // root mean square of all runs' RMSE, less the converged image's own error
    std::optional<double> ssim;  // of the first run (core/image_diff.h); empty for images too small for it
    bool hidden = false;         // `error` is below the converged image's own error
    double samples = 0;          // per pixel, mean
    double asked = 0;            // --error; 0: none
    double bound = 0;            // on the RMSE of the branches that a depth or cut leaves out
    std::vector<double> seconds, rmse, deviceSeconds;  // of each run; device: 0 without timestamps
    double compile = 0;
    uint64_t rays = 0;  // camera and later rays; no shadow rays

    Quartiles wall() const { return quartilesOf(seconds); }
    double median() const { return wall().median; }
};

struct SceneReport {
    std::string path, name, hash;          // hash: of the scene file and the packed scene
    std::string camera;                    // chosen by its name; empty: the scene's own
    int width = 0, height = 0, depth = 0;  // depth: the scene's
    double kappa = 0;
    std::string stiffness;
    int truthSamples = 0;   // per pixel of the converged image
    double truthError = 0;  // its own RMSE, from its two halves of different seeds
    std::vector<Measured> measured;
    std::vector<std::string> leftOut;  // keys
};

struct Report {
    std::string version, device, driver, api;
    unsigned cores = 0;
    int repeats = 0;
    int truthSamples = 0;  // 0: as time allows
    std::vector<SceneReport> scenes;
    bool complete = true;
};

}  // namespace glint::report
