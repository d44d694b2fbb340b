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
    std::filesystem::path output;              // the file asked for
    std::vector<std::filesystem::path> files;  // that were written
    std::string hash;                          // of the picture, as it is written
    double writeSeconds = 0, totalSeconds = 0;
    int ranks = 0;  // of MPI; 0: rendered by one process
};

// Warnings about what the picture shows or lacks, unless --quiet.
void warnAboutPicture(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                      std::ostream& err);

// Factor of the colours in an 8-bit file, 2^exposure; 0 for files with floats. Throws Error(Argument) if
// `exposure` is given for these.
float scaleOf(const std::filesystem::path& output, std::optional<double> exposure);

std::vector<std::string> namesOf(const std::vector<Aov>& aovs);

// Multiplies the layer "color" by `scale`, unless it is 0.
void expose(std::vector<Layer>& layers, float scale);

// Writes the image, unless it is in bands, and sets hash, files and seconds. Throws Error(Interrupted) if
// nothing is done.
void writePicture(Outcome& outcome, const RenderCommand& command, std::ostream& out);

// The summary, or with --stats JSON; with --quiet nothing else.
void printResult(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                 std::ostream& out);

// Parts of the summary, and of the JSON for --stats: the backend and its device, the files.
void printDevice(const DrawingFacts& drawn, std::ostream& out);
void printTimes(const Outcome& outcome, const LoadedScene& loaded, std::ostream& out);
nlohmann::json drawnJson(const DrawingFacts& drawn);
nlohmann::json filesJson(const std::vector<std::filesystem::path>& files);

// Says on `err` how many pixels are not finite, each line after `start`; nothing if all are.
void warnOfNotFinite(const Picture& picture, const std::string& start, std::ostream& err);

// {"cut": {"branches", "meanBound", "greatestBound"}, "maxDepth": ..., "waiting": ..., "crowdedMedia"}.
// Bounds are of a pixel's colour; null where none is known.
nlohmann::json lossesJson(const Picture& picture);

// A line for each kind of loss that may be seen, each after `start`: branches that were cut, that found no
// room, media without room; branches beyond the depth limit if a pixel may lack 1/255 by them.
void warnOfLosses(const Picture& picture, const std::string& start, std::ostream& err);

}  // namespace glint::app
