#include "app/render_command.h"

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <ostream>

#include "core/available_memory.h"
#include "core/enum_names.h"
#include "core/error.h"
#include "core/format.h"
#include "core/interrupt.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "scene/limits.h"

namespace glint::app {

namespace fs = std::filesystem;

namespace {

bool needsData(const std::vector<Aov>& aovs) {
    return std::any_of(aovs.begin(), aovs.end(), [](Aov aov) { return glint::needsData(aov); });
}

}  // namespace

fs::path outputOf(const RenderCommand& command) {
    const fs::path name =
        command.scene.scene == "-" ? "stdin.png" : command.scene.scene.filename().replace_extension(".png");
    if (!command.scene.scene.has_filename())
        throw Error(ErrorKind::Scene, shown(command.scene.scene) + ": is a folder, not a file");
    if (command.output.empty()) return name;
    return inFolder(command.output, name);
}

namespace {

// True if the scene was read from a file of the image.
bool isRead(const RenderCommand& command, const Scene& scene, const fs::path& output) {
    if (output == "-") return false;
    const auto files = layerPaths(output, namesOf(command.aovs));
    return std::any_of(scene.sources.begin(), scene.sources.end(), [&](const SourceFile& source) {
        const fs::path read = command.scene.scene.parent_path() / source.name;
        return std::any_of(files.begin(), files.end(), [&](const fs::path& file) {
            std::error_code ignored;  // a file that does not exist cannot be lost
            return fs::equivalent(read, file, ignored);
        });
    });
}

void refuseRead(const RenderCommand& command, const Scene& scene, const fs::path& output) {
    refuseIf(isRead(command, scene, output),
             output.string() + ": is read by the scene; name another file with --output");
}

}  // namespace

fs::path outputOf(const RenderCommand& command, const Scene& scene) {
    fs::path output = outputOf(command);
    if (command.output.empty() && isRead(command, scene, output)) output.replace_extension(".render.png");
    refuseRead(command, scene, output);
    return output;
}

uint64_t bytesPerPixel(const std::vector<Aov>& aovs) {
    return 4 * sizeof(float) + 1 + aovs.size() * 3 * sizeof(float);
}

uint64_t bytesPerPixel(const RenderCommand& command) {
    return bytesPerPixel(command.aovs) + (needsData(command.aovs) ? sizeof(PixelData) : 0);
}

Request requestOf(const RenderCommand& command, const LoadedScene& loaded) {
    Request request = requestOf(loaded, command.scene, command.target.error > 0);
    request.region = command.crop.value_or(Region{0, 0, request.width, request.height});
    refuseIf(request.region.x1 > request.width || request.region.y1 > request.height,
             format("--crop: reaches beyond the image of %dx%d pixels", request.width, request.height));
    request.data = needsData(command.aovs);
    request.cost = std::find(command.aovs.begin(), command.aovs.end(), Aov::Cost) != command.aovs.end();
    request.ledger = loaded.packed.features.transmission || command.json;
    request.cancelled = interrupted;
    return request;
}

namespace {

// Options that exclude each other, with the remedy.
constexpr const char* kExclusions[][3] = {
    {"--error", "--adaptive", "leave out --adaptive, as --error chooses the samples of all pixels"},
    {"--error", "--spp", "limit the number of samples, which --error chooses, with --max-spp"},
    {"--error", "--part", "use --spp with --part"},
    {"--error", "--checkpoint", "use --spp with --checkpoint"},
    {"--error", "--band-rows", "use --spp with --band-rows"},
    {"--part", "--exposure", "parts hold linear floats; give --exposure to glint merge"},
    {"--part", "--checkpoint", "use more parts, each of which is soon repeated"},
    {"--part", "--frames", "give each machine frames of its own"},
    {"--part", "--band-rows", "use more parts to need less memory, and merge --in-bands"},
    {"--checkpoint", "--frames", "leave out --checkpoint, as --frames skips frames that exist"},
    {"--checkpoint", "--band-rows", "leave out --band-rows, as --checkpoint chooses the rows itself"},
    {"--frames", "--band-rows", "render the frame alone by --time SECONDS"},
    {"--frames", "--time", "choose the time by --fps, as frame N shows time N / fps"}};

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
    addBackend(table, c.device);
    addDevice(table, c.device);
    addTraversal(table, c.device);
    table.flag("--reproducible", "do not use the device's division and square root, even if its probe passes",
               c.device.reproducible);
    table.value("--aov", "LIST",
                "write these layers, with commas: " + joined(kEnumNames<Aov>) +
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
    addError(table, c.target);
    table.value("--max-seconds", "S", "stop --error after S seconds with the best image so far",
                c.target.maxSeconds, parsePositive);
    table.whole("--max-spp", "N", "stop --error at N samples per pixel (default 65536)", 2, 1 << 20,
                c.target.maxSamples);
    table.flag("--strict", "exit with code 5 if --error is not reached", c.strict);
    table.requireGpu({"--device", "--validation", "--traversal", "--reproducible"});
    table.require("--error", {"--max-seconds", "--max-spp", "--strict"});
    table.require("--frames", {"--fps", "--overwrite"});
    for (const auto& [option, other, remedy] : kExclusions) table.exclude(option, other, remedy);
    addStats(table, "print times and counts as JSON instead of the summary", c.json);
    addProgress(table, c.progress);
    table.flag("-q,--quiet", "print only errors, and the output of --stats", c.quiet);
}

// Throws for a render that was cut short and whose finished part has been written.
void checkComplete(const Outcome& outcome) {
    const std::string start = "interrupted: " + outcome.written.files.front().string() + " holds the ";
    if (!outcome.complete)
        throw Error(ErrorKind::Interrupted,
                    start +
                        format("%.3g", 100 * static_cast<double>(outcome.written.totals.done) /
                                           static_cast<double>(outcome.region.pixels())) +
                        " % of the image that was finished");
    if (outcome.converged && outcome.converged->stop == converge::Stop::Interrupted)
        throw Error(ErrorKind::Interrupted, start + "samples of all rounds that were finished");
}

void check(const RenderCommand& command, const std::ostream& out) {
    const bool untilError = command.target.error > 0;
    const bool errorLayer = std::count(command.aovs.begin(), command.aovs.end(), Aov::Error) > 0;
    refuseIf(errorLayer && !untilError, "--aov: the layer error requires --error");
    refuseIf(untilError && command.scene.sampler == Sampler::Grid,
             "--error does not work with the grid sampler: use lowDiscrepancy or jittered");
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

// Rows of a band; 0 renders the image at once. Throws Error(Failed) if not even a band fits into memory, and
// the errors of goesByRows().
int bandRowsOf(const RenderCommand& command, const fs::path& output, const Region& region) {
    const uint64_t available = availableMemory();
    // While it is written the file's own rows lie beside it: an EXR took 41 bytes for a pixel, of 29 and 58.
    const uint64_t perPixel = 2 * bytesPerPixel(command);
    if (command.target.error > 0) {  // its rounds need the whole image
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

ExitCode renderPicture(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch total;
    if (command.output != "-") checkPicturePath(outputOf(command));
    Drawing drawing(command.device);
    const LoadedScene loaded = loadAndPack(command.scene, err);
    Request request = requestOf(command, loaded);
    const fs::path output = outputOf(command, loaded.scene);
    const int bandRows = bandRowsOf(command, output, request.region);
    installInterruptHandler();
    PictureFile file(output, request.region, command.aovs, command.exposure, bandRows > 0);
    Progress progress = progressOf("render", command.progress, err);
    request.progress = [&](double fraction) { progress.update(fraction); };
    const std::optional<converge::Job> job = jobOf(command.target, loaded, command.device.backend, request);
    // The number of samples for an error target is unknown.
    drawing.load(loaded, request, job ? 0 : cameraRaysOf(request));
    Outcome outcome = drawInto(file, drawing, command, loaded, request, job,
                               bandRows > 0 ? bandRows : request.region.height());
    progress.finish();
    outcome.drawn = drawing.facts();
    warnAboutPicture(outcome, command, loaded, err);
    outcome.written = file.finish(out, errorNotes(command.target, outcome));
    outcome.totalSeconds = total.seconds();
    printResult(outcome, command, loaded, request, out);
    drawing.checkValidation();
    checkComplete(outcome);
    const bool missed = outcome.converged && !outcome.converged->reached();
    return missed && command.strict ? ExitCode::Difference : ExitCode::Done;
}

// ---- --frames: the images of an animation

// "frame.####.png" for frame 7: "frame.0007.png". Without # the name itself.
fs::path numbered(const fs::path& pattern, int frame) {
    std::string name = pattern.filename().string();
    const size_t first = name.find('#');
    if (first == std::string::npos) return pattern;
    const size_t end = std::min(name.find_first_not_of('#', first), name.size());
    std::string digits = std::to_string(frame);
    digits.insert(0, std::max(end - first, digits.size()) - digits.size(), '0');
    fs::path path = pattern;
    return path.replace_filename(name.replace(first, end - first, digits));
}

void checkFrames(const RenderCommand& command) {
    const FrameRange& frames = *command.frames;
    const fs::path output = outputOf(command);
    refuseIf(frames.first != frames.last && output.filename().string().find('#') == std::string::npos,
             output.string() +
                 ": the name of several frames has # in the place of each digit of their "
                 "number, such as frame.####.png");
    checkPicturePath(numbered(output, frames.first));
}

// Those that are not there yet; with --overwrite all.
std::vector<int> framesToDraw(const RenderCommand& command) {
    std::vector<int> frames;
    for (int frame = command.frames->first; frame <= command.frames->last; ++frame) {
        const auto files = layerPaths(numbered(outputOf(command), frame), namesOf(command.aovs));
        const bool there = std::all_of(files.begin(), files.end(), [](const fs::path& file) {
            std::error_code ignored;
            return fs::is_regular_file(file, ignored) && !fs::is_empty(file, ignored);
        });
        if (command.overwrite || !there) frames.push_back(frame);
    }
    return frames;
}

// Renders the frames that do not exist yet.
class FrameRenderer {
  public:
    FrameRenderer(const RenderCommand& command, std::ostream& out, std::ostream& err)
        : command_(command),
          out_(out),
          err_(err),
          frames_(framesToDraw(command)),
          there_(static_cast<size_t>(command.frames->last - command.frames->first + 1) - frames_.size()),
          drawing_(command.device) {}

    ExitCode run() {
        const bool complete = frames_.empty() || drawAll();
        if (command_.json)
            printStats();
        else if (!command_.quiet)
            printSummary();
        drawing_.checkValidation();
        if (!complete)
            throw Error(ErrorKind::Interrupted, "interrupted: " + std::to_string(there_ + drawn_.size()) +
                                                    " of " + std::to_string(there_ + frames_.size()) +
                                                    " frames exist; repeat the command to resume");
        return missed_ && command_.strict ? ExitCode::Difference : ExitCode::Done;
    }

  private:
    double timeOf(int frame) const { return frame / framesPerSecond_; }

    // The frame rate may be the scene's own, so the scene is read before the time of the first frame is
    // known.
    void open() {
        scene_.emplace(command_.scene, std::nullopt, err_);
        const LoadedScene& loaded = scene_->loaded();
        const auto& animation = loaded.scene.animation;
        framesPerSecond_ = command_.framesPerSecond.value_or(animation ? animation->framesPerSecond : 24);
        if (!animation && command_.frames->first != command_.frames->last)
            err_ << warningOf(command_.scene.scene) << "has no animation; all frames are the same image\n";
        for (const int frame : frames_)
            refuseRead(command_, loaded.scene, numbered(outputOf(command_), frame));
        const Region region = requestOf(command_, loaded).region;
        checkMemory(region.width(), region.height(), 2 * bytesPerPixel(command_), availableMemory());
        scene_->moveTo(timeOf(frames_.front()));
    }

    // False if it was interrupted.
    bool drawAll() {
        open();
        installInterruptHandler();
        Progress progress = progressOf("render " + counted(frames_.size(), "frame"), command_.progress, err_);
        for (size_t i = 0; i < frames_.size(); ++i) {
            const auto show = [&](double done) {
                progress.update((static_cast<double>(i) + done) / static_cast<double>(frames_.size()));
            };
            if (interrupted() || !drawOne(frames_[i], show)) return false;
        }
        return true;
    }

    bool drawOne(int frame, const std::function<void(double)>& show) {
        const Stopwatch watch;
        const LoadedScene& loaded = scene_->loaded();
        using Change = AnimatedScene::Change;
        const double time = timeOf(frame);
        const bool first = drawn_.empty();
        const Change change = first ? Change::Scene : scene_->moveTo(time);
        Request request = requestOf(command_, loaded);
        request.camera = scene_->camera();
        request.progress = show;
        const std::optional<converge::Job> job =
            jobOf(command_.target, loaded, command_.device.backend, request);
        if (first || change == Change::Scene) drawing_.load(loaded, request);
        PictureFile file(numbered(outputOf(command_), frame), request.region, command_.aovs,
                         command_.exposure, false);
        Outcome outcome = drawInto(file, drawing_, command_, loaded, request, job, request.region.height());
        const bool cut = outcome.converged && outcome.converged->stop == converge::Stop::Interrupted;
        // The next run would skip an incomplete frame as finished.
        if (!outcome.complete || cut) return false;
        missed_ = missed_ || (outcome.converged && !outcome.converged->reached());
        warnAboutPicture(outcome, command_, loaded, err_);
        const Written written = file.finish(out_, errorNotes(command_.target, outcome));
        constexpr const char* kChanges[] = {"nothing", "camera", "scene"};
        drawn_.push_back({{"frame", frame},
                          {"time", time},
                          {"hash", written.hash},
                          {"seconds", watch.seconds()},
                          {"changed", kChanges[static_cast<size_t>(change)]},
                          {"files", filesJson(written.files)}});
        return true;
    }

    void printStats() const {
        nlohmann::json json = drawnJson(drawing_.facts());
        json.update({{"scene", command_.scene.scene.string()},
                     {"there", there_},
                     {"treesBuilt", scene_ ? scene_->treesBuilt() : 0},
                     {"seconds", total_.seconds()},
                     {"frames", drawn_}});
        printJson(json, out_);
    }

    void printSummary() const {
        const size_t count = drawn_.size();
        const auto fileOf = [&](size_t i) { return shown(drawn_[i]["files"][0].get<std::string>()); };
        if (count > 0)
            out_ << "wrote " << counted(count, "frame") << ", " << fileOf(0)
                 << (count > 1 ? " to " + fileOf(count - 1) : "") << '\n';
        if (there_ > 0)
            out_ << counted(there_, "frame") << (there_ == 1 ? " was" : " were")
                 << " there already (--overwrite renders them again)\n";
        printDevice(drawing_.facts(), out_);
        out_ << "times: " << formatSeconds(total_.seconds()) << " in all";
        if (count > 0)
            out_ << ", " << formatSeconds(total_.seconds() / static_cast<double>(count)) << " a frame";
        out_ << '\n';
    }

    const RenderCommand& command_;
    std::ostream& out_;
    std::ostream& err_;
    const std::vector<int> frames_;
    const size_t there_;  // frames that existed before
    Drawing drawing_;
    std::optional<AnimatedScene> scene_;
    double framesPerSecond_ = 24;
    nlohmann::json drawn_ = nlohmann::json::array();  // a frame each, as for --stats
    bool missed_ = false;                             // an --error was not reached
    const Stopwatch total_;
};

ExitCode renderFrames(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    checkFrames(command);
    return FrameRenderer(command, out, err).run();
}

ExitCode run(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    check(command, out);
    std::ostream silence(nullptr);
    std::ostream& warnings = command.quiet ? silence : err;
    if (isInUnits(command)) return renderInUnits(command, out, warnings);
    if (command.frames) return renderFrames(command, out, warnings);
    return renderPicture(command, out, warnings);
}

}  // namespace

Run renderCommand(OptionTable& table) {
    return commandOf<RenderCommand>(table, declare, run);
}

}  // namespace glint::app
