// What `glint report` measures: configurations in order of importance, and what is known of each.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/quartiles.h"
#include "gpu/compute.h"
#include "gpu/device.h"
#include "pack/packed_scene.h"
#include "report/measures.h"
#include "report/statistics.h"
#include "scene/scene.h"
#include "trace/methods.h"

namespace glint::report {

// Those that are compared: Auto is one of them.
inline constexpr std::array kSamplers = {Sampler::Grid, Sampler::Jittered, Sampler::LowDiscrepancy};

struct Configuration {
    std::string family;  // the curve it belongs to: the sampler's name of the default, else what differs
    Sampler sampler = Sampler::LowDiscrepancy;
    int spp = 4;
    Methods methods;
    std::optional<int> maxDepth;  // empty: the scene's
    double minContribution = 0;
    bool leaveOut = true;
    bool rayByRay = false;  // in the binary tree, where the device and the scene would take another way
    std::optional<gpu::Access> access;  // empty: by the device
    // In place of `spp` samples: until the error is at most this (converge/converge.h); by contrast, at least
    // `spp` and at most the image's own most.
    std::optional<double> error, contrast;
    // In place of the box: another picture, so it is judged by the differences of its own runs.
    std::optional<Filter> filter;
    bool onReference = false;  // drawn by the reference, in double
    std::string on;            // DeviceBeside::label of who draws; empty: the report's own device
    int twin = 0;              // the default once more, under another name
};

// A device that is set beside the report's own.
struct DeviceBeside {
    std::string name, driver;
    const gpu::Device* device = nullptr;  // null: the reference
    std::string label() const { return driver.empty() ? name : name + ", " + driver; }
};
inline constexpr const char* kOnDevice = "device: ";  // its settings' family is this and its name

// The default, measured once more in turns with the methods that it is compared with.
inline constexpr const char* kDefaultAmongMethods = "default methods";

// All that decides picture and time, as text, e.g. "grid 4 watertight robust gamma7 errorBox depth=scene
// cut=0 pruned auto".
std::string keyOf(const Configuration& configuration);

// Without what a renderer is told anew for each picture.
Configuration machineKind(Configuration configuration);

// Whether its rounding is measured, against a picture in double precision of the very same samples. Rounding
// does not grow with their number, so few are enough; and other kinds of picture say nothing about it.
bool isJudgedAlone(const Configuration& configuration);

// Configurations that are measured in turns, one run each at a time, so that a busy minute hits all alike. A
// batch is measured as a whole or not at all.
struct Batch {
    std::string name;
    std::vector<Configuration> configurations;
};

// Batches, most important first. `otherAccess`: the way of loading that the device would not choose, if it
// has it; `packets`: true if the default methods use packets of rays or wide nodes, which lack some of the
// other methods; `devices`: devices to compare, possibly empty.
std::vector<Batch> planScene(const SceneFeatures& features, bool hasTree, int maxDepth,
                             std::optional<gpu::Access> otherAccess, bool packets,
                             const std::vector<DeviceBeside>& devices = {});

// What the names of all families that there are start with, in order of measurement: "grid", ..., "default",
// "triangles" ...
const std::vector<std::string>& familyStarts();

struct Measured {
    std::string key, batch, family, sampler;
    int spp = 0, depth = 0;
    double minContribution = 0;
    std::optional<ArithmeticError> arithmetic;  // not of many samples
    ErrorMeasures total;                        // of the first run, against the converged picture
    double error = 0;  // root mean square of all runs' RMSE, without what the converged picture errs itself
    // Of the first run beside the converged picture (core/similarity.h); empty of pictures too small for it.
    std::optional<double> ssim;
    bool hidden = false;  // that error is below what the converged picture can tell
    double samples = 0;   // of a pixel, in the mean
    double asked = 0;     // the error that was asked for; 0: none was
    double bound = 0;     // on the RMSE of what a depth or cut leaves out, by the picture's own account
    std::vector<double> seconds, rmse;  // of each run; runs of one number in a batch took turns
    Quartiles wall, device;             // seconds; device: 0 without timestamps
    double compile = 0, upload = 0, readback = 0;
    uint64_t rays = 0;  // camera and later rays of the paths; not shadow rays
    int repeats = 0;
    bool isDefault = false;  // see markFront (report/front.h)
    std::string beatenBy;    // key
};

struct SceneReport {
    std::string path, name, hash;  // hash: of the scene file and the packed scene
    std::string camera;            // that was chosen by its name; empty: the scene's own
    int width = 0, height = 0, maxDepth = 0;
    double kappa = 0;
    std::string stiffness;
    std::string contents;        // "mirrors, glass, lens", what makes it dear
    std::string defaultSampler;  // the scene's; "auto" if it names none
    int truthSamples = 0;        // of each pixel of the converged picture
    double truthError = 0;       // its own RMSE, by its two halves of different seeds
    std::vector<Measured> measured;
    std::vector<std::string> leftOut;  // batches

    const Measured* find(const std::string& key) const;
};

struct Report {
    std::string version, device, driver, api;
    unsigned cores = 0;
    int repeats = 0;
    int truthSamples = 0;      // 0: as time allows
    std::string truthBackend;  // "reference" or "device"
    std::vector<SceneReport> scenes;
    bool complete = true;
};

}  // namespace glint::report
