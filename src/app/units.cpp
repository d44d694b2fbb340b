// Images unit by unit (farm/unit.h): --part, --checkpoint and MPI of `glint render`, and `glint merge`.
#include <algorithm>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <utility>
#include <vector>

#include "app/commands.h"
#include "app/render_command.h"
#include "core/available_memory.h"
#include "core/content_hash.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/format.h"
#include "core/interrupt.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "farm/checkpoint.h"
#include "farm/cut.h"
#include "farm/merge.h"
#include "farm/ranks.h"
#include "farm/transport.h"
#include "farm/unit_file.h"
#include "pack/request_environment.h"
#include "scene/sampling.h"

namespace glint::app {

namespace {

namespace fs = std::filesystem;

// ---- the image that units make

// Bytes of a unit of so many pixels while it is rendered or waits: as rendered, and as layers.
uint64_t unitBytes(const std::vector<Aov>& aovs, uint64_t pixels) {
    return 2 * pixels * bytesPerPixel(aovs);
}

bool needsRows(const farm::UnitHeader& header, const fs::path& output, uint64_t heldBytes, bool wanted) {
    const Region& region = header.region;
    if (!goesByRows(output, header.aovs, region, unitBytes(header.aovs, 1), heldBytes, wanted)) return false;
    const uint64_t rows = static_cast<uint64_t>(4 * shared::kTileSize) * region.width();
    requireMemory(format("an image of %dx%d pixels in ", region.width(), region.height()) +
                      counted(static_cast<uint64_t>(header.parts), "unit"),
                  heldBytes + unitBytes(header.aovs, rows), availableMemory(),
                  "use more parts (--part K/N) or a smaller --size");
    return true;
}

// Device and driver.
std::string textOf(const farm::Producer& producer) {
    return producer.driver.empty() ? producer.device : producer.device + ", " + producer.driver;
}

class UnitPicture {
  public:
    // `heldBytes`: of the units that wait for an earlier one. `byRows`, errors: see goesByRows().
    UnitPicture(const farm::UnitHeader& header, const fs::path& output, uint64_t heldBytes, bool byRows,
                std::optional<double> exposure)
        : assembly(header.region, header.aovs),
          file(output, header.region, header.aovs, exposure, needsRows(header, output, heldBytes, byRows)) {}

    void add(const farm::UnitResult& result) {
        assembly.add(result);
        if (!file.goesByRows() && !assembly.complete()) return;
        farm::Rows rows = assembly.take();
        if (rows.picture.region.height() == 0) return;
        file.add(rows.picture, std::move(rows.layers));
        if (!file.goesByRows()) whole = std::move(rows.picture);
    }

    // Names the file of the complete image. Warns if several devices rendered it and the bits of some differ
    // from those of others; `start`: of the warning.
    Outcome write(const std::string& start, std::ostream& out, std::ostream& err) {
        if (!assembly.complete())
            throw Error(ErrorKind::Failed, "the parts leave some of the image's pixels out");
        Outcome outcome;
        outcome.region = assembly.region();
        outcome.flaws = assembly.flaws();
        outcome.written = file.finish(out);
        std::vector<std::string> own;
        for (const farm::Producer& producer : assembly.producers())
            if (!producer.sharesBits) own.push_back(textOf(producer));
        if (assembly.producers().size() > 1 && !own.empty())
            err << start << "the parts come from several devices, and the bits of some are their own ("
                << joined(own, "; ") << "): the last digits may differ from part to part\n";
        return outcome;
    }

