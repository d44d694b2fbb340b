#include "app/render_command.h"

#include <algorithm>
#include <ostream>

#include "app/commands.h"
#include "app/common.h"
#include "app/drawing.h"
#include "app/loading.h"
#include "app/render_bands.h"
#include "app/render_result.h"
#include "core/available_memory.h"
#include "core/enum_names.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/stopwatch.h"
#include "scene/limits.h"

namespace glint::app {

bool needsData(const RenderCommand& command) {
    return std::any_of(command.aovs.begin(), command.aovs.end(),
                       [](Aov aov) { return glint::needsData(aov); });
}

std::filesystem::path outputOf(const RenderCommand& command) {
    const std::filesystem::path name =
        command.scene.scene == "-" ? "stdin.png" : command.scene.scene.filename().replace_extension(".png");
    if (!command.scene.scene.has_filename())
        throw Error(ErrorKind::Scene, shown(command.scene.scene) + ": is a folder, not a file");
    if (command.output.empty()) return name;
    return command.output.has_filename() ? command.output : command.output / name;
}

std::filesystem::path outputOf(const RenderCommand& command, const Scene& scene) {
    const auto isRead = [&](const std::filesystem::path& output) {
        return std::any_of(scene.sources.begin(), scene.sources.end(), [&](const SourceFile& file) {
            std::error_code ignored;  // a file that does not exist cannot be lost
            return std::filesystem::equivalent(command.scene.scene.parent_path() / file.name, output,
                                               ignored);
        });
    };
    std::filesystem::path output = outputOf(command);
    if (!isRead(output)) return output;
    const std::string name = output.string();
    if (command.output.empty() && !isRead(output.replace_extension(".render.png"))) return output;
    throw Error(ErrorKind::Argument, name + ": is read by the scene; name another file with --output");
}

uint64_t bytesPerPixel(const std::vector<Aov>& aovs, bool data) {
    return 4 * sizeof(float) + 1 + (data ? sizeof(PixelData) : 0) + aovs.size() * 3 * sizeof(float);
}

Request requestOf(const RenderCommand& command, const LoadedScene& loaded) {
    Request request = requestOf(loaded, command.scene, command.target.error.has_value());
    request.region = command.crop.value_or(Region{0, 0, request.width, request.height});
    if (request.region.x1 > request.width || request.region.y1 > request.height)
        throw Error(ErrorKind::Argument, "--crop: reaches beyond the picture of " +
                                             std::to_string(request.width) + "x" +
                                             std::to_string(request.height) + " pixels");
    request.data = needsData(command);
    request.cost = std::find(command.aovs.begin(), command.aovs.end(), Aov::Cost) != command.aovs.end();
    request.ledger = loaded.packed.features.transmission || command.json;
    request.cancelled = interrupted;
    return request;
}

namespace {

void declare(OptionTable& table, RenderCommand& c) {
    addScene(table, c.scene);
    table.name("-o,--output", "FILE",
               "image to write: .png .exr .pfm .hdr, FOLDER/, or - for a PNG on standard output (default: "
               "SCENE's name with .png, here)",
               c.output);
    addExposure(table, c.exposure);
    addSceneOverrides(table, c.scene);
    addMethods(table, c.scene);
    addMinContribution(table, c.scene);
    addSampling(table, c.scene);
    addBackend(table, c.backend);
    addDevice(table, c.device);
    addTraversal(table, c.device);
    addFallback(table, c.device);
    table.flag(
        "--reproducible",
        "do not use the device's division and square root, even if a probe finds them correctly rounded",
        c.device.reproducible);
    table.value("--aov", "LIST",
                "write these layers, with commas: " + joinNames(kEnumNames<Aov>) +
                    "; an EXR holds them all, other formats get a file for each",
                c.aovs, parseAovs);
    table.value("--crop", "x0,y0,x1,y1",
                "render only the pixels x0 <= x < x1, y0 <= y < y1, from the top left corner", c.crop,
                parseCrop);
    table.whole(
        "--band-rows", "N",
        "write the image in bands of N rows, so that memory holds one band (default: if it does not fit "
        "into memory)",
        1, kMaxImageSize, c.bandRows);
    table.value("--part", "K/N", "render part K of N, K from 1, into a file for glint merge", c.part,
                parsePart);
    table.name("--checkpoint", "FILE",
               "keep finished units in FILE and resume from them; removed once the image is written",
               c.checkpoint);
    table.value(
        "--frames", "A:B",
        "render frames A to B of the animation that do not exist yet; each # in -o stands for a digit",
        c.frames, parseFrames);
    table.value("--fps", "F", "frames per second of --frames instead of the scene's (24)", c.framesPerSecond,
                parsePositive);
    table.flag("--overwrite", "render existing frames again", c.overwrite);
    addErrorTarget(table, c.target);
    addStats(table, "print times and counts as JSON instead of the summary", c.json);
    addProgress(table, c.progress);
    table.flag("-q,--quiet", "print only errors, and the output of --stats", c.quiet);
}

// Throws for a render that was cut short and whose finished part has been written.
void checkComplete(const Outcome& outcome) {
    const std::string start = "interrupted: " + outcome.files.front().string() + " holds the ";
    if (!outcome.picture.complete)
        throw Error(ErrorKind::Interrupted, start + format("%.3g", 100 * outcome.doneShare()) +
                                                " % of the picture that was finished");
    if (outcome.converged && outcome.converged->stop == converge::Stop::Interrupted)
        throw Error(ErrorKind::Interrupted, start + "samples of all rounds that were finished");
}

// Ways to draw a picture in pieces; each goes alone.
void checkManner(const RenderCommand& command) {
    std::vector<std::string> given;
    if (command.part) given.emplace_back("--part");
    if (!command.checkpoint.empty()) given.emplace_back("--checkpoint");
    if (command.frames) given.emplace_back("--frames");
    if (command.output == "-") given.emplace_back("--output -");
    if (command.bandRows) given.emplace_back("--band-rows");
    if (given.size() > 1)
        throw Error(
            ErrorKind::Argument,
            given[0] + ": not together with " + given[1] +
                (command.frames ? "; frames are pieces already, give each machine frames of its own" : ""));
}

void check(const RenderCommand& command, const std::ostream& out) {
    checkDeviceOptions(command.backend, command.device);
    checkErrorTarget(command.target, command.scene, command.aovs);
    if (!command.frames && (command.framesPerSecond || command.overwrite))
        throw Error(ErrorKind::Argument,
                    std::string(command.overwrite ? "--overwrite" : "--fps") + " requires --frames");
    checkManner(command);
    if (command.output == "-" && command.aovs != std::vector{Aov::Radiance})
        throw Error(ErrorKind::Argument, "--output -: holds the layer color alone");
    if (command.output == "-" && command.json)
        throw Error(ErrorKind::Argument,
                    "--output -: the image is on standard output; not together with --stats");
    if (command.part && command.exposure)
        throw Error(ErrorKind::Argument, "--exposure: parts hold floats; give it to glint merge");
    if (!command.part) scaleOf(outputOf(command), command.exposure);
    if (!command.quiet || command.json || command.output == "-") checkStandardOutput(out);
    if (!command.output.empty() && !command.output.has_filename()) makeFolder(command.output);
}

ExitCode renderPicture(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch total;
    if (command.output != "-") checkPicturePath(outputOf(command));
    Drawing drawing(command.backend, command.device, command.quiet ? nullptr : &err);
    const LoadedScene loaded = loadAndPack(command.scene, err, command.quiet);
    Request request = requestOf(command, loaded);
    Outcome outcome;
    outcome.request = request;
    outcome.output = outputOf(command, loaded.scene);
    const int bandRows = bandRowsOf(command, outcome.output, request.region, availableMemory());
    installInterruptHandler();
    {
        Progress progress = progressOf("render", command.shownProgress(), err);
        request.progress = [&](double fraction) { progress.update(fraction); };
        std::optional<converge::Job> job;
        if (command.target.error) job = jobOf(command.target, loaded, command.backend, request, progress);
        // The number of samples for an error target is unknown.
        drawing.load(loaded, request, job ? 0 : cameraRaysOf(request));
        if (bandRows > 0)
            drawBands(drawing, command, loaded, request, bandRows, outcome);
        else
            outcome.picture = drawing.draw(request, job, outcome.converged);
    }
    outcome.drawn = drawing.facts();
    warnAboutPicture(outcome, command, loaded, err);
    writePicture(outcome, command, out);
    outcome.totalSeconds = total.seconds();
    printResult(outcome, command, loaded, out);
    drawing.reportValidation(err);
    checkComplete(outcome);
    const bool missed = outcome.converged && !outcome.converged->reached();
    return missed && command.target.strict ? ExitCode::Difference : ExitCode::Done;
}

ExitCode run(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    check(command, out);
    const bool forRanks = isForRanks(command);
    if (command.frames) return renderFrames(command, out, err);
    if (command.part) return renderPart(command, out, err);
    if (!command.checkpoint.empty()) return renderFromCheckpoint(command, out, err);
    if (forRanks) return renderAmongRanks(command, out, err);
    return renderPicture(command, out, err);
}

}  // namespace

Run renderCommand(OptionTable& table) {
    return commandOf<RenderCommand>(table, declare, run);
}

}  // namespace glint::app
