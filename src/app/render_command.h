// `glint render`: its command line, the request that it makes, its ways to render an image, and the result
// with its files and the text and JSON that describe it.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/commands.h"
#include "app/options.h"
#include "app/rendering.h"
#include "converge/converge.h"
#include "core/content_hash.h"
#include "core/image_io.h"
#include "core/progress.h"
#include "pack/loaded_scene.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace glint::app {

struct RenderCommand {
    SceneOptions scene;
    std::filesystem::path output;    // empty: the scene's name with .png, in the current folder; "-"
    std::optional<double> exposure;  // stops
    DeviceChoice device;
    std::vector<Aov> aovs = {Aov::Radiance};
    std::optional<Region> crop;
    std::optional<int> bandRows;             // of an image that is written in bands; empty: if it must be
    converge::Target target = {.error = 0};  // 0: without --error
    bool strict = false;                     // --error must be reached
    std::optional<PartChoice> part;
    std::filesystem::path checkpoint;  // empty: none
    std::optional<FrameRange> frames;
    std::optional<double> framesPerSecond;
    bool overwrite = false;  // frames that are there
    bool json = false;       // --stats
    ProgressMode progress = ProgressMode::Auto;
    bool quiet = false;
};

// The image file to write; "-" for standard output.
std::filesystem::path outputOf(const RenderCommand& command);

// The same, but no file that the scene was read from: a texture often has its model's name. A default name
// becomes NAME.render.png; throws Error(Argument) for a given one.
std::filesystem::path outputOf(const RenderCommand& command, const Scene& scene);

// Bytes for the image and a copy of each layer for the file. Further memory of the device or the encoder is
// bounded or smaller.
uint64_t bytesPerPixel(const RenderCommand& command);
// Bytes for a unit, which has no PixelData.
uint64_t bytesPerPixel(const std::vector<Aov>& aovs);

// All wishes of the command, with the region that it covers; `progress` is left empty. Throws Error(Argument)
// for a --crop beyond the image.
Request requestOf(const RenderCommand& command, const LoadedScene& loaded);

// --part, --checkpoint and MPI render an image unit by unit (farm/unit.h). Throws Error(Argument) for options
// that exclude MPI.
bool isInUnits(const RenderCommand& command);
// Throws without CMake's GLINT_FARM.
ExitCode renderInUnits(const RenderCommand& command, std::ostream& out, std::ostream& err);

// ---- the result (render_result.cpp, picture_advice.cpp)

// Finished pixels, and their samples.
struct SampleTotals {
    uint64_t done = 0, sum = 0;
    uint32_t least = 0, most = 0;

    void add(const Picture& picture);
};

// An image in its files.
struct Written {
    std::vector<std::filesystem::path> files;
    SampleTotals totals;
    int bands = 0;     // 0: written at once
    std::string hash;  // of the image, as it is written; empty for a part
    double seconds = 0;
};

struct Outcome {
    Region region;
    bool complete = true;
    PictureFlaws flaws;
    std::optional<std::string> advice;          // pictureAdvice()
    std::optional<converge::Result> converged;  // without its image
    DrawingFacts drawn;
    Written written;
    double totalSeconds = 0;
    int ranks = 0;  // of MPI; 0: rendered by one process
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

// The files of an image: its rows go there as they come, or all at once.
class PictureFile {
  public:
    // `output`: "-" is standard output, for an image at once.
    PictureFile(const std::filesystem::path& output, const Region& region, const std::vector<Aov>& aovs,
                std::optional<double> exposure, bool byRows);

    // The rows below those before; at once: all rows. Their colours are finite.
    void add(const Picture& rows, std::vector<Layer> layers);
    // All rows that are left, each like the one given.
    void fill(const Picture& row, std::vector<Layer> layers);
    // Gives the files their names. `out`: for "-". Throws Error(Interrupted) if no pixel is finished.
    Written finish(std::ostream& out, const PictureNotes& notes = {});

    bool goesByRows() const { return rows_.has_value(); }
    float scale() const { return scale_; }  // see scaleOf()

  private:
    const std::filesystem::path output_;
    const float scale_;
    int left_;                         // rows
    std::optional<PictureRows> rows_;  // empty: at once
    std::vector<Layer> layers_;        // of an image at once
    PictureHash hash_;
    Written written_;  // so far
};

// Renders an image in bands of `rows` rows from the top, and gives them to its file. Pixels are independent,
// so the file does not depend on `rows`. The outcome has neither its files nor facts about the drawing.
Outcome drawInto(PictureFile& file, Drawing& drawing, const RenderCommand& command, const LoadedScene& loaded,
                 const Request& request, const std::optional<converge::Job>& job, int rows);

// Figures of --error for the file: glint.error.asked and so on; none without --error.
PictureNotes errorNotes(const converge::Target& target, const Outcome& outcome);

// One line with the likely reason if a complete image shows only background, only black, only white, or only
// the unlit inside of one object; empty for any other. Traces a few camera rays to find the reason.
// `request`: of the whole image. `scale`: see scaleOf().
std::optional<std::string> pictureAdvice(const Picture& picture, const LoadedScene& loaded,
                                         const Request& request, float scale);

// True if the branches that an image leaves out are worth a warning.
bool reportsLosses(const RenderCommand& command, const LoadedScene& loaded);
// Warnings about what the image shows or lacks.
void warnAboutPicture(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                      std::ostream& err);

// The summary, or with --stats JSON; with --quiet nothing else.
void printResult(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                 const Request& request, std::ostream& out);

// Parts of the summary, and of the JSON for --stats: the backend and its device, the files.
void printFiles(const Outcome& outcome, std::ostream& out);
void printDevice(const DrawingFacts& drawn, std::ostream& out);
nlohmann::json drawnJson(const DrawingFacts& drawn);
nlohmann::json filesJson(const std::vector<std::filesystem::path>& files);
// Files, width, height, notFinite, and lost: {"cut": {"branches", "meanBound", "greatestBound"}, "maxDepth":
// ..., "waiting": ..., "crowdedMedia"}. Bounds are of a pixel's colour; null where none is known.
nlohmann::json imageJson(const Outcome& outcome);

// A line on pixels that are not finite and, if `losses`, one for each kind of loss that may be seen, each
// after `start`: branches that were cut, that found no room, media without room; branches beyond the depth
// limit if a pixel may lack 1/255 by them.
void warnOf(const Outcome& outcome, bool losses, const std::string& start, std::ostream& err);

}  // namespace glint::app
