#include "app/render_units.h"

#include <chrono>
#include <nlohmann/json.hpp>
#include <numeric>
#include <ostream>
#include <thread>

#include "app/common.h"
#include "app/drawing.h"
#include "app/exit_code.h"
#include "app/output_check.h"
#include "app/render_identity.h"
#include "app/render_result.h"
#include "core/available_memory.h"
#include "core/content_hash.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/image_io.h"
#include "core/interrupt.h"
#include "core/picture_hash.h"
#include "core/stopwatch.h"
#include "farm/checkpoint.h"
#include "farm/cut.h"
#include "farm/merge.h"
#include "farm/shared_folder.h"
#include "farm/unit_file.h"

namespace glint::app {

namespace {

std::filesystem::path partPath(const RenderCommand& command) {
    std::filesystem::path path = command.output;
    if (path.empty())
        path = command.scene.scene.stem().string() + "." + std::to_string(command.part->number) + "-of-" +
               std::to_string(command.part->of) + farm::kPartExtension;
    if (path.extension() != farm::kPartExtension)
        throw Error(ErrorKind::Argument,
                    path.string() +
                        ": a part goes into a file that ends in .part; glint merge makes "
                        "the picture of all parts");
    checkOutputPath(path);
    return path;
}

uint64_t pixelsOf(const std::vector<Region>& regions) {
    uint64_t pixels = 0;
    for (const Region& r : regions)
        pixels += static_cast<uint64_t>(r.width()) * static_cast<uint64_t>(r.height());
    return pixels;
}

// Where the picture was cut must be the same for all parts, so that none is drawn twice or never.
std::string hashOf(const std::vector<std::vector<Region>>& cut) {
    std::string text;
    for (const auto& regions : cut) {
        for (const Region& r : regions)
            for (const int value : {r.x0, r.y0, r.x1, r.y1}) text += std::to_string(value) + ",";
        text += ";";
    }
    return hashText(contentHash(text));
}

struct Done {
    std::filesystem::path file;
    uint64_t pixels = 0;
    DrawingFacts drawn;
    double totalSeconds = 0;
};

void print(const Done& done, const RenderCommand& command, const LoadedScene& loaded, std::ostream& out) {
    const farm::Unit unit = {0, command.part->number, command.part->of};
    if (command.json) {
        nlohmann::json json = {{"scene", command.scene.scene.string()},
                               {"files", {done.file.string()}},
                               {"part", unit.part},
                               {"parts", unit.parts},
                               {"pixels", done.pixels},
                               {"backend", nameOf(done.drawn.failed ? Backend::Cpu : command.backend)},
                               {"device", done.drawn.device},
                               {"driver", done.drawn.driver},
                               {"reproducible", done.drawn.sharesBits()},
                               {"seconds",
                                {{"load", loaded.loadSeconds},
                                 {"pack", loaded.packSeconds},
                                 {"trace", done.drawn.times.trace},
                                 {"total", done.totalSeconds}}}};
        if (done.drawn.failed) json["fallback"] = fallbackJson(*done.drawn.failed);
        out << json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
    } else if (!command.quiet) {
        out << "wrote " << done.file.string() << " (" << farm::nameOf(unit) << ", "
            << counted(done.pixels, "pixel") << ")\n";
        out << "device: " << done.drawn.device << ", " << done.drawn.driver << '\n';
        out << "times: load " << formatSeconds(loaded.loadSeconds) << ", BVH and packing "
            << formatSeconds(loaded.packSeconds) << ", trace " << formatSeconds(done.drawn.times.trace)
            << "; " << formatSeconds(done.totalSeconds) << " in all\n";
    }
}

// A picture in units: what they are, and who draws them.
class UnitRenderer {
  public:
    // `parts`: 0 for as many as take some seconds each.
    UnitRenderer(const RenderCommand& command, int parts, std::ostream& err);

    const farm::UnitHeader& header() const { return header_; }
    const LoadedScene& loaded() const { return loaded_; }
    const Drawing& drawing() const { return drawing_; }
    uint64_t pixelsOf(int part) const;

    // Nothing if it was interrupted. `from`, `to`: how much of all is done before and after, for the bar.
    std::optional<farm::UnitResult> draw(int part, double from, double to, Progress& progress);

    // Writes the picture that all units make, with summary and warnings.
    Outcome write(farm::Assembly& assembly, const std::vector<farm::Producer>& producers,
                  const std::filesystem::path& output, std::ostream& err);

