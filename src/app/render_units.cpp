#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <sstream>
#include <vector>

#include "app/common.h"
#include "app/drawing.h"
#include "app/render_command.h"
#include "app/render_result.h"
#include "app/units.h"
#include "core/available_memory.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/interrupt.h"
#include "core/stopwatch.h"
#include "farm/checkpoint.h"
#include "farm/merge.h"
#include "farm/ranks.h"
#include "farm/transport.h"
#include "farm/unit_file.h"

namespace glint::app {

namespace {

std::filesystem::path partPath(const RenderCommand& command) {
    std::filesystem::path path = command.output;
    if (path.empty())
        path = command.scene.scene.stem().string() + "." + std::to_string(command.part->number) + "-of-" +
               std::to_string(command.part->of) + farm::kPartExtension;
    if (path.extension() != farm::kPartExtension)
        throw Error(
            ErrorKind::Argument,
            path.string() + ": the name of a part ends in .part; glint merge makes an image from the parts");
    checkOutputPath(path);
    return path;
}

void print(const Outcome& outcome, uint64_t pixels, const RenderCommand& command, const LoadedScene& loaded,
           std::ostream& out) {
    const PartChoice& part = *command.part;
    if (command.json) {
        nlohmann::json json = {{"scene", command.scene.scene.string()},
                               {"files", filesJson(outcome.files)},
                               {"part", part.number},
                               {"parts", part.of},
                               {"pixels", pixels},
                               {"seconds",
                                {{"load", loaded.loadSeconds},
                                 {"pack", loaded.packSeconds},
                                 {"trace", outcome.drawn.times.trace},
                                 {"total", outcome.totalSeconds}}}};
        json.update(drawnJson(outcome.drawn));
        printJson(json, out);
    } else if (!command.quiet) {
        out << "wrote " << shown(outcome.files.front()) << " (" << farm::namesOfParts({part.number}, part.of)
            << ", " << counted(pixels, "pixel") << ")\n";
        printDevice(outcome.drawn, out);
        printTimes(outcome, loaded, out);
    }
}

// Reserves 58 bytes a pixel, or 282 with depth and normal; 36 and 134 were measured.
void checkRoom(const RenderCommand& command, uint64_t pixels) {
    const uint64_t needed = 2 * pixels * bytesPerPixel(command.aovs, needsData(command));
    const uint64_t available = availableMemory();
    if (needed <= available) return;
    throw Error(ErrorKind::Failed, farm::namesOfParts({command.part->number}, command.part->of) + " has " +
                                       counted(pixels, "pixel") + ", which take " + gibibytes(needed) +
                                       " of memory, " + gibibytes(available) + " are free; use more parts");
}

// Leaves room for a unit while it is rendered, encoded and copied into the image.
bool goesByRows(const RenderCommand& command, const UnitRenderer& units,
                const std::filesystem::path& output) {
    return needsRows(units.header(), output, 3 * unitBytes(command.aovs, units.mostPixels()),
                     availableMemory());
}

// Enough units for each rank that all ranks finish at about the same time.
int leastUnits(const farm::Transport& transport) {
    constexpr int kUnitsOfRank = 8;
    return std::min(kUnitsOfRank * transport.size(), farm::kMostParts);
}

// Finished units that may wait for one above them, if the image goes into the file row by row.
int windowOf(const farm::UnitHeader& header, uint64_t unit, bool rows) {
    if (!rows) return header.parts;
    return static_cast<int>(std::clamp<uint64_t>(availableMemory() / 2 / unit, 1, header.parts));
}

// MPI counts the bytes of a message by an int.
void checkMessage(const UnitRenderer& units, uint64_t bytes) {
    if (bytes <= std::numeric_limits<int>::max()) return;
    throw Error(ErrorKind::Failed, "mpirun: a unit of this image has up to " +
                                       std::to_string(units.mostPixels()) +
                                       " pixels, more than an MPI message can hold; use --part");
}

ExitCode renderAsFirst(const RenderCommand& command, farm::Transport& transport, std::ostream& out,
                       std::ostream& err) {
    const Stopwatch total;
    checkPicturePath(outputOf(command));
    installInterruptHandler();
    // Both outlive the thread of `ranks`, which adds results to the picture.
    std::optional<UnitRenderer> units;
    std::optional<UnitPicture> picture;
    farm::FirstRank ranks(transport);
    RenderCommand mine = command;
    mine.scene.files = ranks.files();
    units.emplace(mine, 0, err, leastUnits(transport));
    const farm::UnitHeader& header = units->header();
    const std::filesystem::path output = outputOf(command, units->loaded().scene);
    const uint64_t unit = unitBytes(command.aovs, units->mostPixels());
    checkMessage(*units, unit);
    const bool rows = needsRows(header, output, 3 * unit, availableMemory(), command.bandRows.has_value());
    picture.emplace(header, output, rows, scaleOf(output, command.exposure));
    ranks.begin(header, windowOf(header, unit, rows),
                [&](const farm::UnitResult& result) { picture->add(result); });
    {
        Progress progress = progressOf("render", command.shownProgress(), err);
        while (const auto part = ranks.next([&] { progress.update(ranks.share()); })) {
            const auto show = [&](double done) { progress.update(ranks.share() + done / header.parts); };
            const auto result = units->draw(*part, show, [&] { return ranks.failed(); });
            if (result) ranks.put(*result);
        }
    }
    if (!picture->assembly().complete())
        throw Error(ErrorKind::Interrupted, "interrupted before the image was finished; nothing written");
    Outcome outcome = picture->write();
    ranks.end();
    outcome.ranks = transport.size();
    units->complete(outcome, picture->assembly().producers(), err);
    outcome.totalSeconds = total.seconds();
    printResult(outcome, command, units->loaded(), out);
    units->drawing().reportValidation(err);
    return ExitCode::Done;
}

// Prints nothing: rank 0 does.
ExitCode renderAsOther(const RenderCommand& command, farm::Transport& transport) {
    farm::OtherRank rank(transport);
    RenderCommand mine = command;
    mine.scene.files = rank.files();
    mine.quiet = true;
    installInterruptHandler();
    try {
        std::ostringstream silence;
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

}  // namespace

void refuseErrorTarget(const RenderCommand& command, const std::string& manner) {
    if (command.target.error)
        throw Error(ErrorKind::Argument,
                    manner + ": --error chooses the samples of the whole image; use --spp");
}

ExitCode renderPart(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch total;
    refuseErrorTarget(command, "--part");
    const std::filesystem::path file = partPath(command);
    UnitRenderer units(command, command.part->of, err);
    const uint64_t pixels = units.pixelsOf(command.part->number);
    checkRoom(command, pixels);
    installInterruptHandler();
    std::optional<farm::UnitResult> result;
    {
        Progress progress = progressOf("render", command.shownProgress(), err);
        result = units.draw(command.part->number, [&](double share) { progress.update(share); });
    }
    if (!result)
        throw Error(ErrorKind::Interrupted, "interrupted before the part was finished; nothing written");
    Outcome outcome;
    const Stopwatch writing;
    writeFile(file, farm::encodePart(units.header(), *result));
    outcome.files = {file};
    outcome.writeSeconds = writing.seconds();
    outcome.drawn = units.drawing().facts();
    outcome.totalSeconds = total.seconds();
    print(outcome, pixels, command, units.loaded(), out);
    units.drawing().reportValidation(err);
    return ExitCode::Done;
}

ExitCode renderFromCheckpoint(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch total;
    refuseErrorTarget(command, "--checkpoint");
    checkPicturePath(outputOf(command));
    checkOutputPath(command.checkpoint);
    UnitRenderer units(command, 0, err);
    const std::filesystem::path output = outputOf(command, units.loaded().scene);
    const farm::UnitHeader& header = units.header();
    UnitPicture picture(header, output, goesByRows(command, units, output),
                        scaleOf(output, command.exposure));
    std::vector<bool> there(static_cast<size_t>(header.parts) + 1);
    const auto add = [&](const farm::UnitResult& result) {
        picture.add(result);
        there[static_cast<size_t>(result.part)] = true;
    };
    farm::Checkpoint checkpoint(command.checkpoint, header, add);
    installInterruptHandler();
    {
        Progress progress = progressOf("render", command.shownProgress(), err);
        const double pixels = static_cast<double>(header.region.width()) * header.region.height();
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
    Outcome outcome = picture.write();
    units.complete(outcome, picture.assembly().producers(), err);
    checkpoint.remove();
    outcome.totalSeconds = total.seconds();
    printResult(outcome, command, units.loaded(), out);
    units.drawing().reportValidation(err);
    return ExitCode::Done;
}

bool isForRanks(const RenderCommand& command) {
    if (command.part || !command.checkpoint.empty()) return false;
    if (!farm::launchedRank()) return false;
    if (command.frames)
        throw Error(ErrorKind::Argument,
                    "--frames: mpirun's processes share one image; give each machine frames of its own");
    refuseErrorTarget(command, "mpirun");
    return true;
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

ExitCode renderAmongRanks(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    const auto transport = farm::openMpi();
    const ExitCode code = transport->rank() == 0 ? renderAsFirst(command, *transport, out, err)
                                                 : renderAsOther(command, *transport);
    if (code == ExitCode::Done) transport->finish();
    return code;
}

}  // namespace glint::app
