// Ways to render an image unit by unit: --part, --checkpoint, MPI.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <ostream>
#include <vector>

#include "app/commands.h"
#include "app/render_command.h"
#include "app/units.h"
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

uint64_t pixelsOf(const std::vector<Region>& regions) {
    uint64_t pixels = 0;
    for (const Region& r : regions) pixels += r.pixels();
    return pixels;
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

// Units of about a second on a processor: a process that ends loses its unit, and several processes share
// them out. Beyond a thousand units, their number and their cost both grow, because each unit costs rank 0
// two messages.
int partsFor(const farm::CostMap& costs, uint32_t samples) {
    constexpr double kTests = 1e8, kLeast = 16, kMany = 1024, kMost = 16384;
    const auto total =
        static_cast<double>(std::accumulate(costs.costs.begin(), costs.costs.end(), uint64_t{0}));
    const double parts = total * samples / kTests;
    return static_cast<int>(std::clamp(parts > kMany ? std::sqrt(kMany * parts) : parts, kLeast, kMost));
}

uint64_t mostPixelsOf(const std::vector<std::vector<Region>>& cut) {
    uint64_t most = 0;
    for (const std::vector<Region>& regions : cut) most = std::max(most, pixelsOf(regions));
    return most;
}

// Renderer and collector hold whole units. The cheapest units, of sky, have most pixels.
std::vector<std::vector<Region>> cutToHold(const farm::CostMap& costs, int parts, uint64_t bytesPerPixel) {
    constexpr uint64_t kUnitBytes = uint64_t{1} << 28;
    auto cut = farm::cutPicture(costs, parts);
    while (mostPixelsOf(cut) * bytesPerPixel > kUnitBytes && parts < kMostParts) {
        parts = std::min(2 * parts, kMostParts);
        cut = farm::cutPicture(costs, parts);
    }
    return cut;
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
                         : cutToHold(costs, std::max(partsFor(costs, request_.samples.count()), leastParts),
                                     bytesPerPixel(command.aovs));
        parts = static_cast<int>(cut_.size());
        header_ = {identityOf(command, loaded_, request_), regionOf(request_), command.aovs, parts};
        header_.identity.facts.emplace_back("parts", std::to_string(parts));
        header_.identity.facts.emplace_back("cut", hashOf(cut_));
    }

    const farm::UnitHeader& header() const { return header_; }
    std::filesystem::path output() const { return outputOf(command_, loaded_.scene); }
    uint64_t pixelsOf(int part) const { return app::pixelsOf(cut_[static_cast<size_t>(part) - 1]); }
    // Bytes of the largest unit.
    uint64_t mostBytes() const { return unitBytes(command_.aovs, mostPixelsOf(cut_)); }

    // Empty if interrupted, or once `unwanted` returns true. `progress` gets the finished part of the unit.
    std::optional<farm::UnitResult> draw(int part, const std::function<void(double)>& progress,
                                         const std::function<bool()>& unwanted = {});

    // Writes the image, with warnings.
    Outcome complete(UnitPicture& picture, std::ostream& out) const {
        Outcome outcome = picture.write(out);
        if (!picture.file().goesByRows() && !command_.quiet)
            outcome.advice = pictureAdvice(picture.picture(), loaded_, request_, picture.file().scale());
        warnAboutPicture(outcome, command_, loaded_, err_);
        warnOfMixedBits(picture.assembly().producers(),
                        "glint: warning: " + command_.scene.scene.string() + ": ", err_);
        return outcome;
    }

    // Prints the summary of an image or part of so many pixels.
    ExitCode finish(Outcome& outcome, uint64_t pixels, std::ostream& out) const {
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

std::optional<farm::UnitResult> UnitRenderer::draw(int part, const std::function<void(double)>& progress,
                                                   const std::function<bool()>& unwanted) {
    Request request = request_;
    request.progress = progress;
    if (unwanted) request.cancelled = [&] { return interrupted() || unwanted(); };
    if (!uploaded_) drawing_.load(loaded_, request);
    uploaded_ = true;
    auto result = farm::drawUnit([&](const Request& r) { return drawing_.draw(r); }, request,
                                 cut_[static_cast<size_t>(part) - 1], command_.aovs);
    if (!result) return result;
    // Losses are reported in the same cases as for an image without units.
    if (!loaded_.packed.features.transmission && command_.scene.limits.minContribution == 0)
        result->losses = {};
    const DrawingFacts facts = drawing_.facts();
    result->part = part;
    result->producer = {facts.device, facts.backend == Backend::Cpu ? "" : facts.driver, facts.sharesBits()};
    return result;
}

std::filesystem::path partPath(const RenderCommand& command) {
    std::filesystem::path path = command.output;
    if (path.empty())
        path = command.scene.scene.stem().string() + "." + std::to_string(command.part->number) + "-of-" +
               std::to_string(command.part->of) + farm::kPartExtension;
    refuseIf(path.extension() != farm::kPartExtension,
             path.string() + ": the name of a part ends in .part; glint merge makes an image from the parts");
    checkOutputPath(path);
    return path;
}

// Reserves 58 bytes a pixel, or 282 with depth and normal; 36 and 134 were measured.
void checkRoom(const RenderCommand& command, uint64_t pixels) {
    requireMemory(
        farm::namesOfParts({command.part->number}, command.part->of) + " (" + counted(pixels, "pixel") + ")",
        2 * pixels * bytesPerPixel(command), availableMemory(), "use more parts");
}

// Enough units for each rank that all ranks finish at about the same time.
int leastUnits(const farm::Transport& transport) {
    constexpr int kUnitsOfRank = 8;
    return std::min(kUnitsOfRank * transport.size(), kMostParts);
}

// Finished units that may wait for one above them, if the image goes into the file row by row.
int windowOf(const farm::UnitHeader& header, uint64_t unit, bool rows) {
    if (!rows) return header.parts;
    return static_cast<int>(std::clamp<uint64_t>(availableMemory() / 2 / unit, 1, header.parts));
}

// MPI counts the bytes of a message by an int.
void checkMessage(uint64_t unit) {
    if (unit > std::numeric_limits<int>::max())
        throw Error(ErrorKind::Failed,
                    "mpirun: the units of this image are larger than an MPI message can be; use --part");
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
    checkMessage(unit);
    picture.emplace(header, units->output(), kHeldUnits * unit, command.bandRows.has_value(),
                    command.exposure);
    ranks.begin(header, windowOf(header, unit, picture->file().goesByRows()),
                [&](const farm::UnitResult& result) { picture->add(result); });
    {
        Progress progress = progressOf("render", command.progress, err);
        while (const auto part = ranks.next([&] { progress.update(ranks.share()); })) {
            const auto show = [&](double done) { progress.update(ranks.share() + done / header.parts); };
            const auto result = units->draw(*part, show, [&] { return ranks.failed(); });
            if (result) ranks.put(*result);
        }
    }
    if (!picture->assembly().complete())
        throw Error(ErrorKind::Interrupted, "interrupted before the image was finished; nothing written");
    Outcome outcome = units->complete(*picture, out);
    ranks.end();
    outcome.ranks = transport.size();
    return units->finish(outcome, outcome.written.totals.done, out);
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
    const std::filesystem::path file = partPath(command);
    UnitRenderer units(command, command.part->of, err);
    const uint64_t pixels = units.pixelsOf(command.part->number);
    checkRoom(command, pixels);
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
    return units.finish(outcome, pixels, out);
}

ExitCode renderFromCheckpoint(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    checkPicturePath(outputOf(command));
    checkOutputPath(command.checkpoint);
    UnitRenderer units(command, 0, err);
    const farm::UnitHeader& header = units.header();
    for (const std::filesystem::path& file : layerPaths(units.output(), namesOf(command.aovs)))
        refuseIf(
            std::filesystem::weakly_canonical(file) == std::filesystem::weakly_canonical(command.checkpoint),
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
            const double from = picture.assembly().share();
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
    Outcome outcome = units.complete(picture, out);
    checkpoint.remove();
    return units.finish(outcome, outcome.written.totals.done, out);
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

}  // namespace glint::app
