// Result of `glint render`: its files, and the text and JSON that describe it.
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
#include "core/content_hash.h"
#include "core/image_io.h"
#include "trace/picture.h"

namespace glint::app {

// Finished pixels, and their samples.
struct SampleTotals {
    uint64_t done = 0, sum = 0;
    uint32_t least = 0, most = 0;

    void add(const Picture& picture);
};

struct Outcome {
    Request request;  // that it answers
    Picture picture;  // in bands: without pixels
    SampleTotals totals;
    int bands = 0;                              // 0: written at once
    std::optional<std::string> advice;          // pictureAdvice()
    std::optional<converge::Result> converged;  // its image is moved to `picture`
    DrawingFacts drawn;
    std::filesystem::path output;              // the file asked for
    std::vector<std::filesystem::path> files;  // that were written
    std::string hash;                          // of the image, as it is written; empty for a part
    double writeSeconds = 0, totalSeconds = 0;
    int ranks = 0;  // of MPI; 0: rendered by one process

    double doneShare() const;  // of the pixels
};

// Factor of the colours in an 8-bit file, 2^exposure; 0 for files with floats. Throws Error(Argument) if
// `exposure` is given for these.
float scaleOf(const std::filesystem::path& output, std::optional<double> exposure);

std::vector<std::string> namesOf(const std::vector<Aov>& aovs);

// True if the image goes into its file row by row: if `wanted`, or if its `bytesPerPixel` and `further` bytes
// exceed the available memory. Throws Error(Argument) if `wanted` for a format that has no rows (all but .png
// with colour and alpha alone, .exr and .pfm), and Error(Failed) if such an image does not fit.
bool goesByRows(const std::filesystem::path& output, const std::vector<Aov>& aovs, const Region& region,
                uint64_t bytesPerPixel, uint64_t further, bool wanted);

// An image that goes into its file row by row, from the top.
class RowFile {
  public:
    // `scale`: see scaleOf().
    RowFile(const std::filesystem::path& output, const Region& region, const std::vector<Aov>& aovs,
            float scale);

    // The rows below those before.
    void add(const Picture& rows, std::vector<Layer> layers);
    // All rows that are left, each like the one given.
    void fill(const Picture& row, std::vector<Layer> layers);
    // Renames the files to their final names. Sets files, hash and seconds of writing.
    void finish(Outcome& outcome);

    // Totals of the rows so far, and the number of calls of add().
    const SampleTotals& totals() const { return totals_; }
    int bands() const { return bands_; }

  private:
    float scale_;
    int left_;  // rows
    PictureRows file_;
    PictureHash hash_;
    SampleTotals totals_;
    int bands_ = 0;
    double seconds_ = 0;
};

// Writes a whole image, and sets totals, hash, files and seconds of writing. `out`: for the file "-". Throws
// Error(Interrupted) if no pixel is finished.
void writePicture(Outcome& outcome, const RenderCommand& command, std::ostream& out);
// Overload for layers that exist already.
void writeLayersOf(Outcome& outcome, std::vector<Layer> layers, float scale, const PictureNotes& notes = {});

[[noreturn]] void throwNothingDone();

// One line with the likely reason if a complete image shows only background, only black, only white, or only
// the unlit inside of one object; empty for any other. Traces a few camera rays to find the reason.
// `request`: of the whole image. `scale`: see scaleOf().
std::optional<std::string> pictureAdvice(const Picture& picture, const Scene& scene,
                                         const PackedScene& packed, const Request& request, float scale);

// Sets the advice on a whole image, unless --quiet.
void adviseOn(Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded);

// Warnings about what the image shows or lacks.
void warnAboutPicture(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                      std::ostream& err);

// The summary, or with --stats JSON; with --quiet nothing else.
void printResult(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                 std::ostream& out);

// Parts of the summary, and of the JSON for --stats: the backend and its device, the files.
void printFiles(const Outcome& outcome, std::ostream& out);
void printDevice(const DrawingFacts& drawn, std::ostream& out);
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
