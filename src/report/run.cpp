#include "report/run.h"

#include <algorithm>
#include <map>
#include <memory>
#include <tuple>

#include "core/available_memory.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/parallel.h"
#include "report/front.h"
#include "report/sweep.h"
#include "report/write.h"

namespace glint::report {

namespace {

namespace fs = std::filesystem;

Report freshReport(const Options& options, const gpu::DeviceInfo& device) {
    Report report;
    report.version = options.version;
    report.device = device.name;
    report.driver = device.driver;
    report.api = device.api;
    report.cores = defaultThreadCount();
    report.repeats = options.repeats;
    report.truthSamples = options.truthSamples;
    report.truthBackend = options.truth == Backend::Cpu ? "reference" : "device";
    return report;
}

// What is there of this scene, of the same bytes and size.
SceneReport resumed(const SceneReport& empty, const std::optional<Report>& earlier) {
    if (!earlier) return empty;
    for (const SceneReport& scene : earlier->scenes) {
        if (std::tie(scene.path, scene.camera, scene.hash, scene.width, scene.height) !=
            std::tie(empty.path, empty.camera, empty.hash, empty.width, empty.height))
            continue;
        SceneReport report = scene;
        report.name = empty.name;
        report.leftOut.clear();
        return report;
    }
    return empty;
}

// Scenes of the folder's report that this command does not name stay in it, behind those that it does.
void keepOtherScenes(const Report& earlier, Report& data) {
    for (const SceneReport& scene : earlier.scenes) {
        const bool named = std::any_of(data.scenes.begin(), data.scenes.end(), [&](const SceneReport& s) {
            return s.path == scene.path && s.camera == scene.camera;
        });
        if (named) continue;
        data.scenes.push_back(scene);
        data.scenes.back().name = fs::path(scene.path).stem().string();
    }
}

// knot, knot-2: the diagrams' names.
void makeNamesUnique(std::vector<SceneReport>& scenes) {
    std::map<std::string, int> uses;
    for (SceneReport& scene : scenes) {
        const int use = ++uses[scene.name];
        if (use > 1) scene.name += "-" + std::to_string(use);
    }
}

void writeReport(const fs::path& folder, Report& report) {
    for (SceneReport& scene : report.scenes) markFront(scene);
    std::vector<OutputFile> files;
    const auto add = [&](const std::string& name, const std::string& text) {
        if (!text.empty()) files.push_back({folder / name, {text.begin(), text.end()}});
    };
    add("report.json", toJson(report));
    add("report.csv", toCsv(report));
    add("report.html", toHtml(report));
    for (const SceneReport& scene : report.scenes) {
        add(scene.name + ".precision.svg", precisionDiagram(scene));
        add(scene.name + ".truncation.svg", truncationDiagram(scene));
        add(scene.name + ".devices.svg", devicesDiagram(scene));
    }
    writeFiles(files);
}

// True if all scenes are through.
bool measureAll(const fs::path& folder, std::vector<std::unique_ptr<SceneSweep>>& sweeps, Report& report) {
    size_t most = 0;
    for (const auto& sweep : sweeps) most = std::max(most, sweep->batches().size());
    for (size_t batch = 0; batch < most; ++batch) {
        for (size_t i = 0; i < sweeps.size(); ++i) {
            if (batch >= sweeps[i]->batches().size()) continue;
            if (!sweeps[i]->measure(sweeps[i]->batches()[batch], report.scenes[i])) return false;
            writeReport(folder, report);
        }
    }
    return true;
}

// Of the processor, and of the device where that has its own.
struct Bytes {
    uint64_t host = 0, device = 0;
};

Bytes neededFor(const std::vector<std::unique_ptr<SceneSweep>>& sweeps, int width) {
    Bytes bytes;
    uint64_t passing = 0;
    for (const auto& sweep : sweeps) {
        const MemoryNeed need = sweep->memory(width);
        bytes.host += need.kept;
        passing = std::max(passing, need.passing);
        bytes.device += need.device;
    }
    bytes.host += passing;
    return bytes;
}

void checkMemory(const std::vector<std::unique_ptr<SceneSweep>>& sweeps, const Options& options,
                 const gpu::DeviceInfo& device) {
    const Bytes there{options.memory(), device.limits.memory};
    const auto fits = [&](int width) {
        const Bytes needed = neededFor(sweeps, width);
        return needed.host <= there.host && needed.device <= there.device;
    };
    if (fits(options.width)) return;
    const Bytes needed = neededFor(sweeps, options.width);
    const bool onDevice = needed.host <= there.host;
    int width = 0;  // the greatest that fits
    for (int above = options.width; above - width > 1;) {
        const int middle = (width + above) / 2;
        (fits(middle) ? width : above) = middle;
    }
    throw Error(
        ErrorKind::Failed,
        "pictures " + std::to_string(options.width) +
            " pixels wide, with all that they are compared with, take " +
            gibibytes(onDevice ? needed.device : needed.host) + " of " + (onDevice ? "the device's " : "") +
            "memory, " + gibibytes(onDevice ? there.device : there.host) + " are free; ask for " +
            (width > 0 ? "a smaller --size (" + std::to_string(width) + " fits), or for fewer" : "fewer") +
            " settings (--only) or scenes");
}

SweepLimits limitsOf(const Options& options) {
    SweepLimits limits;
    limits.repeats = options.repeats;
    limits.truthSamples = options.truthSamples;
    limits.truth = options.truth;
    limits.devices = options.devices;
    limits.secondsLeft = options.secondsLeft;
    limits.cancelled = options.cancelled;
    limits.wanted = [&options](const Configuration& c) {
        const auto named = [&](const std::string& family) {
            return std::any_of(options.only.begin(), options.only.end(),
                               [&](const std::string& start) { return family.starts_with(start); });
        };
        if (c.twin > 0) return named("again");
        return options.only.empty() || named(c.family);
    };
    return limits;
}

}  // namespace

std::optional<Report> earlierReport(const Options& options, const gpu::DeviceInfo& device,
                                    std::string& warning) {
    const fs::path path = options.folder / "report.json";
    if (!fs::exists(path)) return std::nullopt;
    const std::vector<uint8_t> bytes = readFile(path);
    Report report = fromJson(std::string(bytes.begin(), bytes.end()), path.string());
    const auto made = [](const Report& r) {
        return std::tie(r.version, r.device, r.driver, r.api, r.cores, r.repeats, r.truthSamples,
                        r.truthBackend);
    };
    if (made(report) == made(freshReport(options, device))) return report;
    warning = path.string() +
              ": made by another version, device, driver, number of cores, number of runs or kind of "
              "converged picture: all of it is measured anew, scenes that are not named are dropped";
    return std::nullopt;
}

Report run(const gpu::Device& device, std::vector<Subject> subjects, const std::optional<Report>& earlier,
           const Options& options) {
    Report report = freshReport(options, device.info());
    double work = 0, worked = 0;
    SweepLimits limits = limitsOf(options);
    limits.truthSeconds = options.secondsLeft() / 3 / static_cast<double>(subjects.size());
    limits.worked = [&](double amount) { options.progress(std::min(1.0, (worked += amount) / work)); };
    std::vector<std::unique_ptr<SceneSweep>> sweeps;
    for (Subject& subject : subjects) {
        sweeps.push_back(std::make_unique<SceneSweep>(device, subject.path, std::move(subject.loaded),
                                                      options.width, limits));
        SceneReport empty = sweeps.back()->emptyReport();
        empty.camera = subject.camera;
        report.scenes.push_back(resumed(empty, earlier));
        work += sweeps.back()->work(report.scenes.back());
    }
    checkMemory(sweeps, options, device.info());
    if (earlier) keepOtherScenes(*earlier, report);
    makeNamesUnique(report.scenes);
    report.complete = measureAll(options.folder, sweeps, report);
    writeReport(options.folder, report);
    return report;
}

}  // namespace glint::report
