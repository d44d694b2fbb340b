// `glint verify`: runs it over scenes, and writes the results as text, JSON, JUnit and images.
#include "app/verify_command.h"

#include <algorithm>
#include <limits>
#include <ostream>
#include <sstream>
#include <utility>

#include "app/commands.h"
#include "app/rendering.h"
#include "core/available_memory.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/image_io.h"
#include "core/interrupt.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "pack/request_environment.h"
#include "report/run.h"
#include "report/write.h"

namespace glint::app {

namespace {

constexpr size_t kPrintedPixels = 10;
constexpr size_t kListedPixels = 1000;  // in the JSON file; the worst first

// Result of one tracer for a pixel.
struct Seen {
    glm::dvec3 color;
    uint32_t pathHash, bounces;
    bool hit;
    uint32_t object = 0, primitive = 0;
    double t = 0;
};

Seen seenBy(const verify::DifferingPixel& pixel) {
    const PixelData& d = pixel.device;
    const bool hit = d.object != PixelData::kNoIndex;
    return {glm::dvec3(pixel.deviceColor), d.pathHash, d.bounces, hit, d.object, d.primitive, d.depth};
}

Seen seenBy(const reference::PixelRecord& r) {
    if (!r.hit || !r.surface) return {r.color, r.pathHash, r.bounces, false};
    return {r.color, r.pathHash, r.bounces, true, r.surface->object, r.surface->primitive, r.hit->t};
}

void printSeen(const char* who, const Seen& s, std::ostream& out) {
    out << format("      %-9s  color (%.6g %.6g %.6g)  ", who, s.color.x, s.color.y, s.color.z)
        << (s.hit ? format("object %u primitive %u t %.9g  ", s.object, s.primitive, s.t) : "miss  ")
        << format("bounces %u path %08x\n", s.bounces, s.pathHash);
}

void printPixel(const verify::DifferingPixel& pixel, bool manySamples, std::ostream& out) {
    out << "    pixel " << pixel.x << ',' << pixel.y;
    if (manySamples) out << " sample " << pixel.sample;
    out << format(": difference %.6g, ", pixel.difference) << nameOf(pixel.reason);
    if (pixel.reason != verify::Reason::Unexplained && pixel.reason != verify::Reason::Undecided)
        out << format(" (%u open decisions, rays moved by at most %.3g x 2^-24)", pixel.openDecisions,
                      pixel.ulps);
    for (const std::string_view name : pixel.quantities)
        out << (name == pixel.quantities.front() ? " (" : ", ") << name;
    out << (pixel.quantities.empty() ? "\n" : ")\n");
    printSeen("device", seenBy(pixel), out);
    printSeen("reference", seenBy(pixel.reference), out);
}

void printRepresentation(const verify::Representation& r, std::ostream& out) {
    out << "    rounding the scene: " << r.asked
        << format(" pixels of the reference, RMSE %.3g, 99th percentile %.3g, max %.3g", r.rmse, r.p99,
                  r.greatest)
        << "; beyond what moved numbers predict: " << r.explained << " explained, " << r.unexplained
        << " unexplained\n";
    for (const verify::RepresentedPixel& pixel : r.worst) {
        if (pixel.explained) continue;
        out << "    pixel " << pixel.x << ',' << pixel.y << " sample " << pixel.sample
            << format(": difference %.6g by packing, unexplained\n", pixel.difference);
        printSeen("packed", seenBy(pixel.rounded), out);
        printSeen("read", seenBy(pixel.truth), out);
    }
}

nlohmann::json seenJson(const Seen& s) {
    nlohmann::json json = {{"color", {s.color.x, s.color.y, s.color.z}},
                           {"hit", s.hit},
                           {"bounces", s.bounces},
                           {"path", s.pathHash}};
    if (s.hit) {
        json["object"] = s.object;
        json["primitive"] = s.primitive;
        json["t"] = s.t;
    }
    return json;
}

nlohmann::json pixelsJson(const verify::Report& report) {
    nlohmann::json pixels = nlohmann::json::array();
    for (const verify::DifferingPixel& pixel : report.worst)
        pixels.push_back({{"x", pixel.x},
                          {"y", pixel.y},
                          {"sample", pixel.sample},
                          {"reason", nameOf(pixel.reason)},
                          {"difference", pixel.difference},
                          {"quantities", pixel.quantities},
                          {"openDecisions", pixel.openDecisions},
                          {"units", pixel.ulps},
                          {"device", seenJson(seenBy(pixel))},
                          {"reference", seenJson(seenBy(pixel.reference))}});
    return pixels;
}

std::string testCase(const SceneResult& result) {
    const auto markup = [](const std::string& text) { return report::escapeMarkup(printable(text)); };
    std::string inside;
    if (result.status != SceneStatus::Passed) {
        const std::string name =
            result.status == SceneStatus::Failed ? "failure" : std::string(nameOf(result.status));
        inside = "\n    <" + name + " message=\"" + markup(result.message) + "\">" +
                 report::escapeMarkup(result.details) + "</" + name + ">\n  ";
    }
    return "  <testcase classname=\"glint.verify\" name=\"" + markup(result.scene) + "\" time=\"" +
           format("%.3f", result.seconds) + "\">" + inside + "</testcase>\n";
}

// In one line: "ok", or "FAILED: " and why.
std::string verdict(const verify::Report& report) {
    if (report.passed()) {
        if (report.unexplained > 0)
            return "ok: " + std::to_string(report.unexplained) + " unexplained, " +
                   std::to_string(report.allowedUnexplained) + " allowed";
        return "ok";
    }
    if (report.unexplained > report.allowedUnexplained) return "FAILED: unexplained pixels";
    if (report.plainDiffers > 0) return "FAILED: the image without layers has other bits";
    if (report.filmDiffers > 0) return "FAILED: the image is not the mean of its samples";
    if (report.lossesDiffer) return "FAILED: device and reference leave out different branches";
    if (report.representation && report.representation->unexplained > 0)
        return "FAILED: the packed scene differs from the scene by more than rounding";
    if (report.explained() <= report.allowedExplained())
        return "FAILED: more pixels are undecided than may differ: their paths take too many steps to "
               "examine";
    return "FAILED: too many pixels differ, though rounding explains each: the method loses digits here";
}

size_t countOf(const std::vector<SceneResult>& results, SceneStatus status) {
    return static_cast<size_t>(
        std::count_if(results.begin(), results.end(), [&](const auto& r) { return r.status == status; }));
}

double secondsOf(const std::vector<SceneResult>& results) {
    double sum = 0;
    for (const SceneResult& result : results) sum += result.seconds;
    return sum;
}

}  // namespace

void printReport(const std::string& scene, const verify::Report& report, bool manySamples,
                 std::ostream& out) {
    const reference::Sensitivity& s = report.sensitivity;
    out << scene << ": " << verdict(report) << "\n    " << report.pixels
        << " pixels; beyond their predicted error: " << report.edges << " edge, " << report.roundings
        << " rounding, " << report.undecided << " undecided (at most " << report.allowedExplained() << "), "
        << report.unexplained << " unexplained\n    sensitivity: " << format("%.3g", s.changedByOne())
        << " of " << s.tried << " pixels change when rays move by 2^-24, " << s.changedWidely
        << " by 32 times that, " << s.open << " by the order of surfaces in one place\n"
        << format("    RMSE %.3g; where the paths agree: RMSE %.3g, max %.3g\n", report.rmse,
                  report.rmseSamePath, report.maxSamePath);
    if (report.plainDiffers > 0)
        out << "    " << report.plainDiffers << " pixels have other bits without layers\n";
    if (report.filmDiffers > 0)
        out << "    " << report.filmDiffers << " pixels are not the mean of the samples that they need\n";
    if (report.lossesDiffer) out << "    other branches are left out, or bounded otherwise\n";
    out << format("    kappa %.2g (%s): expected fp32 error %.2g, measured %.2g (99th percentile)\n", s.kappa,
                  reference::stiffnessOf(s.kappa), s.kappa * reference::kFloatUnit, report.p99);
    if (report.representation) printRepresentation(*report.representation, out);
    for (size_t i = 0; i < std::min(report.worst.size(), kPrintedPixels); ++i)
        printPixel(report.worst[i], manySamples, out);
}

nlohmann::json reportJson(const verify::Report& report) {
    const reference::Sensitivity& s = report.sensitivity;
    nlohmann::json json = {
        {"passed", report.passed()},
        {"pixels", report.pixels},
        {"kappa", s.kappa},
        {"arithmetic",
         {{"rmse", report.rmse},
          {"rmseSamePath", report.rmseSamePath},
          {"maxSamePath", report.maxSamePath},
          {"p99", report.p99},
          {"edge", report.edges},
          {"rounding", report.roundings},
          {"allowed", report.allowedExplained()},
          {"undecided", report.undecided},
          {"unexplained", report.unexplained}}},
        {"plainDiffers", report.plainDiffers},
        {"filmDiffers", report.filmDiffers},
        {"lossesDiffer", report.lossesDiffer ? 1 : 0},
        {"allowedUnexplained", report.allowedUnexplained},
        {"differing", report.explained() + report.unexplained},
        {"differingPixels", pixelsJson(report)},
    };
    if (!report.representation) return json;
    const verify::Representation& r = *report.representation;
    json["representation"] = {
        {"pixels", r.asked}, {"rmse", r.rmse},           {"p99", r.p99},
        {"max", r.greatest}, {"explained", r.explained}, {"unexplained", r.unexplained}};
    return json;
}

std::string jsonText(const std::vector<SceneResult>& results, const std::string& device,
                     const std::string& driver) {
    nlohmann::json file = {{"format", "glint.verify"}, {"version", kVerifyJsonVersion},
                           {"glint", GLINT_VERSION},   {"device", device},
                           {"driver", driver},         {"scenes", nlohmann::json::array()}};
    for (const EnumEntry<SceneStatus>& status : kEnumEntries<SceneStatus>)
        file["summary"][std::string(status.name)] = countOf(results, status.value);
    for (const SceneResult& result : results) {
        nlohmann::json scene = {{"scene", result.scene},
                                {"status", nameOf(result.status)},
                                {"verdict", result.message},
                                {"seconds", result.seconds}};
        if (result.facts.is_object()) scene.update(result.facts);
        file["scenes"].push_back(std::move(scene));
    }
    std::ostringstream text;
    printJson(file, text);
    return text.str();
}

std::string junitText(const std::vector<SceneResult>& results) {
    std::ostringstream out;
    out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"glint verify\" tests=\""
        << results.size() << "\" failures=\"" << countOf(results, SceneStatus::Failed) << "\" errors=\""
        << countOf(results, SceneStatus::Error) << "\" skipped=\"" << countOf(results, SceneStatus::Skipped)
        << "\" time=\"" << format("%.3f", secondsOf(results)) << "\">\n";
    for (const SceneResult& result : results) out << testCase(result);
    out << "</testsuite>\n";
    return out.str();
}

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
    addScenes(table, c.scenes, c.common);
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

// The verdict stands even if its images cannot be written.
void writeArtifacts(const VerifyCommand& command, const std::string& stem, const verify::Report& report,
                    std::ostream& err) {
    const std::pair<const char*, const Image*> images[] = {{".device.png", &report.device},
                                                           {".reference.png", &report.reference},
                                                           {".difference.png", &report.difference}};
    try {
        for (const auto& [name, image] : images) writeImage(command.artifacts / (stem + name), *image);
    } catch (const Error& error) {
        err << "glint: " << error.what() << '\n';
    }
}

// Sets everything but the scene's name and seconds. Throws Error.
void verifyScene(const VerifyCommand& command, const gpu::Device& device, const std::string& stem,
                 SceneResult& result, std::ostream& err) {
    SceneOptions scene = command.common;
    scene.scene = result.scene;
    const LoadedScene loaded = loadAndPack(scene, err);
    verify::Options options;
    static_cast<Request&>(options) = requestOf(loaded, scene);
    options.cancelled = interrupted;
    options.allowedUnexplained = static_cast<uint64_t>(command.allow);
    if (!command.jsonFile.empty()) options.worstCount = kListedPixels;
    checkMemory(options.width, options.height,
                verify::bytesPerPixel(options, depthOf(loaded.packed, options)), availableMemory(), "");
    render::Options tracing;
    tracing.traversal = command.device.traversal;
    tracing.also = alsoFor(loaded, options);
    tracing.cameraRays = cameraRaysOf(options);  // as `render` has it: by the same kernels
    render::Renderer renderer(device, loaded.packed, tracing);
    Progress progress = progressOf("verify " + scene.scene.filename().string(), command.progress, err);
    options.progress = [&](double fraction) { progress.update(fraction); };
    const verify::Report report = verify::verify(renderer, loaded.packed, options, &loaded.scene);
    progress.finish();
    if (report.interrupted)
        throw Error(ErrorKind::Interrupted, "interrupted while verifying " + result.scene);
    result.status = report.passed() ? SceneStatus::Passed : SceneStatus::Failed;
    result.message = verdict(report);
    result.brief = std::to_string(report.pixels) + " pixels, " + std::to_string(report.explained()) +
                   " explained, " + std::to_string(report.unexplained) + " unexplained, RMSE " +
                   format("%.3g", report.rmse);
    result.facts = reportJson(report);
    std::ostringstream details;
    printReport(printable(result.scene), report, options.samples.round > 1, details);
    result.details = details.str();
    if (!command.artifacts.empty() && !report.passed()) writeArtifacts(command, stem, report, err);
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

// Neither file need exist.
bool isSameFile(const std::filesystem::path& a, const std::filesystem::path& b) {
    std::error_code ignored;
    return weakly_canonical(absolute(a, ignored), ignored) == weakly_canonical(absolute(b, ignored), ignored);
}

void checkFiles(const VerifyCommand& command) {
    const auto check = [&](const std::string& option, const std::filesystem::path& file) {
        for (const std::filesystem::path& scene : command.scenes)
            refuseIf(isSameFile(file, scene), option + ": verify reads this file; name another one");
        checkOutputPath(file);
    };
    refuseIf(!command.jsonFile.empty() && isSameFile(command.jsonFile, command.junitFile),
             "--junit: --json writes this file; name another one");
    if (!command.artifacts.empty()) makeFolder(command.artifacts);
    if (!command.jsonFile.empty() && !command.printsJson()) check("--json", command.jsonFile);
    if (!command.junitFile.empty()) check("--junit", command.junitFile);
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
            verifyAll();
        } catch (...) {
            write();
            if (command_.printsJson()) out_ << json();
            throw;
        }
        if (command_.printsJson()) out_ << json();
        const size_t failed = count(SceneStatus::Failed);
        if (failed == 0) return firstError_;
        err_ << "glint: verify: " << failed << " of " << counted(results_.size(), "scene") << " failed\n";
        return ExitCode::Difference;
    }