  private:
    const RenderCommand& command_;
    Drawing drawing_;
    const LoadedScene loaded_;
    Request request_;  // of the whole picture
    farm::UnitHeader header_;
    std::vector<std::vector<Region>> cut_;
    bool uploaded_ = false;
};

// Units of some seconds on a processor: they get lost with who draws them, and shared out.
int partsFor(const farm::CostMap& costs, uint32_t samples) {
    constexpr double kTests = 1e8, kLeast = 16, kMost = 1024;
    const auto total =
        static_cast<double>(std::accumulate(costs.costs.begin(), costs.costs.end(), uint64_t{0}));
    return static_cast<int>(std::clamp(total * samples / kTests, kLeast, kMost));
}

UnitRenderer::UnitRenderer(const RenderCommand& command, int parts, std::ostream& err)
    : command_(command),
      drawing_(command.backend, command.device, command.quiet ? nullptr : &err),
      loaded_(loadAndPack(command.scene, err, command.quiet)) {
    constexpr int kLikelyParts = 64;  // to know how many before they are cut
    const Region region = checkedRegion(command, loaded_.scene);
    Progress none("", ProgressMode::None, err, false);
    request_ = requestOf(command, loaded_, region, none);
    request_.progress = nullptr;
    const auto costs =
        farm::estimateCosts(loaded_.packed, loaded_.scene.camera, request_, parts > 0 ? parts : kLikelyParts);
    if (parts == 0) parts = partsFor(costs, request_.samples.count());
    cut_ = farm::cutPicture(costs, parts);
    header_ = {identityOf(command, loaded_, request_), region, command.aovs, parts};
    header_.identity.facts.emplace_back("parts", std::to_string(parts));
    header_.identity.facts.emplace_back("cut", hashOf(cut_));
}

uint64_t UnitRenderer::pixelsOf(int part) const {
    return app::pixelsOf(cut_[static_cast<size_t>(part) - 1]);
}

std::optional<farm::UnitResult> UnitRenderer::draw(int part, double from, double to, Progress& progress) {
    Request request = request_;
    request.progress = [&](double done) { progress.update(from + (to - from) * done); };
    if (!uploaded_) drawing_.load(loaded_, request);
    uploaded_ = true;
    auto result = drawing_.whole([&] {
        return farm::drawUnit([&](const Request& r) { return drawing_.draw(r); }, request,
                              cut_[static_cast<size_t>(part) - 1], command_.aovs);
    });
    if (!result) return result;
    // Losses are told where a picture drawn at once would tell them.
    if (!loaded_.packed.features.transmission && command_.scene.minContribution == 0) result->losses = {};
    const DrawingFacts facts = drawing_.facts();
    result->unit = {0, part, header_.parts};
    result->producer = {facts.device, drawing_.backend() == Backend::Cpu ? "" : facts.driver,
                        facts.sharesBits()};
    return result;
}

Outcome UnitRenderer::write(farm::Assembly& assembly, const std::vector<farm::Producer>& producers,
                            const std::filesystem::path& output, std::ostream& err) {
    const Stopwatch writing;
    Outcome outcome;
    outcome.picture = assembly.picture();
    if (uploaded_) outcome.drawn = drawing_.facts();
    if (!command_.quiet) {
        warnAboutPicture(outcome, command_, loaded_, err);
        warnOfMixedBits(producers, "glint: warning: " + command_.scene.scene.string() + ": ", err);
    }
    outcome.hash = pictureHash(outcome.picture.color);
    outcome.files = writeLayers(output, assembly.takeLayers());
    outcome.writeSeconds = writing.seconds();
    return outcome;
}

void refuseErrorTarget(const RenderCommand& command, const char* option) {
    if (command.target.error)
        throw Error(ErrorKind::Argument,
                    std::string(option) +
                        ": --error decides by the whole picture how many samples it takes; "
                        "give --spp");
}

void checkRoom(const RenderCommand& command, const Region& region, uint64_t pixels) {
    const auto rows = static_cast<int>(pixels / static_cast<uint64_t>(region.width())) + 1;
    // As drawn, as layers, and as the bytes of the file.
    checkMemory(region.width(), rows, 2 * bytesPerPixel(command.aovs, needsData(command)), availableMemory());
}

ProgressMode progressOf(const RenderCommand& command) {
    return command.quiet ? ProgressMode::None : command.progress;
}

}  // namespace

int renderPart(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch total;
    refuseErrorTarget(command, "--part");
    Done done;
    done.file = partPath(command);
    UnitRenderer units(command, command.part->of, err);
    done.pixels = units.pixelsOf(command.part->number);
    checkRoom(command, units.header().region, done.pixels);
    installInterruptHandler();
    std::optional<farm::UnitResult> result;
    {
        Progress progress("render", progressOf(command), err, isTerminal(err));
        result = units.draw(command.part->number, 0, 1, progress);
    }
    if (!result)
        throw Error(ErrorKind::Interrupted, "interrupted before the part was finished; nothing written");
    writeFiles({{done.file, farm::encodeUnits(units.header(), {*result})}});
    done.drawn = units.drawing().facts();
    done.totalSeconds = total.seconds();
    print(done, command, units.loaded(), out);
    units.drawing().reportValidation(err);
    return static_cast<int>(ExitCode::Done);
}

int renderFromCheckpoint(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch total;
    refuseErrorTarget(command, "--checkpoint");
    const std::filesystem::path output = outputOf(command);
    checkPicturePath(output);
    checkOutputPath(command.checkpoint);
    UnitRenderer units(command, 0, err);
    const farm::UnitHeader& header = units.header();
    checkRoom(command, header.region, static_cast<uint64_t>(header.region.width()) * header.region.height());
    farm::Checkpoint checkpoint(command.checkpoint, header);
    farm::Assembly assembly(header.region, header.aovs);
    std::vector<farm::Producer> producers;
    std::vector<bool> there(static_cast<size_t>(header.parts) + 1);
    const auto add = [&](const farm::UnitResult& result) {
        assembly.add(result);
        there[static_cast<size_t>(result.unit.part)] = true;
        if (std::find(producers.begin(), producers.end(), result.producer) == producers.end())
            producers.push_back(result.producer);
    };
    for (const farm::UnitResult& result : checkpoint.found()) add(result);
    checkpoint.found() = {};
    installInterruptHandler();
    {
        Progress progress("render", progressOf(command), err, isTerminal(err));
        const auto pixels = static_cast<double>(assembly.picture().done.size());
        for (int part = 1; part <= header.parts; ++part) {
            if (there[static_cast<size_t>(part)]) continue;
            const double from = assembly.share();
            const double to = from + static_cast<double>(units.pixelsOf(part)) / pixels;
            const auto result = interrupted() ? std::nullopt : units.draw(part, from, to, progress);
            if (!result)
                throw Error(ErrorKind::Interrupted,
                            "interrupted: " + command.checkpoint.string() + " holds " +
                                std::to_string(std::count(there.begin(), there.end(), true)) + " of " +
                                counted(static_cast<uint64_t>(header.parts), "unit") +
                                "; the same command goes on");
            checkpoint.append(*result);
            add(*result);
        }
    }
    Outcome outcome = units.write(assembly, producers, output, err);
    checkpoint.remove();
    outcome.totalSeconds = total.seconds();
    printResult(outcome, command, units.loaded(), out);
    units.drawing().reportValidation(err);
    return static_cast<int>(ExitCode::Done);
}

namespace {

// Draws units until all are there. False if it was interrupted.
bool drawTogether(UnitRenderer& units, farm::SharedFolder& folder, Progress& progress) {
    const auto parts = static_cast<double>(units.header().parts);
    for (int done = folder.done(); done < units.header().parts; done = folder.done()) {
        if (interrupted()) return false;
        const auto part = folder.next();
        if (!part) {
            progress.update(done / parts);
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
            continue;
        }
        const auto result = units.draw(*part, done / parts, (done + 1) / parts, progress);
        if (!result) {
            folder.giveUp();
            return false;
        }
        folder.put(*result);
    }
    return true;
}

// True once the picture stands at `output`, or it is for this process to write it there.
enum class Written { ByOther, ByMe, Interrupted };
Written waitForPicture(farm::SharedFolder& folder, const std::filesystem::path& output) {
    while (true) {
        const auto note = folder.note();
        std::error_code ignored;
        if (note && *note == output.string() && std::filesystem::exists(output, ignored))
            return Written::ByOther;
        // It was written elsewhere, or is gone.
        if (note || folder.mayMerge()) return Written::ByMe;
        if (interrupted()) return Written::Interrupted;
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
}

}  // namespace

int renderTogether(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch total;
    refuseErrorTarget(command, "--join");
    const std::filesystem::path output = std::filesystem::absolute(outputOf(command)).lexically_normal();
    checkPicturePath(output);
    UnitRenderer units(command, 0, err);
    const farm::UnitHeader& header = units.header();
    checkRoom(command, header.region, static_cast<uint64_t>(header.region.width()) * header.region.height());
    installInterruptHandler();
    farm::SharedFolder folder(command.join, header, command.lease);
    Written written = Written::Interrupted;
    {
        Progress progress("render", progressOf(command), err, isTerminal(err));
        if (drawTogether(units, folder, progress)) written = waitForPicture(folder, output);
    }
    if (written == Written::Interrupted)
        throw Error(ErrorKind::Interrupted, "interrupted: " + command.join.string() + " holds " +
                                                std::to_string(folder.done()) + " of " +
                                                counted(static_cast<uint64_t>(header.parts), "unit") +
                                                "; others go on, and so does the same command");
    if (written == Written::ByOther) {
        if (!command.quiet) out << output.string() << " was written by another process\n";
        return static_cast<int>(ExitCode::Done);
    }
    std::vector<farm::Producer> producers;
    farm::Assembly assembly = folder.assembled(producers);
    Outcome outcome = units.write(assembly, producers, output, err);
    folder.setNote(output.string());
    outcome.totalSeconds = total.seconds();
    printResult(outcome, command, units.loaded(), out);
    units.drawing().reportValidation(err);
    return static_cast<int>(ExitCode::Done);
}

}  // namespace glint::app
