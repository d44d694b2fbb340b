#include <limits>
#include <map>
#include <nlohmann/json.hpp>
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
#include "verify/film.h"
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
               "write NAME.device.png, NAME.reference.png and NAME.difference.png of each scene that fails",
               c.artifacts);
    table.name("--json", "FILE",
               "write verdicts, figures and differing pixels as JSON; - for standard output, instead of text",
               c.jsonFile);
    table.name("--junit", "FILE", "write one JUnit test case a scene", c.junitFile);
    table.whole("--allow", "N", "pass scenes with at most N unexplained pixels (default 0)", 0,
                std::numeric_limits<int>::max(), c.allow);
    table.flag("--brief", "print one line a scene, and a summary", c.brief);
    addSceneOverrides(table, c.common);
    addMethods(table, c.common);
    addMinContribution(table, c.common);
    addSampling(table, c.common);
    addDevice(table, c.device);
    addTraversal(table, c.device);
    addProgress(table, c.progress);
}

// Both images, the differences by rows and together, and the images of the report; without the sums of
// samples.
constexpr uint64_t kBytesPerPixel = sizeof(PixelData) + 17 + 4 + 4 + 3 * 12;

// STEM for each scene, STEM-2 for the second scene of the same stem.
std::vector<std::string> stemsOf(const VerifyCommand& command) {
    std::map<std::string, int> uses;
    std::vector<std::string> stems;
    for (const std::filesystem::path& scene : command.scenes) {
        const std::string stem = scene.stem().string();
        const int use = ++uses[stem];
        stems.push_back(stem + (use > 1 ? "-" + std::to_string(use) : ""));
    }
    return stems;
}

// Schemas may lie beside scenes (scenes/*.json).
bool isSchema(const std::filesystem::path& path) {
    return path.filename().string().ends_with(".schema.json");
}

class SceneVerifier {
  public:
    SceneVerifier(const VerifyCommand& command, const gpu::Device& device, std::ostream& out,
                  std::ostream& err)
        : command_(command), device_(device), out_(out), err_(err) {}

    // A scene that cannot be read has the status Error; other errors are thrown.
    SceneResult verify(const std::filesystem::path& path, const std::string& stem) const {
        SceneResult result;
        result.scene = path.string();
        const Stopwatch watch;
        if (isSchema(path)) {
            result.status = SceneStatus::Skipped;
            result.message = "a JSON schema, not a scene";
        } else {
            try {
                examine(path, stem, result);
            } catch (const Error& error) {
                if (error.kind() != ErrorKind::Scene) throw;
                result.status = SceneStatus::Error;
                result.message = error.what();
                err_ << "glint: " << error.what() << '\n';
            }
        }
        result.seconds = watch.seconds();
        if (command_.brief && !command_.printsJson()) printBrief(path, result);
        return result;
    }

  private:
    void examine(const std::filesystem::path& path, const std::string& stem, SceneResult& result) const {
        SceneOptions sceneOptions = command_.common;
        sceneOptions.scene = path;
        const LoadedScene loaded = loadAndPack(sceneOptions, err_);
        verify::Options options;
        static_cast<Request&>(options) = requestOf(loaded, sceneOptions);
        options.cancelled = interrupted;
        options.allowedUnexplained = static_cast<uint64_t>(command_.allow);
        if (!command_.jsonFile.empty()) options.worstCount = kListedPixels;
        checkMemory(options.width, options.height,
                    kBytesPerPixel + verify::Film::bytesPerPixel(options.samples), availableMemory(), "");
        const verify::Report report = reportOf(path, loaded, options);
        if (report.interrupted)
            throw Error(ErrorKind::Interrupted, "interrupted while verifying " + path.string());
        result.status = report.passed() ? SceneStatus::Passed : SceneStatus::Failed;
        result.message = verdict(report);
        result.facts = reportJson(path.string(), report);
        std::ostringstream details;
        printReport(shown(path), report, options, loaded.packed.origin, details);
        result.details = details.str();
        if (!command_.brief && !command_.printsJson()) out_ << result.details << std::flush;
        if (!command_.artifacts.empty() && !report.passed()) writeArtifacts(command_.artifacts, stem, report);
    }

