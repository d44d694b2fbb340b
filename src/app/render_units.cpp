#include "app/render_units.h"

#include <chrono>
#include <nlohmann/json.hpp>
#include <ostream>
#include <thread>

#include "app/common.h"
#include "app/drawing.h"
#include "app/exit_code.h"
#include "app/output_check.h"
#include "app/render_result.h"
#include "app/unit_picture.h"
#include "app/unit_renderer.h"
#include "core/available_memory.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/interrupt.h"
#include "core/stopwatch.h"
#include "farm/checkpoint.h"
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
        out << "wrote " << shown(done.file) << " (" << farm::nameOf(unit) << ", "
            << counted(done.pixels, "pixel") << ")\n";
        out << "device: " << done.drawn.device << ", " << done.drawn.driver << '\n';
        out << "times: load " << formatSeconds(loaded.loadSeconds) << ", BVH and packing "
            << formatSeconds(loaded.packSeconds) << ", trace " << formatSeconds(done.drawn.times.trace)
            << "; " << formatSeconds(done.totalSeconds) << " in all\n";
    }
}

// Measured: 36 bytes for a pixel without data, 134 with depth and normal, of 58 and 282 that are asked for.
void checkRoom(const RenderCommand& command, uint64_t pixels) {
    // As drawn, as layers, and as the bytes of the file.
    const uint64_t needed = 2 * pixels * bytesPerPixel(command.aovs, needsData(command));
    const uint64_t available = availableMemory();
    if (needed <= available) return;
    throw Error(ErrorKind::Failed, farm::nameOf(farm::Unit{0, command.part->number, command.part->of}) +
                                       " has " + counted(pixels, "pixel") + ", which take " +
                                       gibibytes(needed) + " of memory, " + gibibytes(available) +
                                       " are free; ask for more parts");
}

// A unit while it is drawn, its bytes, and while all are put together.
bool goesByRows(const RenderCommand& command, const UnitRenderer& units,
                const std::filesystem::path& output) {
    return needsRows(units.header(), output, 3 * unitBytes(command.aovs, units.mostPixels()),
                     availableMemory());
}

ProgressMode progressOf(const RenderCommand& command) {
    return command.quiet ? ProgressMode::None : command.progress;
}

}  // namespace

void refuseErrorTarget(const RenderCommand& command, const std::string& manner) {
    if (command.target.error)
        throw Error(ErrorKind::Argument,
                    manner + ": --error decides by the whole picture how many samples it takes; give --spp");
}

int renderPart(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch total;
    refuseErrorTarget(command, "--part");
    Done done;
    done.file = partPath(command);
    UnitRenderer units(command, command.part->of, err);
    done.pixels = units.pixelsOf(command.part->number);
    checkRoom(command, done.pixels);
    installInterruptHandler();
    std::optional<farm::UnitResult> result;
    {
        Progress progress("render", progressOf(command), err, isTerminal(err));
        result = units.draw(command.part->number, [&](double share) { progress.update(share); });
    }
    if (!result)
        throw Error(ErrorKind::Interrupted, "interrupted before the part was finished; nothing written");
    writeFile(done.file, farm::encodePart(units.header(), *result));
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
    UnitPicture picture(header, output, goesByRows(command, units, output));
    std::vector<bool> there(static_cast<size_t>(header.parts) + 1);
    const auto add = [&](const farm::UnitResult& result) {
        picture.add(result);
        there[static_cast<size_t>(result.unit.part)] = true;
    };
    farm::Checkpoint checkpoint(command.checkpoint, header, add);
    installInterruptHandler();
    {
        Progress progress("render", progressOf(command), err, isTerminal(err));
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
                                "; the same command goes on");
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
    return static_cast<int>(ExitCode::Done);
}

namespace {

constexpr double kPatience = 3;  // times as long as here may somebody else take for a unit

// Between looks at the folder while there is nothing to do: a twentieth of the time at most goes into looks,
// which take longer the more processes there are, and the slower the file system.
class Pause {
  public:
    void rest() {
        constexpr double kShare = 20, kShortest = 0.05, kLongest = 2;
        const double seconds = std::clamp(kShare * sinceRest_.seconds(), kShortest, kLongest);
        std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
        restart();
    }
    // A look begins.
    void restart() { sinceRest_.restart(); }

  private:
    Stopwatch sinceRest_;
};

// Draws units until all are there. False if it was interrupted.
bool drawTogether(UnitRenderer& units, farm::SharedFolder& folder, Progress& progress) {
    const auto parts = static_cast<double>(units.header().parts);
    double longest = 0;  // seconds that a unit took here
    Pause pause;
    while (!interrupted()) {
        pause.restart();
        const auto part = folder.next(longest > 0 ? std::optional(kPatience * longest) : std::nullopt);
        const int done = folder.done();
        if (folder.complete()) return true;
        if (!part) {
            progress.update(done / parts);
            pause.rest();
            continue;
        }
        const Stopwatch watch;
        Stopwatch sinceLook;
        // Somebody who was given up, or is slow, may be done first.
        const auto unwanted = [&] {
            if (sinceLook.seconds() < 0.5) return false;
            sinceLook.restart();
            return folder.has(*part);
        };
        const auto show = [&](double share) { progress.update((done + share) / parts); };
        const auto result = units.draw(*part, show, unwanted);
        if (result)
            folder.put(*result);
        else
            folder.giveUp();
        if (result) longest = std::max(longest, watch.seconds());
    }
    return false;
}

// True once the picture stands at `output`, or it is for this process to write it there.
enum class Written { ByOther, ByMe, Interrupted };
Written waitForPicture(farm::SharedFolder& folder, const std::filesystem::path& output) {
    for (Pause pause;; pause.rest()) {
        const auto note = folder.note();
        std::error_code ignored;
        if (note && *note == output.string() && std::filesystem::exists(output, ignored))
            return Written::ByOther;
        // It was written elsewhere, or is gone.
        if (note || folder.mayMerge()) return Written::ByMe;
        if (interrupted()) return Written::Interrupted;
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
    const bool rows = goesByRows(command, units, output);
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
        if (!command.quiet) out << shown(output) << " was written by another process\n";
        return static_cast<int>(ExitCode::Done);
    }
    UnitPicture picture(header, output, rows);
    folder.forEach([&](const farm::UnitResult& result) { picture.add(result); });
    Outcome outcome = picture.write();
    units.complete(outcome, picture.assembly().producers(), err);
    folder.setNote(output.string());
    outcome.totalSeconds = total.seconds();
    printResult(outcome, command, units.loaded(), out);
    units.drawing().reportValidation(err);
    return static_cast<int>(ExitCode::Done);
}

}  // namespace glint::app