    farm::Assembly assembly;
    PictureFile file;
    Picture whole;  // the complete image; without pixels if it goes by rows
};

// ---- glint render

// A unit while it is rendered, encoded and copied into the image.
constexpr uint64_t kHeldUnits = 3;

std::string samplesText(const ImageSettings& image) {
    std::string text = std::to_string(image.samplesPerPixel) + " " + std::string(nameOf(samplerOf(image))) +
                       ", filter " + std::string(nameOf(image.filter)) + " " + describe(image.filterRadius) +
                       ", seed " + std::to_string(image.seed);
    if (image.adaptive)
        text += ", adaptive " + std::to_string(image.adaptive->maxSamples) + "," +
                describe(image.adaptive->threshold);
    return text;
}

std::string regionText(const Region& r) {
    return format("%d,%d,%d,%d", r.x0, r.y0, r.x1, r.y1);
}

// All parts must use the same cut, so that each pixel is rendered exactly once.
std::string hashOf(const std::vector<std::vector<Region>>& cut) {
    std::string text;
    for (const auto& regions : cut) {
        for (const Region& r : regions) text += regionText(r) + ",";
        text += ";";
    }
    return hashText(contentHash(text));
}

// Version, files and settings, without the device and the files' folders. `request` is the whole image's.
farm::Identity identityOf(const RenderCommand& command, const LoadedScene& loaded, const Request& request) {
    const Scene& scene = loaded.scene;
    farm::Identity identity;
    const auto add = [&](const std::string& name, const std::string& value) {
        identity.facts.emplace_back(name, value);
    };
    add("glint", std::string(GLINT_VERSION) + " of commit " + builtCommit());
    add("scene", command.scene.scene.filename().string());
    for (const SourceFile& file : scene.sources) add("file " + file.name, hashText(file.hash));
    if (const std::string& camera = command.scene.loading.camera; !camera.empty()) add("camera", camera);
    if (command.scene.loading.up) add("up", std::string(nameOf(*command.scene.loading.up)));
    if (command.scene.time) add("time", describe(*command.scene.time));
    add("size", std::to_string(request.width) + "x" + std::to_string(request.height));
    add("crop", regionText(regionOf(request)));
    add("samples", samplesText(request));
    add("maxDepth", std::to_string(depthOf(loaded.packed, request)));
    add("min-contribution", describe(command.scene.limits.minContribution));
    add("intersector", std::string(nameOf(command.scene.methods.triangles)));
    add("sphere", std::string(nameOf(command.scene.methods.spheres)));
    add("layers", joined(namesOf(command.aovs), ","));
    add("backend", std::string(nameOf(command.device.backend)));
    add("traversal", std::string(nameOf(command.device.traversal)));
    add("build-quality", std::string(nameOf(command.scene.buildQuality)));
    return identity;
}

class UnitRenderer {
  public:
    // `parts`: 0 for as many as take some seconds each, and at least `leastParts`.
    UnitRenderer(const RenderCommand& command, int parts, std::ostream& err, int leastParts = 1)
        : command_(command),
          err_(err),
          drawing_(command.device),
          loaded_(loadAndPack(command.scene, err)),
          request_(requestOf(command, loaded_)) {
        constexpr int kLikelyParts = 64;  // assumed before the image is cut
        const auto costs = farm::estimateCosts(loaded_.packed, request_, parts > 0 ? parts : kLikelyParts);
        cut_ = parts > 0 ? farm::cutPicture(costs, parts)
                         : farm::cutIntoUnits(costs, request_.samples.count(), leastParts,
                                              bytesPerPixel(command.aovs));
        parts = static_cast<int>(cut_.size());
        header_ = {identityOf(command, loaded_, request_), regionOf(request_), command.aovs, parts};
        header_.identity.facts.emplace_back("parts", std::to_string(parts));
        header_.identity.facts.emplace_back("cut", hashOf(cut_));
    }

    const farm::UnitHeader& header() const { return header_; }
    fs::path output() const { return outputOf(command_, loaded_.scene); }
    uint64_t pixelsOf(int part) const { return farm::pixelsOf(cut_[static_cast<size_t>(part) - 1]); }
    // Bytes of the largest unit.
    uint64_t mostBytes() const { return unitBytes(command_.aovs, farm::mostPixelsOf(cut_)); }

    // Empty if interrupted, or once `unwanted` returns true. `progress` gets the finished part of the unit.
    std::optional<farm::UnitResult> draw(int part, const std::function<void(double)>& progress,
                                         const std::function<bool()>& unwanted = {}) {
        Request request = request_;
        request.progress = progress;
        if (unwanted) request.cancelled = [&] { return interrupted() || unwanted(); };
        if (!uploaded_) drawing_.load(loaded_, request);
        uploaded_ = true;
        auto result = farm::drawUnit([&](const Request& r) { return drawing_.draw(r); }, request,
                                     cut_[static_cast<size_t>(part) - 1], command_.aovs);
        if (!result) return result;
        if (!reportsLosses(command_, loaded_)) result->losses = {};
        const DrawingFacts facts = drawing_.facts();
        result->part = part;
        result->producer = {facts.device, facts.backend == Backend::Cpu ? "" : facts.driver,
                            facts.sharesBits()};
        return result;
    }