    verify::Report reportOf(const std::filesystem::path& path, const LoadedScene& loaded,
                            verify::Options& options) const {
        render::Options tracing;
        tracing.traversal = command_.device.traversal;
        tracing.also = alsoFor(loaded, options);
        tracing.cameraRays = cameraRaysOf(options);  // as `render` has it: by the same kernels
        render::Renderer renderer(device_, loaded.packed, tracing);
        Progress progress = progressOf("verify " + path.filename().string(), command_.progress, err_);
        options.progress = [&](double fraction) { progress.update(fraction); };
        return verify::verify(renderer, loaded.packed, cameraOf(loaded, options), options, &loaded.scene);
    }

    void printBrief(const std::filesystem::path& path, const SceneResult& result) const {
        out_ << shown(path) << ": ";
        if (result.status == SceneStatus::Error || result.status == SceneStatus::Skipped)
            out_ << nameOf(result.status)
                 << (result.status == SceneStatus::Skipped ? ": " + result.message : "");
        else
            out_ << result.message << ", " << briefFigures(result.facts) << ", "
                 << formatSeconds(result.seconds);
        out_ << std::endl;
    }

    const VerifyCommand& command_;
    const gpu::Device& device_;
    std::ostream& out_;
    std::ostream& err_;
};

ExitCode run(const VerifyCommand& command, std::ostream& out, std::ostream& err) {
    if (!command.jsonFile.empty() && command.jsonFile == command.junitFile)
        throw Error(ErrorKind::Argument, "--junit: names the file of --json");
    for (const auto& scene : command.scenes) checkScene(scene);  // the last one's name may be misspelt
    if (!command.artifacts.empty()) makeFolder(command.artifacts);
    if (!command.jsonFile.empty() && !command.printsJson()) checkOutputPath(command.jsonFile);
    if (!command.junitFile.empty()) checkOutputPath(command.junitFile);
    const gpu::Device device = openDevice(command.device, false);
    installInterruptHandler();
    if (!command.printsJson())
        out << "device: " << device.info().name << ", " << device.info().driver << '\n';
    const SceneVerifier verifier(command, device, out, err);
    const auto stems = stemsOf(command);
    std::vector<SceneResult> results;
    const auto json = [&] { return jsonText(results, device.info().name, device.info().driver); };
    for (size_t i = 0; i < stems.size(); ++i) {
        results.push_back(verifier.verify(command.scenes[i], stems[i]));
        // After each scene, so that an interrupted run keeps the results so far.
        if (!command.jsonFile.empty() && !command.printsJson()) writeTextFile(command.jsonFile, json());
        if (!command.junitFile.empty()) writeTextFile(command.junitFile, junitText(results));
    }
    if (command.printsJson()) out << json();
    const size_t failed = countOf(results, SceneStatus::Failed),
                 unread = countOf(results, SceneStatus::Error);
    if (command.brief && !command.printsJson())
        out << counted(stems.size(), "scene") << ": " << countOf(results, SceneStatus::Passed) << " passed, "
            << failed << " failed, " << unread << " unreadable, " << countOf(results, SceneStatus::Skipped)
            << " skipped, " << formatSeconds(secondsOf(results)) << '\n';
    reportValidation(device, command.device, err);
    if (failed > 0)
        err << "glint: verify: " << failed << " of " << counted(stems.size(), "scene") << " failed\n";
    if (unread > 0) return ExitCode::Scene;
    return failed > 0 ? ExitCode::Difference : ExitCode::Done;
}

}  // namespace

Run verifyCommand(OptionTable& table) {
    return commandOf<VerifyCommand>(table, declare, run);
}

}  // namespace glint::app
