// `glint report`: measures, keeps what is done, writes it out.
#include <algorithm>
#include <map>
#include <ostream>

#include "app/cli.h"
#include "app/exit_code.h"
#include "app/output_check.h"
#include "app/report_front.h"
#include "app/report_sweep.h"
#include "app/report_write.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/interrupt.h"
#include "core/parallel.h"

namespace glint::app {

namespace {

namespace fs = std::filesystem;

fs::path jsonPath(const ReportCommand& command) {
    return command.folder / "report.json";
}

ReportData freshReport(const ReportCommand& command, const gpu::DeviceInfo& device) {
    ReportData data;
    data.version = GLINT_VERSION;
    data.device = device.name;
    data.driver = device.driver;
    data.api = device.api;
    data.cores = defaultThreadCount();
    data.repeats = command.repeats;
    data.truthSamples = command.truthSamples;
    data.truthBackend = command.truth == Backend::Cpu ? "reference" : "device";
    return data;
}

// An earlier report in the folder, if it was made in the same way; else none of it can be used again, which
// is said.
std::optional<ReportData> earlierReport(const ReportCommand& command, const ReportData& fresh,
                                        std::ostream& err) {
    const fs::path path = jsonPath(command);
    if (!fs::exists(path)) return std::nullopt;
    const std::vector<uint8_t> bytes = readFile(path);
    ReportData data = fromJson(std::string(bytes.begin(), bytes.end()), path.string());
    const auto made = [](const ReportData& d) {
        return std::tie(d.version, d.device, d.driver, d.api, d.cores, d.repeats, d.truthSamples,
                        d.truthBackend);
    };
    if (made(data) == made(fresh)) return data;
    err << "glint: warning: " << path.string()
        << ": made by another version, device, driver, number of cores, --repeats or --truth: all of it is "
           "measured anew, scenes that are not named are dropped\n";
    return std::nullopt;
}

// What is there of this scene, of the same bytes and size.
SceneReport resumed(const SceneReport& empty, const std::optional<ReportData>& earlier) {
    if (!earlier) return empty;
    for (const SceneReport& scene : earlier->scenes) {
        if (std::tie(scene.path, scene.hash, scene.width, scene.height) !=
            std::tie(empty.path, empty.hash, empty.width, empty.height))
            continue;
        SceneReport report = scene;
        report.name = empty.name;
        report.leftOut.clear();
        return report;
    }
    return empty;
}

// Scenes of the folder's report that this command does not name stay in it, behind those that it does.
void keepOtherScenes(const ReportData& earlier, ReportData& data) {
    for (const SceneReport& scene : earlier.scenes) {
        const bool named = std::any_of(data.scenes.begin(), data.scenes.end(),
                                       [&](const SceneReport& s) { return s.path == scene.path; });
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

void writeReport(const ReportCommand& command, ReportData& data) {
    for (SceneReport& scene : data.scenes) markFront(scene);
    std::vector<OutputFile> files;
    const auto add = [&](const std::string& name, const std::string& text) {
        if (!text.empty()) files.push_back({command.folder / name, {text.begin(), text.end()}});
    };
    add("report.json", toJson(data));
    add("report.csv", toCsv(data));
    add("report.html", toHtml(data));
    for (const SceneReport& scene : data.scenes) {
        add(scene.name + ".precision.svg", precisionDiagram(scene));
        add(scene.name + ".truncation.svg", truncationDiagram(scene));
    }
    writeFiles(files);
}

// True if all scenes are through.
bool measureAll(const ReportCommand& command, std::vector<std::unique_ptr<SceneSweep>>& sweeps,
                ReportData& data) {
    constexpr size_t kBatches = 3;  // see planScene
    for (size_t batch = 0; batch < kBatches; ++batch) {
        for (size_t i = 0; i < sweeps.size(); ++i) {
            if (!sweeps[i]->measure(sweeps[i]->batches()[batch], data.scenes[i])) return false;
            writeReport(command, data);
        }
    }
    return true;
}

void makeFolder(const fs::path& folder) {
    std::error_code error;
    if (!fs::exists(folder, error)) fs::create_directory(folder, error);
    if (error)
        throw Error(ErrorKind::Failed, folder.string() + ": cannot make this folder: " + error.message());
    checkOutputFolder(folder);
}

}  // namespace

int runReport(const ReportCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch watch;
    makeFolder(command.folder);
    // What compiling takes is told of each setting.
    const gpu::Device device({command.device.selector, command.device.validation, {}, false});
    installInterruptHandler();
    ReportData data = freshReport(command, device.info());
    const std::optional<ReportData> earlier = earlierReport(command, data, err);

    double work = 0, worked = 0;
    std::unique_ptr<Progress> progress;
    SweepLimits limits;
    limits.repeats = command.repeats;
    limits.truthSamples = command.truthSamples;
    limits.truth = command.truth;
    limits.late = [&] { return command.budget && watch.seconds() >= *command.budget; };
    limits.cancelled = interrupted;
    limits.wanted = [&](const Configuration& c) {
        return command.only.empty() ||
               std::any_of(command.only.begin(), command.only.end(),
                           [&](const std::string& start) { return c.family.starts_with(start); });
    };
    limits.worked = [&](double amount) { progress->update(std::min(1.0, (worked += amount) / work)); };
    std::vector<std::unique_ptr<SceneSweep>> sweeps;
    for (const fs::path& path : command.scenes) {
        sweeps.push_back(std::make_unique<SceneSweep>(device, path, command.width, limits, err));
        data.scenes.push_back(resumed(sweeps.back()->emptyReport(), earlier));
        for (const Batch& batch : sweeps.back()->batches())
            work += sweeps.back()->work(batch, data.scenes.back());
    }
    if (earlier) keepOtherScenes(*earlier, data);
    makeNamesUnique(data.scenes);
    progress = std::make_unique<Progress>("report", command.progress, err, isTerminal(err));
    data.complete = measureAll(command, sweeps, data);
    progress->finish();
    writeReport(command, data);
    out << toMarkdown(data);
    out << "\nwrote " << (command.folder / "report.html").string()
        << ", report.csv, report.json and the diagrams\n";
    reportValidation(device, command.device, err);
    if (!data.complete)
        throw Error(ErrorKind::Interrupted, "interrupted: " + jsonPath(command).string() +
                                                " holds what was finished; the same command goes on");
    return static_cast<int>(ExitCode::Done);
}

}  // namespace glint::app