    // Writes the complete image, with warnings, and prints its summary.
    ExitCode finish(UnitPicture& picture, std::ostream& out, int ranks = 0) const {
        Outcome outcome = picture.write(warningOf(command_.scene.scene), out, err_);
        if (!picture.file.goesByRows() && !command_.quiet)
            outcome.advice = pictureAdvice(picture.whole, loaded_, request_, picture.file.scale());
        outcome.ranks = ranks;
        warnAboutPicture(outcome, command_, loaded_, err_);
        return print(outcome, outcome.written.totals.done, out);
    }

    // Prints the summary of an image or part of so many pixels.
    ExitCode print(Outcome& outcome, uint64_t pixels, std::ostream& out) const {
        const uint32_t samples = request_.samples.count();
        outcome.drawn = drawing_.facts();
        outcome.written.totals = {pixels, pixels * samples, samples, samples};
        outcome.totalSeconds = total_.seconds();
        printResult(outcome, command_, loaded_, request_, out);
        drawing_.checkValidation();
        return ExitCode::Done;
    }

  private:
    const Stopwatch total_;
    const RenderCommand& command_;
    std::ostream& err_;
    Drawing drawing_;
    const LoadedScene loaded_;
    const Request request_;  // of the whole image
    farm::UnitHeader header_;
    std::vector<std::vector<Region>> cut_;
    bool uploaded_ = false;
};

fs::path partPath(const RenderCommand& command) {
    fs::path path = command.output;
    if (path.empty())
        path = command.scene.scene.stem().string() + "." + std::to_string(command.part->number) + "-of-" +
               std::to_string(command.part->of) + farm::kPartExtension;
    refuseIf(path.extension() != farm::kPartExtension,
             path.string() + ": the name of a part ends in .part; glint merge makes an image from the parts");
    checkOutputPath(path);
    return path;
}

// Enough units for each rank that all ranks finish at about the same time.
int leastUnits(const farm::Transport& transport) {
    constexpr int kUnitsOfRank = 8;
    return std::min(kUnitsOfRank * transport.size(), kMostParts);
}

ExitCode renderAsFirst(const RenderCommand& command, farm::Transport& transport, std::ostream& out,
                       std::ostream& err) {
    checkPicturePath(outputOf(command));
    installInterruptHandler();
    // Both outlive the thread of `ranks`, which adds results to the image.
    std::optional<UnitRenderer> units;
    std::optional<UnitPicture> picture;
    farm::FirstRank ranks(transport);
    RenderCommand mine = command;
    mine.scene.loading.source = ranks.files();
    units.emplace(mine, 0, err, leastUnits(transport));
    const farm::UnitHeader& header = units->header();
    const uint64_t unit = units->mostBytes();
    if (unit > std::numeric_limits<int>::max())  // MPI counts the bytes of a message by an int
        throw Error(ErrorKind::Failed,
                    "mpirun: the units of this image are larger than an MPI message can be; use --part");
    picture.emplace(header, units->output(), kHeldUnits * unit, command.bandRows.has_value(),
                    command.exposure);
    // Finished units that may wait for one above them.
    const uint64_t window = picture->file.goesByRows() ? availableMemory() / 2 / unit : header.parts;
    ranks.begin(header, static_cast<int>(std::clamp<uint64_t>(window, 1, header.parts)),
                [&](const farm::UnitResult& result) { picture->add(result); });
    {
        Progress progress = progressOf("render", command.progress, err);
        while (const auto part = ranks.next([&] { progress.update(ranks.share()); })) {
            const auto show = [&](double done) { progress.update(ranks.share() + done / header.parts); };
            const auto result = units->draw(*part, show, [&] { return ranks.failed(); });
            if (result) ranks.put(*result);
        }
    }
    if (!picture->assembly.complete())
        throw Error(ErrorKind::Interrupted, "interrupted before the image was finished; nothing written");
    const ExitCode code = units->finish(*picture, out, transport.size());
    ranks.end();
    return code;
}

// Prints nothing: rank 0 does.
ExitCode renderAsOther(const RenderCommand& command, farm::Transport& transport) {
    farm::OtherRank rank(transport);
    RenderCommand mine = command;
    mine.scene.loading.source = rank.files();
    installInterruptHandler();
    try {
        std::ostream silence(nullptr);
        UnitRenderer units(mine, 0, silence, leastUnits(transport));
        rank.begin(units.header());
        while (const auto part = rank.next())
            if (const auto result = units.draw(*part, {})) rank.put(*result);
    } catch (const Error& error) {
        rank.fail(error);
        return exitCodeOf(error.kind());
    } catch (const std::exception& error) {
        rank.fail(Error(ErrorKind::Failed, error.what()));
        return ExitCode::Failed;
    }
    return interrupted() ? ExitCode::Interrupted : ExitCode::Done;
}

ExitCode renderPart(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    const fs::path file = partPath(command);
    UnitRenderer units(command, command.part->of, err);
    const uint64_t pixels = units.pixelsOf(command.part->number);
    // 58 bytes a pixel, or 282 with depth and normal; 36 and 134 were measured.
    requireMemory(
        farm::namesOfParts({command.part->number}, command.part->of) + " (" + counted(pixels, "pixel") + ")",
        2 * pixels * bytesPerPixel(command), availableMemory(), "use more parts");
    installInterruptHandler();
    std::optional<farm::UnitResult> result;
    {
        Progress progress = progressOf("render", command.progress, err);
        result = units.draw(command.part->number, [&](double share) { progress.update(share); });
    }
    if (!result)
        throw Error(ErrorKind::Interrupted, "interrupted before the part was finished; nothing written");
    const Stopwatch writing;
    writeFile(file, farm::encodePart(units.header(), *result));
    Outcome outcome;
    outcome.region = units.header().region;
    outcome.flaws = *result;
    outcome.written.files = {file};
    outcome.written.seconds = writing.seconds();
    return units.print(outcome, pixels, out);
}

ExitCode renderFromCheckpoint(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    checkPicturePath(outputOf(command));
    checkOutputPath(command.checkpoint);
    UnitRenderer units(command, 0, err);
    const farm::UnitHeader& header = units.header();
    for (const fs::path& file : layerPaths(units.output(), namesOf(command.aovs)))
        refuseIf(fs::weakly_canonical(file) == fs::weakly_canonical(command.checkpoint),
                 file.string() + ": is the checkpoint, too; name another file with --output");
    UnitPicture picture(header, units.output(), kHeldUnits * units.mostBytes(), false, command.exposure);
    std::vector<bool> there(static_cast<size_t>(header.parts) + 1);
    const auto add = [&](const farm::UnitResult& result) {
        picture.add(result);
        there[static_cast<size_t>(result.part)] = true;
    };
    farm::Checkpoint checkpoint(command.checkpoint, header, add);
    installInterruptHandler();
    {
        Progress progress = progressOf("render", command.progress, err);
        const auto pixels = static_cast<double>(header.region.pixels());
        for (int part = 1; part <= header.parts; ++part) {
            if (there[static_cast<size_t>(part)]) continue;
            const double from = picture.assembly.share();
            const double share = static_cast<double>(units.pixelsOf(part)) / pixels;
            const auto show = [&](double done) { progress.update(from + share * done); };
            const auto result = interrupted() ? std::nullopt : units.draw(part, show);
            if (!result)
                throw Error(ErrorKind::Interrupted,
                            "interrupted: " + command.checkpoint.string() + " holds " +
                                std::to_string(std::count(there.begin(), there.end(), true)) + " of " +
                                counted(static_cast<uint64_t>(header.parts), "unit") +
                                "; repeat the command to resume");
            checkpoint.append(*result);
            add(*result);
        }
    }
    const ExitCode code = units.finish(picture, out);
    checkpoint.remove();
    return code;
}

}  // namespace

bool isInUnits(const RenderCommand& command) {
    if (command.part || !command.checkpoint.empty()) return true;
    if (!farm::launchedRank()) return false;
    refuseIf(command.frames.has_value(),
             "--frames: mpirun's processes share one image; give each machine frames of its own");
    refuseIf(command.target.error > 0, "mpirun: --error chooses the samples of the whole image; use --spp");
    return true;
}

ExitCode renderInUnits(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    if (command.part) return renderPart(command, out, err);
    if (!command.checkpoint.empty()) return renderFromCheckpoint(command, out, err);
    farm::Transport& transport = farm::openMpi();
    const ExitCode code = transport.rank() == 0 ? renderAsFirst(command, transport, out, err)
                                                : renderAsOther(command, transport);
    if (code == ExitCode::Done) farm::finishMpi();
    return code;
}

int rankOfLauncher() {
    return farm::launchedRank().value_or(0);
}

void abortRanks(int exitCode) {
    farm::abortMpi(exitCode);
}

bool hasRanksModule() {
    return farm::hasMpiModule();
}

namespace {

// ---- glint merge

struct MergeCommand {
    std::vector<fs::path> parts;
    fs::path output;  // empty: as `glint render` would call it
    std::optional<double> exposure;
    bool inBands = false;
    bool json = false;
    bool quiet = false;
};

void declare(OptionTable& table, MergeCommand& c) {
    table.files("PART", "all parts of one image, in any order", c.parts);
    table.name("-o,--output", "FILE", "image to write: .png .exr .pfm .hdr (default: SCENE.png, here)",
               c.output);
    addExposure(table, c.exposure);
    table.flag("--in-bands", "write row by row (default: if the image does not fit into memory)", c.inBands);
    addStats(table, "print parts, devices and hash as JSON instead of the summary", c.json);
    table.flag("-q,--quiet", "print only errors, and the output of --stats", c.quiet);
}

fs::path sceneOf(const farm::Identity& identity) {
    for (const auto& [name, value] : identity.facts)
        if (name == "scene") return value;
    return "image";
}

bool readsFile(const farm::Identity& identity, const fs::path& file) {
    return std::ranges::any_of(identity.facts,
                               [&](const auto& fact) { return fact.first == "file " + file.string(); });
}

nlohmann::json mergeJson(const fs::path& scene, const Outcome& outcome, const MergeCommand& command,
                         const std::vector<farm::Producer>& producers) {
    nlohmann::json json = imageJson(outcome);
    json.update({{"scene", scene.string()},
                 {"parts", command.parts.size()},
                 {"hash", outcome.written.hash},
                 {"inBands", outcome.written.bands > 0},
                 {"reproducible", std::all_of(producers.begin(), producers.end(),
                                              [](const auto& p) { return p.sharesBits; })},
                 {"seconds", outcome.totalSeconds},
                 {"devices", nlohmann::json::array()}});
    for (const farm::Producer& producer : producers) json["devices"].push_back(textOf(producer));
    return json;
}

ExitCode run(const MergeCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch watch;
    if (!command.quiet || command.json) checkStandardOutput(out);
    if (!command.output.empty()) checkPicturePath(inFolder(command.output, "image.png"));
    farm::UnitHeader header;
    std::optional<UnitPicture> picture;
    const auto begin = [&](const farm::UnitHeader& first, uint64_t largest) {
        header = first;
        fs::path output = sceneOf(header.identity).replace_extension(".png");
        if (!command.output.empty()) output = inFolder(command.output, output);
        if (command.output.empty() && readsFile(header.identity, output))
            output.replace_extension(".render.png");
        checkPicturePath(output);
        // A file, its contents, and its rows.
        picture.emplace(header, output, 3 * largest, command.inBands, command.exposure);
    };
    farm::mergeParts(command.parts, begin, [&](const farm::UnitResult& result) { picture->add(result); });
    const fs::path scene = sceneOf(header.identity);
    std::ostream silence(nullptr);
    std::ostream& warnings = command.quiet ? silence : err;
    const std::string start = warningOf(scene);
    Outcome outcome = picture->write(start, out, warnings);
    outcome.totalSeconds = watch.seconds();
    warnOf(outcome, true, start, warnings);
    const std::vector<farm::Producer>& producers = picture->assembly.producers();
    if (command.json) {
        printJson(mergeJson(scene, outcome, command, producers), out);
    } else if (!command.quiet) {
        printFiles(outcome, out);
        for (const farm::Producer& producer : producers) out << "device: " << textOf(producer) << '\n';
        out << "hash: " << outcome.written.hash << "\ntimes: " << formatSeconds(outcome.totalSeconds)
            << " for " << counted(command.parts.size(), "part") << '\n';
    }
    return ExitCode::Done;
}

}  // namespace

Run mergeCommand(OptionTable& table) {
    return commandOf<MergeCommand>(table, declare, run);
}

}  // namespace glint::app
