#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>

#include "app/commands.h"
#include "app/common.h"
#include "app/exit_code.h"
#include "app/output_check.h"
#include "app/verify_report.h"
#include "core/available_memory.h"
#include "core/error.h"
#include "core/image_io.h"
#include "core/interrupt.h"
#include "core/text_file.h"
#include "verify/film.h"
#include "verify/verify.h"

namespace glint::app {

namespace {

struct VerifyCommand {
    std::vector<std::filesystem::path> scenes;
    SceneOptions common;
    DeviceChoice device;
    std::filesystem::path folder = ".";  // of the difference pictures
    bool json = false;                   // --stats
    ProgressMode progress = ProgressMode::Auto;
};

void declare(OptionTable& table, VerifyCommand& c) {
    addScenes(table, c.scenes, c.common.allowOutside);
    table.path("-o,--output", "FOLDER", "for the difference pictures NAME.verify.png (default: here)",
               "the folder's name", c.folder);
    addSceneOverrides(table, c.common);
    addCamera(table, c.common);
    addTime(table, c.common);
    addMethods(table, c.common);
    addMinContribution(table, c.common);
    addSampling(table, c.common);
    addDevice(table, c.device);
    addTraversal(table, c.device);
    addStats(table, "verdicts and figures as JSON on standard output, instead of text", c.json);
    addProgress(table, c.progress);
}

// Both pictures, the differences by rows and together, and the difference picture; without the sums of
// samples.
constexpr uint64_t kBytesPerPixel = sizeof(PixelData) + 17 + 4 + 4 + 12;

// STEM.verify.png for each scene; STEM-2.verify.png for the second scene of the same stem.
std::vector<std::filesystem::path> pictureNames(const VerifyCommand& command) {
    std::map<std::string, int> uses;
    std::vector<std::filesystem::path> names;
    for (const std::filesystem::path& scene : command.scenes) {
        const std::string stem = scene.stem().string();
        const int use = ++uses[stem];
        const std::string name = stem + (use > 1 ? "-" + std::to_string(use) : "") + ".verify.png";
        names.push_back((command.folder / name).lexically_normal());
    }
    return names;
}

bool verifyScene(const VerifyCommand& command, const std::filesystem::path& path,
                 const std::filesystem::path& picture, const gpu::Device& device, nlohmann::json& results,
                 std::ostream& out, std::ostream& err) {
    SceneOptions sceneOptions = command.common;
    sceneOptions.scene = path;
    const LoadedScene loaded = loadAndPack(sceneOptions, err);
    verify::Options options;
    static_cast<Request&>(options) = requestOf(loaded, sceneOptions);
    options.cancelled = interrupted;
    checkMemory(options.width, options.height, kBytesPerPixel + verify::Film::bytesPerPixel(options.samples),
                availableMemory(), "");
    render::Options tracing;
    tracing.traversal = command.device.traversal;
    tracing.cameraRays = cameraRaysOf(options);  // as `render` has it: by the same kernels
    render::Renderer renderer(device, loaded.packed, tracing);
    verify::Report report;
    {
        Progress progress("verify " + path.filename().string(), command.progress, err, isTerminal(err));
        options.progress = [&](double fraction) { progress.update(fraction); };
        report = verify::verify(renderer, loaded.packed, cameraOf(loaded), options, &loaded.scene);
    }
    if (report.interrupted)
        throw Error(ErrorKind::Interrupted, "interrupted while verifying " + path.string());
    writeImage(picture, report.difference);
    if (command.json) {
        results.push_back(reportJson(path.string(), report));
        return report.passed();
    }
    printReport(shown(path), report, options, loaded.packed.origin, out);
    out << "    wrote " << shown(picture) << '\n';
    out.flush();
    return report.passed();
}

int run(const VerifyCommand& command, std::ostream& out, std::ostream& err) {
    checkOutputFolder(command.folder);
    for (const auto& scene : command.scenes) checkFile(scene);  // the last one's name may be misspelt
    const gpu::Device device = openDevice(command.device, false);
    installInterruptHandler();
    if (!command.json) out << "device: " << device.info().name << ", " << device.info().driver << '\n';
    nlohmann::json results = nlohmann::json::array();
    const auto pictures = pictureNames(command);
    size_t failed = 0;
    for (size_t i = 0; i < pictures.size(); ++i) {
        if (!verifyScene(command, command.scenes[i], pictures[i], device, results, out, err)) ++failed;
    }
    if (command.json)
        out << nlohmann::json{{"device", device.info().name},
                              {"driver", device.info().driver},
                              {"scenes", std::move(results)}}
                   .dump(2)
            << '\n';
    reportValidation(device, command.device, err);
    if (failed == 0) return static_cast<int>(ExitCode::Done);
    err << "glint: verify: " << failed << " of " << counted(command.scenes.size(), "scene") << " failed\n";
    return static_cast<int>(ExitCode::Difference);
}

}  // namespace

Run verifyCommand(OptionTable& table) {
    const auto command = std::make_shared<VerifyCommand>();
    declare(table, *command);
    return [command](std::ostream& out, std::ostream& err) { return run(*command, out, err); };
}

}  // namespace glint::app
