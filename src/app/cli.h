// The command line (docs/reference/command-line.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "bvh/builder.h"
#include "core/progress.h"
#include "render/live_paths.h"
#include "render/traversal_choice.h"
#include "scene/scene.h"
#include "trace/backend.h"
#include "trace/methods.h"
#include "trace/picture.h"

namespace glint::app {

// Runs `glint ARGS...` and returns the exit code; never throws. Results go to `out`, progress, warnings and
// errors to `err`.
int run(const std::vector<std::string>& args, std::ostream& out, std::ostream& err);

struct Size {
    int width = 0, height = 0;
};

struct FilterChoice {
    Filter filter = Filter::Box;
    std::optional<double> radius;  // pixels; empty: the filter's own
};

// Options that several commands share.
struct SceneOptions {
    std::filesystem::path scene;
    std::optional<Size> size;
    std::optional<int> spp;
    std::optional<int> maxDepth;
    BuildQuality buildQuality = BuildQuality::Default;
    Methods methods;
    double minContribution = 0;  // branches that bring less to a pixel's colour are not followed
    std::optional<Sampler> sampler;
    std::optional<FilterChoice> filter;
    std::optional<uint32_t> seed;
    std::optional<AdaptiveSampling> adaptive;
};

struct DeviceChoice {
    std::string selector;
    bool validation = false;
    render::Traversal traversal = render::Traversal::Auto;
};

struct RenderCommand {
    SceneOptions scene;
    std::filesystem::path output;  // empty: the scene's stem with .png, in the current folder
    Backend backend = Backend::Gpu;
    DeviceChoice device;
    std::vector<Aov> aovs = {Aov::Radiance};
    std::optional<Region> crop;
    std::string stats;  // "" or "json"
    ProgressMode progress = ProgressMode::Auto;
    bool quiet = false;
};

struct ViewCommand {
    SceneOptions scene;
    DeviceChoice device;
    uint64_t frames = 0;
    std::filesystem::path script;
    std::string present = "fifo";
    int target = 0;  // milliseconds; 0: by the device
};

struct VerifyCommand {
    std::vector<std::filesystem::path> scenes;
    SceneOptions common;
    DeviceChoice device;
    std::filesystem::path folder = ".";  // of the difference pictures
    ProgressMode progress = ProgressMode::Auto;
};

struct ReportCommand {
    std::vector<std::filesystem::path> scenes;
    std::filesystem::path folder;
    int width = 160;  // pixels
    int repeats = 5;
    int truthSamples = 256;
    Backend truth = Backend::Cpu;
    std::optional<int> budget;      // seconds
    std::vector<std::string> only;  // how the names of families start; empty: all
    DeviceChoice device;
    ProgressMode progress = ProgressMode::Auto;
};

struct BenchCommand {
    std::vector<std::filesystem::path> scenes;
    SceneOptions common;
    Backend backend = Backend::Gpu;
    DeviceChoice device;
    render::Compaction compaction = render::Compaction::Auto;
    int repeats = 7;
    bool everyWalk = false;  // --traversal all
    bool full = false;       // the code of every feature
    SceneFeatures with;      // the code of these features
    std::string stats;       // "" or "json"
    ProgressMode progress = ProgressMode::Auto;
};

struct TraceCommand {
    SceneOptions scene;
    std::string rays;  // a file, "-" for standard input, empty for --pixel
    std::optional<std::pair<int, int>> pixel;
    bool any = false;
    Backend backend = Backend::Gpu;
    DeviceChoice device;
};

struct DiffCommand {
    std::filesystem::path a, b, output;
    double tolerance = 0;
};

int runRender(const RenderCommand& command, std::ostream& out, std::ostream& err);
int runView(const ViewCommand& command, std::ostream& out, std::ostream& err);
int runVerify(const VerifyCommand& command, std::ostream& out, std::ostream& err);
int runReport(const ReportCommand& command, std::ostream& out, std::ostream& err);
int runBench(const BenchCommand& command, std::ostream& out, std::ostream& err);
int runTrace(const TraceCommand& command, std::ostream& out, std::ostream& err);
int runDiff(const DiffCommand& command, std::ostream& out);
int runInfo(const SceneOptions& command, std::ostream& out, std::ostream& err);
int runDevices(std::ostream& out);

}  // namespace glint::app
