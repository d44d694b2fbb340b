#include "report/run.h"

#include <algorithm>
#include <memory>
#include <set>
#include <tuple>

#include "core/error.h"
#include "core/file_io.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
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
    return report;
}

// The earlier report of a scene of the same bytes and size.
SceneReport resumed(const SceneReport& empty, const std::optional<Report>& earlier) {
    const auto identity = [](const SceneReport& s) {
        return std::tie(s.path, s.camera, s.hash, s.width, s.height);
    };
    if (earlier)
        for (const SceneReport& scene : earlier->scenes)
            if (identity(scene) == identity(empty)) return scene;
    return empty;
}

// Scenes that this command does not name stay in the report, behind those that it does.
void keepOtherScenes(const Report& earlier, Report& report) {
    for (const SceneReport& scene : earlier.scenes) {
        const bool named = std::any_of(report.scenes.begin(), report.scenes.end(), [&](const SceneReport& s) {
            return s.path == scene.path && s.camera == scene.camera;
        });
        if (!named) report.scenes.push_back(scene);
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
    }
    writeFiles(files);
}

bool isDone(const SceneReport& report, const Setting& setting, int runs) {
    return std::any_of(report.measured.begin(), report.measured.end(),
                       [&, key = keyOf(setting)](const Measured& m) {
                           return m.key == key && static_cast<int>(m.seconds.size()) >= runs;
                       });
}

void listLeftOut(const Sweeps& sweeps, Report& report) {
    for (size_t i = 0; i < sweeps.size(); ++i) {
        report.scenes[i].leftOut.clear();
        for (const Setting& setting : sweeps[i]->settings())
            if (!isDone(report.scenes[i], setting, 1)) report.scenes[i].leftOut.push_back(keyOf(setting));
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

void checkMemory(const Sweeps& sweeps, uint64_t available) {
    uint64_t needed = 0;
    for (const auto& sweep : sweeps) needed += sweep->memory();
    requireMemory("the report", needed, available, "use a smaller --size or fewer scenes");
}

}  // namespace

std::vector<std::string> uniqueStems(const std::vector<fs::path>& files) {
    std::set<std::string> taken;
    std::vector<std::string> stems;
    for (const fs::path& file : files) {
        const std::string stem = file.stem().string();
        std::string name = stem;
        for (int use = 2; !taken.insert(name).second; ++use) name = stem + "-" + std::to_string(use);
        stems.push_back(name);
    }
    return stems;
}

std::optional<Report> earlierReport(const Options& options, const gpu::DeviceInfo& device,
                                    std::string& warning) {
    const fs::path path = options.folder / "report.json";
    if (!fs::exists(path)) return std::nullopt;
    Report report = fromJson(readWholeFile(path, {}, ErrorKind::Failed), path.string());
    const auto made = [](const Report& r) {
        return std::tie(r.version, r.device, r.driver, r.api, r.cores, r.truthSamples);
    };
    if (made(report) == made(freshReport(options, device))) return report;
    warning = path.string() +
              ": made by another version, device, driver, number of cores or samples of the converged image: "
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
    checkMemory(sweeps, options.memory());
    if (earlier) keepOtherScenes(*earlier, report);
    std::vector<fs::path> paths;
    for (const SceneReport& scene : report.scenes) paths.emplace_back(scene.path);
    const std::vector<std::string> names = uniqueStems(paths);
    for (size_t i = 0; i < names.size(); ++i) report.scenes[i].name = names[i];
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
