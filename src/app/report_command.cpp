// `glint report`: error against run time.
#include <ostream>

#include "app/cli.h"
#include "app/common.h"
#include "app/exit_code.h"
#include "app/output_check.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/stopwatch.h"
#include "report/run.h"
#include "report/write.h"

namespace glint::app {

namespace {

namespace fs = std::filesystem;

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

}  // namespace

int runReport(const ReportCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch watch;
    makeFolder(command.folder);
    // What compiling takes is told of each setting.
    const gpu::Device device = openDevice(command.device, false, false);
    installInterruptHandler();
    report::Options options = optionsOf(command);
    options.late = [&] { return command.budget && watch.seconds() >= *command.budget; };
    std::string warning;
    const std::optional<report::Report> earlier = report::earlierReport(options, device.info(), warning);
    if (!warning.empty()) err << "glint: warning: " << warning << '\n';
    std::vector<report::Subject> subjects;
    for (const fs::path& path : command.scenes) {
        SceneOptions scene;
        scene.scene = path;
        subjects.push_back({path, loadAndPack(scene, err)});
    }
    Progress progress("report", command.progress, err, isTerminal(err));
    options.progress = [&](double fraction) { progress.update(fraction); };
    const report::Report report = report::run(device, std::move(subjects), earlier, options);
    progress.finish();
    out << report::toMarkdown(report) << "\nwrote " << (command.folder / "report.html").string()
        << ", report.csv, report.json and the diagrams\n";
    reportValidation(device, command.device, err);
    if (!report.complete)
        throw Error(ErrorKind::Interrupted, "interrupted: " + (command.folder / "report.json").string() +
                                                " holds what was finished; the same command goes on");
    return static_cast<int>(ExitCode::Done);
}

}  // namespace glint::app
