#include "report/run.h"

#include <algorithm>
#include <map>
#include <memory>
#include <tuple>

#include "core/available_memory.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "report/sweep.h"
#include "report/write.h"

namespace glint::report {

namespace {

namespace fs = std::filesystem;
using Sweeps = std::vector<std::unique_ptr<SceneSweep>>;

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

// The earlier report of a scene of the same bytes and size.
SceneReport resumed(const SceneReport& empty, const std::optional<Report>& earlier) {
    if (!earlier) return empty;
    for (const SceneReport& scene : earlier->scenes) {
        if (std::tie(scene.path, scene.camera, scene.hash, scene.width, scene.height) !=
            std::tie(empty.path, empty.camera, empty.hash, empty.width, empty.height))
            continue;
        SceneReport report = scene;
        report.name = empty.name;
        return report;
    }
    return empty;
}

// Scenes that this command does not name stay in the report, behind those that it does.
void keepOtherScenes(const Report& earlier, Report& report) {
    for (const SceneReport& scene : earlier.scenes) {
        const bool named = std::any_of(report.scenes.begin(), report.scenes.end(), [&](const SceneReport& s) {
            return s.path == scene.path && s.camera == scene.camera;
        });
        if (named) continue;
        report.scenes.push_back(scene);
        report.scenes.back().name = fs::path(scene.path).stem().string();
    }
}

// knot, knot-2: the names of the diagrams.
void makeNamesUnique(std::vector<SceneReport>& scenes) {
    std::map<std::string, int> uses;
    for (SceneReport& scene : scenes) {
        const int use = ++uses[scene.name];
        if (use > 1) scene.name += "-" + std::to_string(use);
    }
}

void writeReport(const fs::path& folder, const Report& report) {
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

bool isDone(const SceneReport& report, const Setting& setting, int runs) {
    const Measured* known = report.find(keyOf(setting));
    return known && static_cast<int>(known->seconds.size()) >= runs;
}

std::string labelOf(const Setting& s) {
    std::string name = s.family;
    if (s.limits.depth) name += " " + std::to_string(*s.limits.depth);
    if (s.limits.minContribution > 0) name += " " + shortNumber(s.limits.minContribution);
    return name + ", " + std::to_string(s.spp) + " spp";
}

void listLeftOut(const Sweeps& sweeps, Report& report) {
    for (size_t i = 0; i < sweeps.size(); ++i) {
        report.scenes[i].leftOut.clear();
        for (const Setting& setting : sweeps[i]->settings())
            if (!isDone(report.scenes[i], setting, 1)) report.scenes[i].leftOut.push_back(labelOf(setting));
    }
}

// False if cancelled.
bool measureAll(const Sweeps& sweeps, Report& report, const Options& options) {
    size_t most = 0;
    double all = 0, done = 0;
    for (const auto& sweep : sweeps) {
        most = std::max(most, sweep->settings().size());
        all += static_cast<double>(sweep->settings().size()) * options.repeats;
    }
    Stopwatch sinceWritten;
    for (int turn = 1; turn <= options.repeats; ++turn)
        for (size_t i = 0; i < most; ++i)
            for (size_t k = 0; k < sweeps.size(); ++k) {
                options.progress(done++ / std::max(all, 1.0));
                if (i >= sweeps[k]->settings().size()) continue;
                const Setting& setting = sweeps[k]->settings()[i];
                if (isDone(report.scenes[k], setting, turn)) continue;
                if (sweeps[k]->run(setting, report.scenes[k]) == SceneSweep::Outcome::Cancelled) return false;
                if (sinceWritten.seconds() < 5) continue;
                listLeftOut(sweeps, report);
                writeReport(options.folder, report);
                sinceWritten.restart();
            }
    return true;
}

void checkMemory(const Sweeps& sweeps, const Options& options) {
    const uint64_t available = options.memory();
    const auto needed = [&](int width) {
        uint64_t bytes = 0;
        for (const auto& sweep : sweeps) bytes += sweep->memory(width);
        return bytes;
    };
    if (needed(options.width) <= available) return;
    int width = options.width;
    while (width > 1 && needed(width) > available) width /= 2;
    throw Error(ErrorKind::Failed,
                "images " + std::to_string(options.width) + " pixels wide may need " +
                    gibibytes(needed(options.width)) + " of memory, " + gibibytes(available) +
                    " are free: use " +
                    (width > 1 ? "a smaller --size (" + std::to_string(width) + " fits) or fewer scenes"
                               : std::string("fewer scenes")));
}

}  // namespace

std::optional<Report> earlierReport(const Options& options, const gpu::DeviceInfo& device,
                                    std::string& warning) {
    const fs::path path = options.folder / "report.json";
    if (!fs::exists(path)) return std::nullopt;
    const std::vector<uint8_t> bytes = readFile(path);
    Report report = fromJson(std::string(bytes.begin(), bytes.end()), path.string());
    const auto made = [](const Report& r) {
        return std::tie(r.version, r.device, r.driver, r.api, r.cores, r.truthSamples, r.truthBackend);
    };
    if (made(report) == made(freshReport(options, device))) return report;
    warning = path.string() +
              ": made by another version, device, driver, number of cores or kind of converged image: "
              "everything is measured again, scenes that are not named are dropped";
    return std::nullopt;
}

Report run(const gpu::Device& device, std::vector<Subject> subjects, const std::optional<Report>& earlier,
           const Options& options) {
    Report report = freshReport(options, device.info());
    const double truthSeconds = options.secondsLeft() / 3 / static_cast<double>(subjects.size());
    Sweeps sweeps;
    for (Subject& subject : subjects) {
        sweeps.push_back(std::make_unique<SceneSweep>(device, subject.path, std::move(subject.loaded),
                                                      options, truthSeconds));
        SceneReport empty = sweeps.back()->emptyReport();
        empty.camera = subject.camera;
        report.scenes.push_back(resumed(empty, earlier));
    }
    checkMemory(sweeps, options);
    if (earlier) keepOtherScenes(*earlier, report);
    makeNamesUnique(report.scenes);
    report.complete = measureAll(sweeps, report, options);
    listLeftOut(sweeps, report);
    for (size_t i = 0; i < sweeps.size() && report.complete; ++i)
        if (report.scenes[i].measured.empty())
            throw Error(ErrorKind::Failed,
                        report.scenes[i].path + ": nothing was measured: " +
                            (sweeps[i]->settings().empty() ? "no setting of --only applies to this scene"
                                                           : "use a larger --budget or a smaller --size"));
    writeReport(options.folder, report);
    return report;
}

}  // namespace glint::report
