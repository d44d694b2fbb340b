#include "app/render_command.h"

#include <algorithm>
#include <ostream>

#include "app/commands.h"
#include "app/common.h"
#include "app/drawing.h"
#include "app/loading.h"
#include "app/render_result.h"
#include "core/available_memory.h"
#include "core/enum_names.h"
#include "core/error.h"
#include "core/format.h"
#include "core/interrupt.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "scene/limits.h"

namespace glint::app {

namespace {

bool needsData(const std::vector<Aov>& aovs) {
    return std::any_of(aovs.begin(), aovs.end(), [](Aov aov) { return glint::needsData(aov); });
}

}  // namespace

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

uint64_t bytesPerPixel(const std::vector<Aov>& aovs) {
    return 4 * sizeof(float) + 1 + aovs.size() * 3 * sizeof(float);
}

uint64_t bytesPerPixel(const RenderCommand& command) {
    return bytesPerPixel(command.aovs) + (needsData(command.aovs) ? sizeof(PixelData) : 0);
}

Request requestOf(const RenderCommand& command, const LoadedScene& loaded) {
    Request request = requestOf(loaded, command.scene, command.target.error.has_value());
    request.region = command.crop.value_or(Region{0, 0, request.width, request.height});
    if (request.region.x1 > request.width || request.region.y1 > request.height)
        throw Error(ErrorKind::Argument, format("--crop: reaches beyond the image of %dx%d pixels",
                                                request.width, request.height));
    request.data = needsData(command.aovs);
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
               "SCENE.png, here)",
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
    table.flag("--reproducible", "do not use the device's division and square root, even if its probe passes",
               c.device.reproducible);
    table.value("--aov", "LIST",
                "write these layers, with commas: " + joinNames(kEnumNames<Aov>) +
                    "; .exr holds all of them, other formats get a file each",
                c.aovs, parseAovs);
    table.value("--crop", "x0,y0,x1,y1",
                "render the pixels x0 <= x < x1, y0 <= y < y1, from the top left corner", c.crop, parseCrop);
    table.whole("--band-rows", "N",
                "write in bands of N rows (default: if the image does not fit into memory)", 1, kMaxImageSize,
                c.bandRows);
    table.value("--part", "K/N", "render part K of N, from 1, into a file for glint merge", c.part,
                parsePart);
    table.name("--checkpoint", "FILE",
               "keep finished units in FILE until the image is written, and resume from them", c.checkpoint);
    table.value("--frames", "A:B",
                "render the frames A to B that do not exist yet; each # in -o stands for a digit", c.frames,
                parseFrames);
    table.value("--fps", "F", "frames per second of --frames (default: the scene's, or 24)",
                c.framesPerSecond, parsePositive);
    table.flag("--overwrite", "render existing frames again", c.overwrite);
    addErrorTarget(table, c.target);
    table.require("--frames", {"--fps", "--overwrite"});
    constexpr const char* kExclusions[][3] = {
        {"--error", "--adaptive", "leave out --adaptive, as --error chooses the samples of all pixels"},
        {"--error", "--part", "use --spp with --part"},
        {"--error", "--checkpoint", "use --spp with --checkpoint"},
        {"--error", "--band-rows", "use --spp with --band-rows"},
        {"--part", "--checkpoint", "use more parts, each of which is soon repeated"},
        {"--part", "--frames", "give each machine frames of its own"},
        {"--part", "--band-rows", "use more parts to need less memory, and merge --in-bands"},
        {"--checkpoint", "--frames", "leave out --checkpoint, as --frames skips frames that exist"},
        {"--checkpoint", "--band-rows", "leave out --band-rows, as --checkpoint chooses the rows itself"},
        {"--frames", "--band-rows", "render the frame alone by --time SECONDS"},
        {"--frames", "--time", "choose the time by --fps, as frame N shows time N / fps"}};
    for (const auto& [option, other, remedy] : kExclusions) table.exclude(option, other, remedy);
    addStats(table, "print times and counts as JSON instead of the summary", c.json);
    addProgress(table, c.progress);
    table.flag("-q,--quiet", "print only errors, and the output of --stats", c.quiet);
}

// Throws for a render that was cut short and whose finished part has been written.
void checkComplete(const Outcome& outcome) {
    const std::string start = "interrupted: " + outcome.files.front().string() + " holds the ";
    if (!outcome.picture.complete)
        throw Error(ErrorKind::Interrupted,
                    start + format("%.3g", 100 * outcome.doneShare()) + " % of the image that was finished");
    if (outcome.converged && outcome.converged->stop == converge::Stop::Interrupted)
        throw Error(ErrorKind::Interrupted, start + "samples of all rounds that were finished");
}

void check(const RenderCommand& command, const std::ostream& out) {
    const auto refuseIf = [](bool wrong, const char* line) {
        if (wrong) throw Error(ErrorKind::Argument, line);
    };
    checkDeviceOptions(command.backend, command.device);
    const bool errorLayer = std::count(command.aovs.begin(), command.aovs.end(), Aov::Error) > 0;
    refuseIf(errorLayer && !command.target.error, "--aov: the layer error requires --error");
    refuseIf(command.target.error && command.scene.sampler == Sampler::Grid,
             "--error does not work with the grid sampler: use lowDiscrepancy or jittered");
    refuseIf(command.target.error && command.scene.spp,
             "--spp: --error chooses the number of samples; limit it with --max-spp");
    refuseIf(command.part && command.exposure,
             "--exposure: parts hold linear floats; give it to glint merge");
    if (command.output == "-") {
        refuseIf(command.part || command.frames || command.bandRows || !command.checkpoint.empty(),
                 "--output -: with --part, --checkpoint, --frames or --band-rows name a file");
        refuseIf(command.aovs != std::vector{Aov::Radiance},
                 "--output -: holds the layer color alone; write other layers to an .exr file");
        refuseIf(command.json,
                 "--output -: standard output holds the image; write it to a file to print --stats");
    }
    if (!command.part) scaleOf(outputOf(command), command.exposure);
    if (!command.quiet || command.json || command.output == "-") checkStandardOutput(out);
    if (!command.output.empty() && !command.output.has_filename()) makeFolder(command.output);
}

// Bands begin where tiles of the device do, so that packets of rays, and with them the layer "cost", are
// those of the whole image.
constexpr int kStep = shared::kTileSize;
constexpr uint64_t kBandBytes = uint64_t{1} << 30;  // enough to keep any device busy

uint64_t roundedUp(uint64_t rows) {
    return (rows + kStep - 1) / kStep * kStep;
}

// Adds what is known of a band, and makes its colours finite.
void add(Picture& all, Picture& band) {
    // Bands come from the top, so the first place is that of the first band that has one.
    if (all.notFinite == 0) all.firstNotFinite = band.firstNotFinite;
    all.notFinite += band.notFinite;
    all.losses.add(band.losses);
    all.complete = all.complete && band.complete;
    blackenNotFinite(band);
}

// Rows of a band; 0 renders the image at once. Throws Error(Failed) if not even a band fits into memory, and
// the errors of goesByRows().
int bandRowsOf(const RenderCommand& command, const std::filesystem::path& output, const Region& region) {
    const uint64_t available = availableMemory();
    // While it is written the file's own rows lie beside it: an EXR took 41 bytes for a pixel, of 29 and 58.
    const uint64_t perPixel = 2 * bytesPerPixel(command);
    if (command.target.error) {  // its rounds need the whole image
        checkMemory(region.width(), region.height(), perPixel, available);
        return 0;
    }
    if (!goesByRows(output, command.aovs, region, perPixel, 0, command.bandRows.has_value())) return 0;
    const uint64_t row = static_cast<uint64_t>(region.width()) * perPixel;
    const auto height = static_cast<uint64_t>(region.height());
    const uint64_t fitting = std::min(available / 4, kBandBytes) / row / kStep * kStep;
    const uint64_t rows = command.bandRows ? roundedUp(static_cast<uint64_t>(*command.bandRows))
                                           : std::max<uint64_t>(fitting, kStep);
    requireMemory(format("an image of %dx%d pixels in bands of ", region.width(), region.height()) +
                      counted(rows, "row"),
                  std::min(rows, height) * row, available, "use fewer --band-rows or a smaller --size");
    return static_cast<int>(std::min(rows, roundedUp(height)));
}

// Renders and writes the image from the top in bands of rows, each of which goes straight into the file.
// Pixels are independent, so the file equals that of an image rendered at once. The rest of an interrupted
// image is blank.
void drawBands(Drawing& drawing, const RenderCommand& command, const LoadedScene& loaded,
               const Request& request, int rows, Outcome& outcome) {
    const Region region = regionOf(request);
    const float scale = scaleOf(outcome.output, command.exposure);
    outcome.picture.region = region;
    RowFile file(outcome.output, region, command.aovs, scale);
    bool alike = !command.quiet;  // all bands so far lack the same
    Request part = request;
    for (int y = region.y0; y < region.y1 && outcome.picture.complete; y += rows) {
        part.region = {region.x0, y, region.x1, std::min(y + rows, region.y1)};
        const auto share = [&](int row) { return static_cast<double>(row - region.y0) / region.height(); };
        const double from = share(y), to = share(part.region.y1);
        part.progress = [&](double done) { request.progress(from + (to - from) * done); };
        Picture band = drawing.whole([&] { return drawing.draw(part); });
        if (alike) {
            const auto reason = pictureAdvice(band, loaded.scene, loaded.packed, request, scale);
            alike = reason && (y == region.y0 || reason == outcome.advice);
            outcome.advice = alike ? reason : std::nullopt;
        }
        add(outcome.picture, band);
        file.add(band, makeLayers(band, command.aovs));
    }
    outcome.totals = file.totals();
    outcome.bands = file.bands();
    if (outcome.totals.done == 0) throwNothingDone();
    // After an interrupt, rows from here on are blank.
    part.region = {region.x0, part.region.y1, region.x1, part.region.y1 + 1};
    const Picture blank = blankPicture(part);
    file.fill(blank, makeLayers(blank, command.aovs));
    file.finish(outcome);
}

ExitCode renderPicture(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch total;
    if (command.output != "-") checkPicturePath(outputOf(command));
    Drawing drawing(command.backend, command.device, err);
    const LoadedScene loaded = loadAndPack(command.scene, err);
    Request request = requestOf(command, loaded);
    Outcome outcome;
    outcome.request = request;
    outcome.output = outputOf(command, loaded.scene);
    const int bandRows = bandRowsOf(command, outcome.output, request.region);
    installInterruptHandler();
    {
        Progress progress = progressOf("render", command.progress, err);
        request.progress = [&](double fraction) { progress.update(fraction); };
        std::optional<converge::Job> job;
        if (command.target.error) job = jobOf(command.target, loaded, command.backend, request);
        // The number of samples for an error target is unknown.
        drawing.load(loaded, request, job ? 0 : cameraRaysOf(request));
        if (bandRows > 0)
            drawBands(drawing, command, loaded, request, bandRows, outcome);
        else
            outcome.picture = drawing.draw(request, job, outcome.converged);
    }
    outcome.drawn = drawing.facts();
    if (bandRows == 0) adviseOn(outcome, command, loaded);
    warnAboutPicture(outcome, command, loaded, err);
    if (bandRows == 0) writePicture(outcome, command, out);
    outcome.totalSeconds = total.seconds();
    printResult(outcome, command, loaded, out);
    drawing.checkValidation();
    checkComplete(outcome);
    const bool missed = outcome.converged && !outcome.converged->reached();
    return missed && command.target.strict ? ExitCode::Difference : ExitCode::Done;
}

ExitCode run(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    check(command, out);
    std::ostream silence(nullptr);
    std::ostream& warnings = command.quiet ? silence : err;
    const bool forRanks = isForRanks(command);
    if (command.frames) return renderFrames(command, out, warnings);
    if (command.part) return renderPart(command, out, warnings);
    if (!command.checkpoint.empty()) return renderFromCheckpoint(command, out, warnings);
    if (forRanks) return renderAmongRanks(command, out, warnings);
    return renderPicture(command, out, warnings);
}

}  // namespace

Run renderCommand(OptionTable& table) {
    return commandOf<RenderCommand>(table, declare, run);
}

}  // namespace glint::app
