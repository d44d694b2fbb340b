#include "app/render_ranks.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <ostream>
#include <sstream>

#include "app/common.h"
#include "app/output_check.h"
#include "app/render_result.h"
#include "app/render_units.h"
#include "app/unit_picture.h"
#include "app/unit_renderer.h"
#include "core/available_memory.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/stopwatch.h"
#include "farm/mpi_transport.h"
#include "farm/ranks.h"

namespace glint::app {

namespace {

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
        Progress progress("render", command.quiet ? ProgressMode::None : command.progress, err,
                          isTerminal(err));
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
