#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>

#include "app/cli.h"
#include "app/common.h"
#include "core/error.h"
#include "core/image_io.h"
#include "core/interrupt.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "render/renderer.h"

namespace glint::app {

namespace {

struct Outcome {
    Picture picture;
    std::string device, driver;
    render::StageTimes times;
    bool validationFailed = false;
};

// Before anything costly: is what was asked for possible at all?
std::filesystem::path checkedOutput(const RenderCommand& command) {
    std::filesystem::path output = command.output;
    if (output.empty()) output = command.scene.scene.filename().replace_extension(".png");
    if (!isWritableImagePath(output)) {
        throw Error(ExitCode::Usage, output.string() + ": unknown picture format (use .png, .exr, .pfm or .hdr)");
    }
    for (const std::string& name : command.aovs) {
        const auto& known = aovNames();
        if (std::find(known.begin(), known.end(), name) == known.end()) makeLayers({}, {name});
    }
    return output;
}

Region checkedRegion(const RenderCommand& command, const Scene& scene) {
    if (!command.crop) return {0, 0, scene.image.width, scene.image.height};
    const Region& crop = *command.crop;
    if (crop.x1 > scene.image.width || crop.y1 > scene.image.height) {
        throw Error(ExitCode::Usage, "--crop: reaches beyond the picture of " + std::to_string(scene.image.width) + "x" +
                                         std::to_string(scene.image.height) + " pixels");
    }
    return crop;
}

bool needsData(const std::vector<std::string>& aovs) {
    return std::any_of(aovs.begin(), aovs.end(), [](const std::string& name) { return name != "color" && name != "alpha"; });
}

Outcome renderOnDevice(const RenderCommand& command, const LoadedScene& loaded, const Region& region, Progress& progress,
                       std::ostream& err) {
    const gpu::Device device({command.device.selector, command.device.validation});
    Outcome outcome;
    outcome.device = device.info().name;
    outcome.driver = device.info().driver;
    {
        render::Renderer renderer(device, loaded.packed);
        render::RenderSettings settings;
        settings.width = loaded.scene.image.width;
        settings.height = loaded.scene.image.height;
        settings.region = region;
        settings.sampleOffsets = sampleOffsets(loaded.scene.image.samplesPerPixel);
        settings.data = needsData(command.aovs);
        settings.cost = std::find(command.aovs.begin(), command.aovs.end(), "cost") != command.aovs.end();
        settings.progress = [&](double fraction) { progress.update(fraction); };
        settings.cancelled = interrupted;
        const shared::Camera camera =
            packCamera(loaded.scene.camera, settings.width, settings.height, loaded.packed.origin);
        outcome.picture = renderer.render(camera, settings);
        outcome.times = renderer.times();
    }
    outcome.validationFailed = reportValidation(device, command.device, err);
    return outcome;
}

Outcome renderOnHost(const LoadedScene& loaded, const Region& region, Progress& progress) {
    const Stopwatch watch;
    const ImageSettings& image = loaded.scene.image;
    reference::RenderOptions options;
    options.x0 = region.x0;
    options.y0 = region.y0;
    options.x1 = region.x1;
    options.y1 = region.y1;
    options.sampleOffsets = sampleOffsets(image.samplesPerPixel);
    options.progress = [&](double fraction) { progress.update(fraction); };
    options.cancelled = interrupted;
    const shared::Camera camera = packCamera(loaded.scene.camera, image.width, image.height, loaded.packed.origin);
    Outcome outcome;
    outcome.picture = toPicture(reference::render(loaded.packed, camera, image.width, image.height, options));
    outcome.device = "CPU reference (double precision)";
    outcome.driver = std::to_string(defaultThreadCount()) + " threads";
    outcome.times.trace = watch.seconds();
    return outcome;
}

void warnAboutPicture(const Picture& picture, const std::string& scene, std::ostream& err) {
    if (picture.notFinite > 0) {
        err << "glint: warning: " << scene << ": " << picture.notFinite << " pixels are not finite\n";
    }
    if (!picture.complete || picture.color.pixels.empty()) return;
    for (size_t i = 3; i < picture.color.pixels.size(); i += 4) {
        if (picture.color.pixels[i] > 0) return;
    }
    err << "glint: warning: " << scene
        << ": no camera ray hits anything; is the camera looking away, or near/far too tight? (glint info shows the bounds)\n";
}

nlohmann::json statsJson(const Outcome& outcome, const LoadedScene& loaded, double writeSeconds, double totalSeconds,
                         const std::vector<std::filesystem::path>& files) {
    const render::StageTimes& t = outcome.times;
    nlohmann::json json;
    json["device"] = outcome.device;
    json["driver"] = outcome.driver;
    for (const auto& file : files) json["files"].push_back(file.string());
    json["complete"] = outcome.picture.complete;
    json["width"] = outcome.picture.region.width();
    json["height"] = outcome.picture.region.height();
    json["samplesPerPixel"] = loaded.scene.image.samplesPerPixel;
    json["triangles"] = loaded.packed.triangles.size();
    json["spheres"] = loaded.packed.spheres.size();
    json["planes"] = loaded.packed.planes.size();
    json["notFinite"] = outcome.picture.notFinite;
    json["seconds"] = {{"load", loaded.loadSeconds}, {"pack", loaded.packSeconds}, {"upload", t.upload},
                       {"compile", t.compile},       {"trace", t.trace},           {"device", t.device},
                       {"readback", t.readback},     {"write", writeSeconds},      {"total", totalSeconds},
                       {"longestSubmission", t.longestSubmission}};
    json["submissions"] = t.submissions;
    json["slices"] = t.slices;
    json["resumes"] = t.resumes;
    return json;
}

void printSummary(const Outcome& outcome, const LoadedScene& loaded, double writeSeconds, double totalSeconds,
                  const std::vector<std::filesystem::path>& files, std::ostream& out) {
    const render::StageTimes& t = outcome.times;
    for (const auto& file : files) {
        out << "wrote " << file.string() << " (" << outcome.picture.region.width() << "x" << outcome.picture.region.height() << ")\n";
    }
    out << "device: " << outcome.device << ", " << outcome.driver << '\n';
    out << "times: load " << formatSeconds(loaded.loadSeconds) << ", BVH and packing " << formatSeconds(loaded.packSeconds);
    if (t.submissions > 0) {
        out << ", upload " << formatSeconds(t.upload) << ", compile " << formatSeconds(t.compile);
    }
    out << ", trace " << formatSeconds(t.trace);
    if (t.submissions > 0) out << ", readback " << formatSeconds(t.readback);
    out << ", write " << formatSeconds(writeSeconds) << "; " << formatSeconds(totalSeconds) << " in all\n";
}

}  // namespace

int runRender(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch total;
    const std::filesystem::path output = checkedOutput(command);
    const LoadedScene loaded = loadAndPack(command.scene, err, command.quiet);
    const Region region = checkedRegion(command, loaded.scene);
    Outcome outcome;
    {
        Progress progress("render", command.quiet ? ProgressMode::None : command.progress, err, isTerminal(err));
        outcome = command.backend == Backend::Cpu ? renderOnHost(loaded, region, progress)
                                                  : renderOnDevice(command, loaded, region, progress, err);
    }
    if (!command.quiet) warnAboutPicture(outcome.picture, command.scene.scene.string(), err);
    const bool anyDone = std::find(outcome.picture.done.begin(), outcome.picture.done.end(), 1) != outcome.picture.done.end();
    if (!anyDone) throw Error(ExitCode::Interrupted, "interrupted before any part of the picture was finished; nothing written");

    const Stopwatch writing;
    const auto files = writeLayers(output, makeLayers(outcome.picture, command.aovs.empty() ? std::vector<std::string>{"color"} : command.aovs));
    const double writeSeconds = writing.seconds();
    if (command.stats == "json") {
        out << statsJson(outcome, loaded, writeSeconds, total.seconds(), files).dump(2) << '\n';
    } else if (!command.quiet) {
        printSummary(outcome, loaded, writeSeconds, total.seconds(), files, out);
    }
    if (!outcome.picture.complete) {
        throw Error(ExitCode::Interrupted, "interrupted: " + files.front().string() + " holds the part that was finished");
    }
    if (outcome.validationFailed) throw Error(ExitCode::Device, "the validation layer found faults (listed above)");
    return static_cast<int>(ExitCode::Done);
}

}  // namespace glint::app
