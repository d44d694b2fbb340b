// `glint report`: error against run time.
#include <algorithm>
#include <memory>
#include <ostream>

#include "app/commands.h"
#include "app/common.h"
#include "app/exit_code.h"
#include "app/output_check.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/near_names.h"
#include "core/stopwatch.h"
#include "report/plan.h"
#include "report/run.h"
#include "report/write.h"
#include "scene/limits.h"

namespace glint::app {

namespace {

namespace fs = std::filesystem;

constexpr int kSecondsForScene = 60;
constexpr double kMostByTime = 0.99;  // the last batch may take a little longer

struct ReportCommand {
    std::vector<fs::path> scenes;
    fs::path folder;
    bool allowOutside = false;
    std::string camera;  // by its name; empty: each scene's own
    int width = 256;     // pixels
    int repeats = 10;
    int truthSamples = 0;  // as time allows
    Backend truth = Backend::Cpu;
    std::optional<int> budget;      // seconds
    std::vector<std::string> only;  // how the names of families start; empty: all
    DeviceChoice device;
    ProgressMode progress = ProgressMode::Auto;
};

void declare(OptionTable& table, ReportCommand& c) {
    addScenes(table, c.scenes, c.allowOutside);
    addCamera(table, c.camera);
    table.path("-o,--output", "FOLDER", "for report.html, report.csv, report.json and the diagrams",
               "the folder's name", c.folder, OptionTable::Need::Required);
    table.whole("--size", "WIDTH", "of the pictures in pixels (default 256); the height follows", 4, 4096,
                c.width);
    table.whole("--repeats", "N", "runs of each setting (default 10)", 1, 1000, c.repeats);
    table.whole(
        "--truth-spp", "N",
        "samples for each pixel of the converged picture (default: as many as a third of the time allows)", 2,
        kMaxSamplesPerPixel, c.truthSamples);
    table.choice<Backend>(
        "--truth",
        "who draws the converged picture: the double-precision reference (cpu, default) or the device",
        c.truth);
    table.whole("--budget", "SECONDS",
                "settings that would take longer are left out (default: 60 for each scene)", 0, 10'000'000,
                c.budget);
    const auto& families = report::familyStarts();
    table.value("--only", "LIST",
                "with commas, the settings to measure: " +
                    joinNames(std::vector<std::string_view>(families.begin(), families.end())),
                [&](const std::string& t) { c.only = parseFamilies(t); });
    addDevice(table, c.device);
    addProgress(table, c.progress);
}

void makeFolder(const fs::path& folder) {
    std::error_code error;
    if (!fs::exists(folder, error)) fs::create_directory(folder, error);
    if (error)
        throw Error(ErrorKind::Failed, folder.string() + ": cannot make this folder: " + error.message());
    checkOutputFolder(folder);
}

report::Options optionsOf(const ReportCommand& command) {
    report::Options options;
    options.folder = command.folder;
    options.version = GLINT_VERSION;
    options.width = command.width;
    options.repeats = command.repeats;
    options.truthSamples = command.truthSamples;
    options.truth = command.truth;
    options.only = command.only;
    options.cancelled = interrupted;
    return options;
}

int run(const ReportCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch watch;
    makeFolder(command.folder);
    // What compiling takes is told of each setting.
    const gpu::Device device = openDevice(command.device, false, false);
    installInterruptHandler();
    report::Options options = optionsOf(command);
    const double budget = command.budget.value_or(kSecondsForScene * static_cast<int>(command.scenes.size()));
    options.secondsLeft = [&watch, budget] { return budget - watch.seconds(); };
    std::string warning;
    const std::optional<report::Report> earlier = report::earlierReport(options, device.info(), warning);
    if (!warning.empty()) err << "glint: warning: " << warning << '\n';
    std::vector<report::Subject> subjects;
    for (const fs::path& path : command.scenes) {
        SceneOptions scene;
        scene.scene = path;
        scene.allowOutside = command.allowOutside;
        scene.camera = command.camera;
        subjects.push_back({path, command.camera, loadAndPack(scene, err)});
    }
    Progress progress("report", command.progress, err, isTerminal(err));
    // What the time will not allow is left out, so that it ends then, however much there was to do.
    options.progress = [&](double fraction) {
        const double spent = budget > 0 ? std::min(watch.seconds() / budget, kMostByTime) : 0;
        progress.update(std::max(fraction, spent));
    };
    const report::Report report = report::run(device, std::move(subjects), earlier, options);
    progress.finish();
    out << report::toMarkdown(report) << "\nwrote " << shown(command.folder / "report.html")
        << ", report.csv, report.json and the diagrams\n";
    reportValidation(device, command.device, err);
    if (!report.complete)
        throw Error(ErrorKind::Interrupted, "interrupted: " + (command.folder / "report.json").string() +
                                                " holds what was finished; the same command goes on");
    return static_cast<int>(ExitCode::Done);
}

}  // namespace

Run reportCommand(OptionTable& table) {
    const auto command = std::make_shared<ReportCommand>();
    declare(table, *command);
    return [command](std::ostream& out, std::ostream& err) { return run(*command, out, err); };
}

}  // namespace glint::app
