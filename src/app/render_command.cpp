#include <algorithm>
#include <future>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>

#include "app/commands.h"
#include "app/common.h"
#include "app/error_target.h"
#include "app/exit_code.h"
#include "app/losses.h"
#include "app/output_check.h"
#include "app/picture_advice.h"
#include "core/available_memory.h"
#include "core/error.h"
#include "core/image_io.h"
#include "core/interrupt.h"
#include "core/near_names.h"
#include "core/parallel.h"
#include "core/picture_hash.h"
#include "core/stopwatch.h"
#include "pack/scene_arrays.h"
#include "reference/render.h"
#include "render/renderer.h"
#include "scene/sampling.h"

namespace glint::app {

namespace {

struct RenderCommand {
    SceneOptions scene;
    std::filesystem::path output;  // empty: the scene's stem with .png, in the current folder
    Backend backend = Backend::Gpu;
    DeviceChoice device;
    std::vector<Aov> aovs = {Aov::Radiance};
    std::optional<Region> crop;
    ErrorTarget target;
    bool json = false;  // --stats
    ProgressMode progress = ProgressMode::Auto;
    bool quiet = false;
};

void declare(OptionTable& table, RenderCommand& c) {
    addScene(table, c.scene);
    table.path("-o,--output", "FILE",
               "picture to write: .png .exr .pfm .hdr (default: SCENE's name with .png, here)",
               "the file name", c.output);
    addSceneOverrides(table, c.scene);
    addMethods(table, c.scene);
    addMinContribution(table, c.scene);
    addSampling(table, c.scene);
    addBackend(table, c.backend);
    addDevice(table, c.device);
    addTraversal(table, c.device);
    table.flag(
        "--reproducible",
        "do not rely on the device's quotients and square roots, even where they proved to be correctly "
        "rounded",
        c.device.reproducible);
    table.value("--aov", "LIST",
                "layers, with commas: " + joinNames(kEnumNames<Aov>) +
                    "; an EXR holds them all, other formats get a file for each",
                [&](const std::string& t) { c.aovs = parseAovs(t); });
    table.value("--crop", "x0,y0,x1,y1",
                "only the pixels x0 <= x < x1, y0 <= y < y1, from the top left corner",
                [&](const std::string& t) { c.crop = parseCrop(t); });
    addErrorTarget(table, c.target);
    addStats(table, "times and counts as JSON on standard output, instead of the summary", c.json);
    addProgress(table, c.progress);
    table.flag("-q,--quiet", "print nothing but errors (and what --stats asks for)", c.quiet);
}

struct Outcome {
    Picture picture;
    std::optional<converge::Result> converged;  // its picture is `picture`
    std::string device, driver;
    std::string traversal;                      // empty on the host
    std::optional<gpu::Arithmetic> arithmetic;  // the device's
    render::StageTimes times;
    std::vector<std::filesystem::path> files;
    std::string hash;  // of the picture, as it is written
    double writeSeconds = 0, totalSeconds = 0;
};

bool wants(const RenderCommand& command, Aov aov) {
    return std::find(command.aovs.begin(), command.aovs.end(), aov) != command.aovs.end();
}

bool needsData(const RenderCommand& command) {
    return std::any_of(command.aovs.begin(), command.aovs.end(),
                       [](Aov aov) { return glint::needsData(aov); });
}

std::filesystem::path outputOf(const RenderCommand& command) {
    if (!command.output.empty()) return command.output;
    return command.scene.scene.filename().replace_extension(".png");
}

Region checkedRegion(const RenderCommand& command, const Scene& scene) {
    if (!command.crop) return {0, 0, scene.image.width, scene.image.height};
    const Region& crop = *command.crop;
    if (crop.x1 > scene.image.width || crop.y1 > scene.image.height) {
        throw Error(ErrorKind::Argument, "--crop: reaches beyond the picture of " +
                                             std::to_string(scene.image.width) + "x" +
                                             std::to_string(scene.image.height) + " pixels");
    }
    return crop;
}

// The picture itself and a copy of each layer for the file; what a device or the encoder holds on top is
// bounded or smaller.
uint64_t bytesPerPixel(const RenderCommand& command) {
    return 4 * sizeof(float) + 1 + (needsData(command) ? sizeof(PixelData) : 0) +
           command.aovs.size() * 3 * sizeof(float);
}

Request requestOf(const RenderCommand& command, const LoadedScene& loaded, const Region& region,
                  Progress& progress) {
    Request request = requestOf(loaded, command.scene);
    request.region = region;
    request.data = needsData(command);
    request.cost = wants(command, Aov::Cost);
    request.ledger = loaded.packed.features.transmission || command.json;
    request.progress = [&progress](double fraction) { progress.update(fraction); };
    request.cancelled = interrupted;
    return request;
}

// Draws the request as it is, or as often as the error asked for takes.
Picture drawn(const converge::Draw& draw, const Request& request, const std::optional<converge::Job>& job,
              Outcome& outcome) {
    if (!job) return draw(request);
    converge::Result result = converge::converge(draw, *job);
    Picture picture = std::move(result.picture);
    outcome.converged = std::move(result);
    return picture;
}

// Faults that the validation layer finds are reported once the picture is written.
void renderOnDevice(const gpu::Device& device, const LoadedScene& loaded, const Request& request,
                    const DeviceChoice& choice, const std::optional<converge::Job>& job, Outcome& outcome) {
    outcome.device = device.info().name;
    outcome.driver = device.info().driver;
    render::Options options;
    options.traversal = choice.traversal;
    options.ownArithmetic = choice.reproducible;
    options.expected = &request;
    outcome.arithmetic = device.arithmetic();
    render::Renderer renderer(device, loaded.packed, options);
    outcome.traversal = render::nameOf(renderer.traversal(request.methods));
    const shared::Camera camera = cameraOf(loaded);
    outcome.picture =
        drawn([&](const Request& r) { return renderer.render(camera, r); }, request, job, outcome);
    outcome.times = renderer.times();
}

void renderOnHost(const LoadedScene& loaded, const Request& request, const std::optional<converge::Job>& job,
                  Outcome& outcome) {
    const Stopwatch watch;
    outcome.device = "CPU reference (double precision)";
    outcome.driver = counted(defaultThreadCount(), "thread");
    const shared::Camera camera = cameraOf(loaded);
    outcome.picture = drawn([&](const Request& r) { return reference::render(loaded.packed, camera, r); },
                            request, job, outcome);
    outcome.times.trace = watch.seconds();
}

void warnAboutPicture(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                      std::ostream& err) {
    const Picture& picture = outcome.picture;
    const std::string start = "glint: warning: " + command.scene.scene.string() + ": ";
    if (picture.notFinite > 0) {
        err << start << counted(picture.notFinite, "pixel") << " not finite (NaN or infinite), the first at "
            << picture.firstNotFinite.x << ',' << picture.firstNotFinite.y
            << "; shown black. Is a light of falloff inverseSquare almost on a surface, or far too "
               "bright?\n";
    }
    // That mirrors face each other without end is nothing new.
    if (loaded.packed.features.transmission || command.scene.minContribution > 0)
        warnOfLosses(picture, start, err);
    if (outcome.converged) warnAboutError(command.target, *outcome.converged, start, err);
    if (const auto advice =
            pictureAdvice(picture, loaded.scene, loaded.packed, requestOf(loaded, command.scene)))
        err << start << *advice << '\n';
}

// Of the finished pixels.
nlohmann::json samplesJson(const Picture& picture) {
    uint64_t sum = 0, count = 0;
    uint32_t least = 0, most = 0;
    for (size_t i = 0; i < picture.done.size(); ++i) {
        if (!picture.done[i]) continue;
        const uint32_t taken = picture.samples.empty() ? picture.samplesPerPixel : picture.samples[i];
        least = count == 0 ? taken : std::min(least, taken);
        most = std::max(most, taken);
        sum += taken;
        ++count;
    }
    const double mean = count > 0 ? static_cast<double>(sum) / static_cast<double>(count) : 0;
    return {{"min", least}, {"mean", mean}, {"max", most}};
}

nlohmann::json statsJson(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded) {
    const render::StageTimes& t = outcome.times;
    nlohmann::json json;
    json["scene"] = command.scene.scene.string();
    json["backend"] = nameOf(command.backend);
    json["device"] = outcome.device;
    json["driver"] = outcome.driver;
    if (!outcome.traversal.empty()) json["traversal"] = outcome.traversal;
    json["files"] = nlohmann::json::array();
    for (const auto& file : outcome.files) json["files"].push_back(file.string());
    json["hash"] = outcome.hash;
    json["reproducible"] = outcome.arithmetic && outcome.arithmetic->sharesBits();
    json["complete"] = outcome.picture.complete;
    json["width"] = outcome.picture.region.width();
    json["height"] = outcome.picture.region.height();
    json["samplesPerPixel"] = loaded.scene.image.samplesPerPixel;
    json["sampler"] = nameOf(samplerOf(loaded.scene.image));
    json["samplesTaken"] = samplesJson(outcome.picture);
    json["maxDepth"] = loaded.scene.maxDepth;
    visitKinds(loaded.packed, [&](const KindCount& kind) {
        if (kind.kind != shared::PrimitiveKind::Instance) json[kind.array] = kind.count;
    });
    json["intersector"] = nameOf(command.scene.methods.triangles);
    json["sphere"] = nameOf(command.scene.methods.spheres);
    if (outcome.converged) json["error"] = errorJson(command.target, *outcome.converged);
    json["lost"] = lossesJson(outcome.picture);
    json["minContribution"] = command.scene.minContribution;
    json["notFinite"] = outcome.picture.notFinite;
    if (outcome.picture.notFinite > 0)
        json["firstNotFinite"] = {outcome.picture.firstNotFinite.x, outcome.picture.firstNotFinite.y};
    json["seconds"] = {{"load", loaded.loadSeconds},
                       {"pack", loaded.packSeconds},
                       {"upload", t.upload},
                       {"compile", t.compile},
                       {"trace", t.trace},
                       {"device", t.device},
                       {"readback", t.readback},
                       {"write", outcome.writeSeconds},
                       {"total", outcome.totalSeconds},
                       {"longestSubmission", t.longestSubmission}};
    json["submissions"] = t.submissions;
    json["slices"] = t.slices;
    json["resumes"] = t.resumes;
    return json;
}

void printSummary(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                  std::ostream& out) {
    const render::StageTimes& t = outcome.times;
    for (const auto& file : outcome.files) {
        out << "wrote " << file.string() << " (" << outcome.picture.region.width() << "x"
            << outcome.picture.region.height() << ")\n";
    }
    if (outcome.converged) out << errorSummary(command.target, *outcome.converged) << '\n';
    out << "device: " << outcome.device << ", " << outcome.driver << '\n';
    out << "hash: " << outcome.hash;
    if (outcome.arithmetic && !outcome.arithmetic->sharesBits())
        out << " (this device " << outcome.arithmetic->text() << ')';
    out << '\n';
    out << "times: load " << formatSeconds(loaded.loadSeconds) << ", BVH and packing "
        << formatSeconds(loaded.packSeconds);
    if (t.submissions > 0) {
        out << ", upload " << formatSeconds(t.upload) << ", compile " << formatSeconds(t.compile);
    }
    out << ", trace " << formatSeconds(t.trace);
    if (t.submissions > 0) out << ", readback " << formatSeconds(t.readback);
    out << ", write " << formatSeconds(outcome.writeSeconds) << "; " << formatSeconds(outcome.totalSeconds)
        << " in all\n";
}

void printResult(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                 std::ostream& out) {
    if (command.json) {
        // A file name need not be UTF-8; JSON must be.
        out << statsJson(outcome, command, loaded)
                   .dump(2, ' ', false, nlohmann::json::error_handler_t::replace)
            << '\n';
    } else if (!command.quiet) {
        printSummary(outcome, command, loaded, out);
    }
}

// Throws for a render that was cut short, once what there is has been written.
void checkComplete(const Outcome& outcome) {
    const Picture& picture = outcome.picture;
    if (picture.complete) return;
    const auto done = static_cast<double>(std::count(picture.done.begin(), picture.done.end(), 1));
    if (done == 0)
        throw Error(ErrorKind::Interrupted,
                    "interrupted before any part of the picture was finished; nothing written");
    char percent[16];
    std::snprintf(percent, sizeof(percent), "%.3g %%", 100 * done / static_cast<double>(picture.done.size()));
    if (!outcome.files.empty()) {
        throw Error(ErrorKind::Interrupted, "interrupted: " + outcome.files.front().string() + " holds the " +
                                                percent + " of the picture that was finished");
    }
}

int run(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch total;
    checkDeviceOptions(command.backend, command.device);
    checkErrorTarget(command.target, command.scene, command.aovs);
    if (command.scene.scene.empty()) throw Error(ErrorKind::Argument, "SCENE is empty; give a file name");
    if (!command.quiet || command.json) checkStandardOutput(out);
    const std::filesystem::path output = outputOf(command);
    checkPicturePath(output);
    // Opening a device (50 ms for lavapipe, whose libraries are large) and reading the scene need nothing of
    // each other. What is wrong with the scene is said first.
    std::future<gpu::Device> opening;
    if (command.backend == Backend::Gpu) {
        opening = std::async(std::launch::async | std::launch::deferred, [&choice = command.device] {
            gpu::Device device = openDevice(choice, true);
            device.arithmetic();  // a few milliseconds the first time
            return device;
        });
    }
    const LoadedScene loaded = loadAndPack(command.scene, err, command.quiet);
    const Region region = checkedRegion(command, loaded.scene);
    checkMemory(region.width(), region.height(), bytesPerPixel(command), availableMemory());

    installInterruptHandler();
    Outcome outcome;
    std::optional<gpu::Device> device;
    {
        Progress progress("render", command.quiet ? ProgressMode::None : command.progress, err,
                          isTerminal(err));
        Request request = requestOf(command, loaded, region, progress);
        std::optional<converge::Job> job;
        if (command.target.error) job = jobOf(command.target, loaded, command.backend, request, progress);
        if (command.backend == Backend::Cpu) {
            renderOnHost(loaded, request, job, outcome);
        } else {
            device.emplace(opening.get());
            renderOnDevice(*device, loaded, request, command.device, job, outcome);
        }
    }
    if (!command.quiet) warnAboutPicture(outcome, command, loaded, err);
    blackenNotFinite(outcome.picture);
    const bool anyDone =
        std::find(outcome.picture.done.begin(), outcome.picture.done.end(), 1) != outcome.picture.done.end();
    if (!anyDone) checkComplete(outcome);

    const Stopwatch writing;
    outcome.hash = pictureHash(outcome.picture.color);
    outcome.files = writeLayers(output, makeLayers(outcome.picture, command.aovs));
    outcome.writeSeconds = writing.seconds();
    outcome.totalSeconds = total.seconds();
    printResult(outcome, command, loaded, out);
    if (device) reportValidation(*device, command.device, err);
    checkComplete(outcome);
    if (outcome.converged && outcome.converged->stop == converge::Stop::Interrupted)
        throw Error(ErrorKind::Interrupted, "interrupted: " + outcome.files.front().string() +
                                                " holds the samples of all rounds that were finished");
    const bool missed = outcome.converged && !outcome.converged->reached();
    return static_cast<int>(missed && command.target.strict ? ExitCode::Difference : ExitCode::Done);
}

}  // namespace

Run renderCommand(OptionTable& table) {
    const auto command = std::make_shared<RenderCommand>();
    declare(table, *command);
    return [command](std::ostream& out, std::ostream& err) { return run(*command, out, err); };
}

}  // namespace glint::app
