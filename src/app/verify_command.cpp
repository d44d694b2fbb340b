#include <limits>
#include <optional>
#include <ostream>
#include <sstream>

#include "app/commands.h"
#include "app/common.h"
#include "app/drawing.h"
#include "app/loading.h"
#include "app/verify_report.h"
#include "core/available_memory.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/interrupt.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "pack/request_environment.h"
#include "report/run.h"
#include "verify/verify.h"

namespace glint::app {

namespace {

struct VerifyCommand {
    std::vector<std::filesystem::path> scenes;
    SceneOptions common;
    DeviceChoice device;
    std::filesystem::path artifacts, jsonFile, junitFile;
    int allow = 0;
    bool brief = false;
    ProgressMode progress = ProgressMode::Auto;

    bool printsJson() const { return jsonFile == "-"; }
};

void declare(OptionTable& table, VerifyCommand& c) {
    addScenes(table, c.scenes, c.common.allowOutside);
    table.name("--artifacts", "FOLDER",
               "write NAME.device.png, NAME.reference.png, NAME.difference.png of scenes that fail",
               c.artifacts);
    table.name("--json", "FILE",
               "write verdicts, figures and differing pixels; -: on standard output, instead of text",
               c.jsonFile);
    table.name("--junit", "FILE", "write one JUnit test case per scene", c.junitFile);
    table.whole("--allow", "N", "pass scenes with at most N unexplained pixels (default 0)", 0,
                std::numeric_limits<int>::max(), c.allow);
    table.flag("--brief", "print one line per scene, and a summary", c.brief);
    addSceneOverrides(table, c.common);
    addMethods(table, c.common);
    addMinContribution(table, c.common);
    addSampling(table, c.common);
    addDevice(table, c.device);
    addTraversal(table, c.device);
    addProgress(table, c.progress);
}

// Schemas may lie beside scenes (scenes/*.json).
bool isSchema(const std::filesystem::path& path) {
    return path.filename().string().ends_with(".schema.json");
}

// Checks that all scenes exist before the first is verified, which may take hours. Throws the first error.
void checkScenes(std::vector<SceneResult>& results) {
    std::optional<Error> first;
    for (SceneResult& result : results) {
        try {
            checkScene(result.scene);
        } catch (const Error& error) {
            result.status = SceneStatus::Error;
            result.message = error.what();
            if (!first) first = error;
        }
    }
    if (first) throw *first;
}

verify::Report verifyLoaded(const VerifyCommand& command, const gpu::Device& device,
                            const std::filesystem::path& path, const LoadedScene& loaded,
                            verify::Options& options, std::ostream& err) {
    render::Options tracing;
    tracing.traversal = command.device.traversal;
    tracing.also = alsoFor(loaded, options);
    tracing.cameraRays = cameraRaysOf(options);  // as `render` has it: by the same kernels
    render::Renderer renderer(device, loaded.packed, tracing);
    Progress progress = progressOf("verify " + path.filename().string(), command.progress, err);
    options.progress = [&](double fraction) { progress.update(fraction); };
    return verify::verify(renderer, loaded.packed, cameraOf(loaded, options), options, &loaded.scene);
}

// Sets everything but the scene's name and seconds. Throws Error.
void verifyScene(const VerifyCommand& command, const gpu::Device& device, const std::string& stem,
                 SceneResult& result, std::ostream& err) {
    SceneOptions sceneOptions = command.common;
    sceneOptions.scene = result.scene;
    const LoadedScene loaded = loadAndPack(sceneOptions, err);
    verify::Options options;
    static_cast<Request&>(options) = requestOf(loaded, sceneOptions);
    options.cancelled = interrupted;
    options.allowedUnexplained = static_cast<uint64_t>(command.allow);
    if (!command.jsonFile.empty()) options.worstCount = kListedPixels;
    checkMemory(options.width, options.height,
                verify::bytesPerPixel(options, depthOf(loaded.packed, options)), availableMemory(), "");
    const verify::Report report = verifyLoaded(command, device, result.scene, loaded, options, err);
    if (report.interrupted)
        throw Error(ErrorKind::Interrupted, "interrupted while verifying " + result.scene);
    result.status = report.passed() ? SceneStatus::Passed : SceneStatus::Failed;
    result.message = verdict(report);
    result.brief = briefFigures(report);
    result.facts = reportJson(report);
    std::ostringstream details;
    printReport(printable(result.scene), report, options, loaded.packed.origin, details);
    result.details = details.str();
    if (!command.artifacts.empty() && !report.passed()) writeArtifacts(command.artifacts, stem, report);
}

void print(const VerifyCommand& command, const SceneResult& result, std::ostream& out) {
    if (command.printsJson()) return;
    if (!command.brief) {
        out << result.details << std::flush;
        return;
    }
    out << printable(result.scene) << ": ";
    if (result.status == SceneStatus::Error)
        out << "error";
    else if (result.status == SceneStatus::Skipped)
        out << "skipped: " << result.message;
    else
        out << result.message << ", " << result.brief << ", " << formatSeconds(result.seconds);
    out << std::endl;
}

void checkFiles(const VerifyCommand& command) {
    if (!command.jsonFile.empty() && command.jsonFile == command.junitFile)
        throw Error(ErrorKind::Argument, "--junit: --json writes this file; name another one");
    if (!command.artifacts.empty()) makeFolder(command.artifacts);
    if (!command.jsonFile.empty() && !command.printsJson()) checkOutputPath(command.jsonFile);
    if (!command.junitFile.empty()) checkOutputPath(command.junitFile);
}

// A run over all scenes. Its files always list every scene, as skipped until it has a result.
class Verification {
  public:
    Verification(const VerifyCommand& command, std::ostream& out, std::ostream& err)
        : command_(command), out_(out), err_(err) {
        for (const std::filesystem::path& scene : command.scenes)
            results_.push_back(
                {.scene = scene.string(), .status = SceneStatus::Skipped, .message = "not verified"});
    }

