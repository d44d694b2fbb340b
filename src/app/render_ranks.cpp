#include "app/render_ranks.h"

#include <algorithm>
#include <limits>
#include <ostream>
#include <sstream>
#include <thread>

#include "app/common.h"
#include "app/exit_code.h"
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

// So that all come to an end at about the same time.
constexpr int kUnitsOfRank = 8;

int leastUnits(int ranks) {
    return std::min(kUnitsOfRank * ranks, farm::kMostParts);
}

// Units that may be done before one that stands above them in the picture.
int windowOf(const farm::UnitHeader& header, uint64_t unit, bool rows) {
    if (!rows) return header.parts;
    return static_cast<int>(std::clamp<uint64_t>(availableMemory() / 2 / unit, 1, header.parts));
}

// MPI counts the bytes of a message by an int.
void checkMessage(const UnitRenderer& units, uint64_t bytes) {
    if (bytes <= std::numeric_limits<int>::max()) return;
    throw Error(ErrorKind::Failed,
                "mpirun: a unit of this picture has up to " + std::to_string(units.mostPixels()) +
                    " pixels, more than a message of MPI holds; --join and --part draw it");
}

void warnOfLostRanks(const std::vector<std::string>& lost, std::ostream& err) {
    for (const std::string& rank : lost)
        err << "glint: warning: " << rank << " has gone; what it had was drawn by others\n";
}

// What rank 0 does besides drawing: puts the picture together.
class Writer {
  public:
    Writer(farm::FirstRank& ranks, UnitPicture& picture)
        : thread_([&ranks, &picture] {
              try {
                  while (const auto result = ranks.take()) {
                      picture.add(*result);
                      ranks.settle(result->unit.part);
                  }
              } catch (const Error& error) {
                  ranks.fail(error);
              } catch (const std::exception& error) {
                  ranks.fail(Error(ErrorKind::Failed, error.what()));
              }
          }) {}
    ~Writer() { join(); }
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;
    void join() {
        if (thread_.joinable()) thread_.join();
    }

  private:
    std::thread thread_;
};

void drawShare(UnitRenderer& units, farm::FirstRank& ranks, Progress& progress) {
    const double parts = units.header().parts;
    const auto waiting = [&] { progress.update(ranks.share()); };
    while (const auto part = ranks.next(waiting)) {
        const auto show = [&](double done) { progress.update(ranks.share() + done / parts); };
        auto result = units.draw(*part, show, [&] { return ranks.isDone(*part); });
        if (result) ranks.put(std::move(*result));
    }
}

int drawAsFirst(const RenderCommand& command, farm::FirstRank& ranks, int count, std::ostream& out,
                std::ostream& err) {
    const Stopwatch total;
    const std::filesystem::path output = outputOf(command);
    checkPicturePath(output);
    installInterruptHandler();
    UnitRenderer units(command, 0, err, leastUnits(count));
    const farm::UnitHeader& header = units.header();
    const uint64_t unit = unitBytes(command.aovs, units.mostPixels());
    checkMessage(units, unit);
    const bool rows = needsRows(header, output, 3 * unit, availableMemory(), command.bandRows.has_value());
    UnitPicture picture(header, output, rows);
    ranks.begin(header, windowOf(header, unit, rows));
    try {
        Writer writer(ranks, picture);
        Progress progress("render", command.quiet ? ProgressMode::None : command.progress, err,
                          isTerminal(err));
        drawShare(units, ranks, progress);
        writer.join();
    } catch (const Error& error) {
        ranks.fail(error);
        throw;
    }
    ranks.check();
    if (!picture.assembly().complete())
        throw Error(ErrorKind::Interrupted, "interrupted before the picture was finished; nothing written");
    Outcome outcome = picture.write();
    outcome.ranks = count;
    outcome.lostRanks = ranks.lost();
    if (!command.quiet) warnOfLostRanks(outcome.lostRanks, err);
    units.complete(outcome, picture.assembly().producers(), err);
    outcome.totalSeconds = total.seconds();
    printResult(outcome, command, units.loaded(), out);
    units.drawing().reportValidation(err);
    return static_cast<int>(ExitCode::Done);
}

int renderAsFirst(const RenderCommand& command, farm::Post& post, std::ostream& out, std::ostream& err) {
    farm::FirstRank ranks(post, command.lease);
    RenderCommand mine = command;
    mine.scene.files = ranks.files();
    try {
        const int code = drawAsFirst(mine, ranks, post.size(), out, err);
        ranks.end(code);
        return code;
    } catch (const Error& error) {
        ranks.end(static_cast<int>(exitCodeOf(error.kind())));
        throw;
    } catch (const std::exception&) {
        ranks.end(static_cast<int>(ExitCode::Failed));
        throw;
    }
}

// Says nothing: rank 0 does.
int renderAsOther(const RenderCommand& command, farm::Post& post) {
    farm::OtherRank rank(post, command.lease);
    RenderCommand mine = command;
    mine.scene.files = rank.files();
    mine.quiet = true;
    installInterruptHandler();
    try {
        std::ostringstream silence;
        UnitRenderer units(mine, 0, silence, leastUnits(post.size()));
        rank.begin(units.header());
        while (const auto part = rank.next()) {
            const auto result = units.draw(*part, {}, [&] { return rank.isDone(*part); });
            if (result) rank.put(*result);
        }
        if (interrupted()) rank.fail(Error(ErrorKind::Interrupted, "interrupted"));
    } catch (const farm::OtherRank::Ended&) {
    } catch (const Error& error) {
        rank.fail(error);
    } catch (const std::exception& error) {
        rank.fail(Error(ErrorKind::Failed, error.what()));
    }
    return rank.end();
}

}  // namespace

bool isForRanks(const RenderCommand& command) {
    if (command.part || !command.checkpoint.empty() || !command.join.empty()) return false;
    if (!farm::launchedByMpi()) return false;
    if (command.frames)
        throw Error(ErrorKind::Argument,
                    "--frames: mpirun's processes share one picture; give each machine frames of its own");
    refuseErrorTarget(command, "mpirun");
    return true;
}

int renderAmongRanks(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    farm::Post post(farm::openMpi);
    return post.rank() == 0 ? renderAsFirst(command, post, out, err) : renderAsOther(command, post);
}

}  // namespace glint::app
