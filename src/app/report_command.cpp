// `glint report`: error against run time.
#include <algorithm>
#include <deque>
#include <ostream>
#include <utility>

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
    std::vector<std::string> devices;  // as --device names them, or "cpu"
    ProgressMode progress = ProgressMode::Auto;
};

constexpr const char* kReferenceName = "cpu";  // among --devices

std::vector<std::string> parseDevices(const std::string& text) {
    const std::vector<std::string> names = split(text, ',');
    refuseIf(std::find(names.begin(), names.end(), "") != names.end(),
             "a device's name is empty in " + quoted(text));
    return names;
}

void declare(OptionTable& table, ReportCommand& c) {
    addScenes(table, c.scenes, c.common);
    addCameraName(table, c.common);
    table.name("-o,--output", "FOLDER", "folder for report.html, report.csv, report.json and the diagrams",
               c.options.folder, OptionTable::Need::Required);
    table.whole("--size", "WIDTH", "width of the images in pixels (default 256)", 4, 4096, c.options.width);
    table.whole("--repeats", "N", "most runs of each setting (default 10)", 1, 1000, c.options.repeats);
    table.whole("--truth-spp", "N",
                "samples per pixel of the converged image (default: what a third of the time allows)", 2,
                kMaxSamplesPerPixel, c.options.truthSamples);
    table.choice<Backend>("--truth",
                          "render the converged image with the reference (cpu, default) or the device",
                          c.options.truth);
    table.whole("--budget", "SECONDS", "time for the whole report (default 60 per scene)", 1, 10'000'000,
                c.budget);
    const auto& families = report::familyStarts();
    table.value("--only", "LIST", "settings to measure, with commas: " + joined(families), c.options.only,
                parseFamilies);
    addDevice(table, c.device);
    table.value("--devices", "LIST",
                "devices to compare with that of --device, with commas; cpu is the reference", c.devices,
                parseDevices);
    addProgress(table, c.progress);
}

// The report's own device, and those that it is compared with.
struct OpenDevices {
    std::deque<gpu::Device> open;              // the report's own first
    std::vector<report::DeviceBeside> beside;  // empty without --devices
};

OpenDevices openDevices(const ReportCommand& command) {
    OpenDevices devices;
    const auto open = [&](const std::string& selector) {
        DeviceChoice choice = command.device;
        choice.selector = selector;
        // Compile times are part of the results, so programs are not cached.
        gpu::Device device = openDevice(choice, false, false);
        const gpu::DeviceInfo info = device.info();
        for (const gpu::Device& known : devices.open)
            if (known.info().index == info.index) return;
        devices.open.push_back(std::move(device));
        if (command.devices.empty()) return;
        report::DeviceBeside beside{info.name, info.driver, &devices.open.back()};
        for (const report::DeviceBeside& other : devices.beside)
            if (other.label() == beside.label())  // two of a kind
                beside.name = info.name + " #" + std::to_string(info.index);
        devices.beside.push_back(beside);
    };
    open(command.device.selector);
    bool reference = false;
    for (const std::string& name : command.devices) {
        if (name != kReferenceName)
            open(name);
        else if (!std::exchange(reference, true))
            devices.beside.push_back({"reference", "", nullptr});
    }
    return devices;
}

ExitCode run(const ReportCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch watch;
    const std::vector<std::string>& only = command.options.only;
    refuseIf(std::find(only.begin(), only.end(), "device") != only.end() && command.devices.empty(),
             "--only device requires --devices");
    for (const fs::path& scene : command.scenes) checkScene(scene);
    const OpenDevices devices = openDevices(command);
    const gpu::Device& device = devices.open.front();
    report::Options options = command.options;
    makeFolder(options.folder);
    installInterruptHandler();
    options.version = GLINT_VERSION;
    options.cancelled = interrupted;
    options.devices = devices.beside;
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
    for (const gpu::Device& each : devices.open) checkValidation(each, command.device);
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
