// Result of `glint render`, for people and programs.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/drawing.h"
#include "app/render_command.h"
#include "converge/converge.h"
#include "trace/picture.h"

namespace glint::app {

// Totals of an image in bands, which are not kept.
struct BandTotals {
    int bands = 0;
    uint64_t done = 0, sum = 0;  // pixels, and their samples
    uint32_t least = 0, most = 0;
    std::optional<std::string> advice;  // that all bands agree on

    void add(const Picture& band);
};

struct Outcome {
    Request request;  // that it answers
    Picture picture;  // in bands: without pixels
    std::optional<BandTotals> bands;
    std::optional<converge::Result> converged;  // its picture is `picture`

    double doneShare() const;  // of the pixels
    DrawingFacts drawn;
    std::vector<std::filesystem::path> files;
    std::string hash;  // of the picture, as it is written
    double writeSeconds = 0, totalSeconds = 0;
    int ranks = 0;  // of MPI; 0: rendered by one process
};

// Draws the request as it is, or as often as the error asked for takes; Outcome::converged is of the latter.
Picture drawPicture(Drawing& drawing, const Request& request, const std::optional<converge::Job>& job,
                    Outcome& outcome);

// Notes for the image file: with --error, the target and the result.
PictureNotes notesOf(const Outcome& outcome, const RenderCommand& command);

// Warnings about what the picture shows, or lacks.
void warnAboutPicture(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                      std::ostream& err);

// The summary, or with --stats JSON; with --quiet nothing else.
void printResult(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                 std::ostream& out);

// JSON for --stats about the device that --fallback replaced.
nlohmann::json fallbackJson(const FailedDevice& failed);

// Says on `err` how many pixels are not finite, each line after `start`; nothing if all are.
void warnOfNotFinite(const Picture& picture, const std::string& start, std::ostream& err);

// {"cut": {"branches", "meanBound", "greatestBound"}, "maxDepth": ..., "waiting": ..., "crowdedMedia"}.
// Bounds are of a pixel's colour; null where none is known.
nlohmann::json lossesJson(const Picture& picture);

// A line for each kind of loss that may be seen, each after `start`: branches that were cut, that found no
// room, media without room; branches beyond maxDepth if a pixel may lack 1/255 by them.
void warnOfLosses(const Picture& picture, const std::string& start, std::ostream& err);

}  // namespace glint::app