    ExitCode run() {
        try {
            checkScenes(results_);
            verifyAll();
        } catch (...) {
            write();
            if (command_.printsJson()) out_ << json();
            throw;
        }
        if (command_.printsJson()) out_ << json();
        const size_t failed = count(SceneStatus::Failed), unread = count(SceneStatus::Error);
        if (failed > 0)
            err_ << "glint: verify: " << failed << " of " << counted(results_.size(), "scene") << " failed\n";
        if (unread > 0) return ExitCode::Scene;
        return failed > 0 ? ExitCode::Difference : ExitCode::Done;
    }

  private:
    size_t count(SceneStatus status) const { return countOf(results_, status); }
    std::string json() const { return jsonText(results_, device_.name, device_.driver); }

    void write() const {
        if (!command_.jsonFile.empty() && !command_.printsJson()) writeTextFile(command_.jsonFile, json());
        if (!command_.junitFile.empty()) writeTextFile(command_.junitFile, junitText(results_));
    }

    void verifyAll() {
        const gpu::Device device = openDevice(command_.device, false);
        device_ = device.info();
        installInterruptHandler();
        if (!command_.printsJson()) out_ << "device: " << device_.name << ", " << device_.driver << '\n';
        const std::vector<std::string> stems = report::uniqueStems(command_.scenes);
        write();
        for (size_t i = 0; i < results_.size(); ++i) {
            verifyOne(device, stems[i], results_[i]);
            write();  // a killed process leaves the results so far
        }
        if (command_.brief && !command_.printsJson())
            out_ << counted(results_.size(), "scene") << ": " << count(SceneStatus::Passed) << " passed, "
                 << count(SceneStatus::Failed) << " failed, " << count(SceneStatus::Error) << " unreadable, "
                 << count(SceneStatus::Skipped) << " skipped, " << formatSeconds(secondsOf(results_)) << '\n';
        checkValidation(device, command_.device);
    }

    // An invalid scene is a result; other errors end the run.
    void verifyOne(const gpu::Device& device, const std::string& stem, SceneResult& result) {
        const Stopwatch watch;
        if (isSchema(result.scene)) {
            result.message = "a JSON schema, not a scene";
        } else {
            try {
                verifyScene(command_, device, stem, result, err_);
            } catch (const Error& error) {
                if (error.kind() != ErrorKind::Interrupted) result.status = SceneStatus::Error;
                result.message = error.what();
                if (error.kind() != ErrorKind::Scene) throw;
                err_ << "glint: " << error.what() << '\n';
            }
        }
        result.seconds = watch.seconds();
        print(command_, result, out_);
    }

    const VerifyCommand& command_;
    std::ostream& out_;
    std::ostream& err_;
    gpu::DeviceInfo device_;  // empty before it is open
    std::vector<SceneResult> results_;
};

ExitCode run(const VerifyCommand& command, std::ostream& out, std::ostream& err) {
    checkFiles(command);
    return Verification(command, out, err).run();
}

}  // namespace

Run verifyCommand(OptionTable& table) {
    return commandOf<VerifyCommand>(table, declare, run);
}

}  // namespace glint::app
