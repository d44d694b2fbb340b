// `glint report`: error against run time.
#include <algorithm>
#include <ostream>

#include "app/commands.h"
#include "app/rendering.h"
#include "core/enum_names.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "report/plan.h"
#include "report/run.h"
#include "report/write.h"
#include "scene/limits.h"

namespace glint::app {

namespace {

namespace fs = std::filesystem;

constexpr int kSecondsForScene = 60;

struct ReportCommand {
    std::vector<fs::path> scenes;
    SceneOptions common;
    report::Options options;
    std::optional<int> budget;  // seconds
    DeviceChoice device;
    ProgressMode progress = ProgressMode::Auto;
};

void declare(OptionTable& table, ReportCommand& c) {
    addScenes(table, c.scenes, c.common);
    addCameraName(table, c.common);
    table.name("-o,--output", "FOLDER", "folder for report.html, report.csv, report.json and the diagrams",
               c.options.folder);
    table.require("--output");
    table.whole("--size", "WIDTH", "width of the images in pixels (default 256)", 4, 4096, c.options.width);
    table.whole("--repeats", "N", "most runs of each setting (default 10)", 1, 1000, c.options.repeats);
    table.whole("--truth-spp", "N",
                "samples per pixel of the converged image (default: what a third of the time allows)", 2,
                kMaxSamplesPerPixel, c.options.truthSamples);
    table.whole("--budget", "SECONDS", "time for the whole report (default 60 per scene)", 1, 10'000'000,
                c.budget);
    const auto& families = report::familyStarts();
    table.value("--only", "LIST", "settings to measure, with commas: " + joined(families), c.options.only,
                parseFamilies);
    addDevice(table, c.device);
    addProgress(table, c.progress);
}

ExitCode run(const ReportCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch watch;
    checkStandardOutput(out);
    for (const fs::path& scene : command.scenes) checkScene(scene);
    // Compile times are part of the results, so programs are not cached.
    const gpu::Device device = openDevice(command.device, false);
    report::Options options = command.options;
    makeFolder(options.folder);
    installInterruptHandler();
    options.version = GLINT_VERSION;
    options.cancelled = interrupted;
    const double budget = command.budget.value_or(kSecondsForScene * static_cast<int>(command.scenes.size()));
    options.secondsLeft = [&watch, budget] { return budget - watch.seconds(); };
    std::string warning;
    const std::optional<report::Report> earlier = report::earlierReport(options, device.info(), warning);
    if (!warning.empty()) err << "glint: warning: " << warning << '\n';
    std::vector<report::Subject> subjects;
    for (const fs::path& path : command.scenes) {
        SceneOptions scene = command.common;
        scene.scene = path;
        subjects.push_back({path, scene.loading.camera, loadAndPack(scene, err)});
    }
    Progress progress = progressOf("report", command.progress, err);
    options.progress = [&](double fraction) {
        progress.update(std::max(fraction, std::min(watch.seconds() / budget, 0.99)));
    };
    const report::Report report = report::run(device, std::move(subjects), earlier, options);
    progress.finish();
    out << report::toMarkdown(report) << "\nwrote " << shown(options.folder / "report.html")
        << ", report.csv, report.json and the diagrams\n";
    checkValidation(device, command.device);
    if (!report.complete)
        throw Error(ErrorKind::Interrupted, "interrupted: " + (options.folder / "report.json").string() +
                                                " holds the results so far; repeat the command to resume");
    return ExitCode::Done;
}

}  // namespace

Run reportCommand(OptionTable& table) {
    return commandOf<ReportCommand>(table, declare, run);
}

}  // namespace glint::app