  private:
    size_t count(SceneStatus status) const { return countOf(results_, status); }
    std::string json() const { return jsonText(results_, device_.name, device_.driver); }

    void write() const {
        if (!command_.jsonFile.empty() && !command_.printsJson()) writeTextFile(command_.jsonFile, json());
        if (!command_.junitFile.empty()) writeTextFile(command_.junitFile, junitText(results_));
    }

    void verifyAll() {
        const gpu::Device device = open();
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
                 << count(SceneStatus::Failed) << " failed, " << counted(count(SceneStatus::Error), "error")
                 << ", " << count(SceneStatus::Skipped) << " skipped, " << formatSeconds(secondsOf(results_))
                 << '\n';
        checkValidation(device, command_.device);
    }

    // Without a device no scene is verified, which JUnit must not count as skipped.
    gpu::Device open() {
        try {
            return openDevice(command_.device);
        } catch (const Error& error) {
            for (SceneResult& result : results_) {
                result.status = SceneStatus::Error;
                result.message = error.what();
            }
            throw;
        }
    }

    // Ctrl-C and errors of the device end the run; all other errors are the scene's result.
    void verifyOne(const gpu::Device& device, const std::string& stem, SceneResult& result) {
        const Stopwatch watch;
        try {
            if (isSchema(result.scene))
                result.message = "a JSON schema, not a scene";
            else
                verifyScene(command_, device, stem, result, err_);
            result.seconds = watch.seconds();
        } catch (const Error& error) {
            result.seconds = watch.seconds();
            result.message = error.what();
            if (error.kind() == ErrorKind::Interrupted) throw;
            result.status = SceneStatus::Error;
            if (error.kind() == ErrorKind::Device) throw;
            const std::string place = printable(result.scene) + ":";
            if (!result.message.starts_with(place)) result.message = place + " " + result.message;
            err_ << "glint: " << result.message << '\n';
            if (firstError_ == ExitCode::Done) firstError_ = exitCodeOf(error.kind());
        }
        print(command_, result, out_);
    }

    const VerifyCommand& command_;
    std::ostream& out_;
    std::ostream& err_;
    gpu::DeviceInfo device_;  // empty before it is open
    std::vector<SceneResult> results_;
    ExitCode firstError_ = ExitCode::Done;  // of a scene
};

ExitCode run(const VerifyCommand& command, std::ostream& out, std::ostream& err) {
    checkStandardOutput(out);
    checkFiles(command);
    return Verification(command, out, err).run();
}

}  // namespace

Run verifyCommand(OptionTable& table) {
    return commandOf<VerifyCommand>(table, declare, run);
}

}  // namespace glint::app
