#include "app/render_bands.h"

#include <algorithm>
#include <utility>

#include "app/common.h"
#include "app/picture_advice.h"
#include "core/available_memory.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/picture_hash.h"
#include "core/picture_rows.h"
#include "core/stopwatch.h"

namespace glint::app {

namespace {

// Bands begin where tiles of the device do, so that packets of rays, and with them the layer "cost", are
// those of the whole picture.
constexpr int kStep = shared::kTileSize;
constexpr uint64_t kBandBytes = uint64_t{1} << 30;  // enough to keep any device busy

uint64_t roundedUp(uint64_t rows) {
    return (rows + kStep - 1) / kStep * kStep;
}

bool canHaveBands(const RenderCommand& command, const std::filesystem::path& output) {
    std::vector<std::string> layers;
    for (const Aov aov : command.aovs) layers.emplace_back(nameOf(aov));
    return !command.target.error && output != "-" && canWriteRows(output, layers);
}

// A row of the picture, its layers, and what becomes of these for the file.
uint64_t bytesOfRow(const RenderCommand& command, const Region& region) {
    return static_cast<uint64_t>(region.width()) * 2 * bytesPerPixel(command.aovs, needsData(command));
}

void add(Outcome& outcome, Picture& band) {
    Picture& all = outcome.picture;
    outcome.bands->add(band);
    // Bands come from the top, so the first place is that of the first band that has one.
    if (all.notFinite == 0) all.firstNotFinite = band.firstNotFinite;
    all.notFinite += band.notFinite;
    all.losses.add(band.losses);
    all.complete = all.complete && band.complete;
    blackenNotFinite(band);
}

// An interrupt left the rows from `y` on undrawn.
void fillRest(const Request& request, const RenderCommand& command, const Outcome& outcome, int y,
              PictureRows& file, PictureHash& hash) {
    const Region region = regionOf(request);
    if (y == region.y1) return;
    Request row = request;
    row.region = {region.x0, y, region.x1, y + 1};
    const Picture blank = blankPicture(row);
    hash.fill(region.y1 - y, blank.color);
    file.fill(layersOf(blank, command, outcome.output));
}

}  // namespace

int bandRowsOf(const RenderCommand& command, const std::filesystem::path& output, const Region& region,
               uint64_t available) {
    const bool able = canHaveBands(command, output);
    if (command.bandRows && !able)
        throw Error(
            ErrorKind::Argument,
            "--band-rows: bands go into .png (layers color and alpha alone), .exr and .pfm, and not with "
            "--error");
    const uint64_t row = bytesOfRow(command, region);
    const auto height = static_cast<uint64_t>(region.height());
    const uint64_t whole = bytesPerPixel(command.aovs, needsData(command));
    // While it is written the file's own rows lie beside it: an EXR took 41 bytes for a pixel, of 29 and 58.
    if (!command.bandRows && (!able || height * row <= available)) {
        checkMemory(region.width(), region.height(), whole, available);
        return 0;
    }
    const uint64_t fitting = std::min(available / 4, kBandBytes) / row / kStep * kStep;
    const uint64_t rows = command.bandRows ? roundedUp(static_cast<uint64_t>(*command.bandRows))
                                           : std::max<uint64_t>(fitting, kStep);
    const uint64_t needed = std::min(rows, height) * row;
    if (needed > available)
        throw Error(ErrorKind::Failed,
                    "a picture of " + std::to_string(region.width()) + "x" + std::to_string(region.height()) +
                        " pixels takes " + gibibytes(needed) + " of memory in bands of " +
                        std::to_string(rows) + " rows, " + gibibytes(available) + " are free");
    return static_cast<int>(std::min(rows, roundedUp(height)));
}

void drawBands(Drawing& drawing, const RenderCommand& command, const LoadedScene& loaded,
               const Request& request, int rows, Outcome& outcome) {
    const Region region = regionOf(request);
    outcome.picture.region = region;
    outcome.picture.samplesPerPixel = request.samples.count();
    outcome.bands.emplace();
    PictureRows file(outcome.output, region.width(), region.height(), makeLayers(Picture(), command.aovs));
    PictureHash hash;
    double writeSeconds = 0;
    bool alike = !command.quiet;  // all bands so far lack the same
    for (int y = region.y0; y < region.y1; y += rows) {
        Request part = request;
        part.region = {region.x0, y, region.x1, std::min(y + rows, region.y1)};
        const auto share = [&](int row) { return static_cast<double>(row - region.y0) / region.height(); };
        const double from = share(y), to = share(part.region.y1);
        part.progress = [&](double done) { request.progress(from + (to - from) * done); };
        Picture band = drawing.whole([&] { return drawing.draw(part); });
        if (alike) {
            const auto advice = pictureAdvice(band, loaded.scene, loaded.packed, request,
                                              scaleOf(outcome.output, command.exposure));
            alike = advice && (y == region.y0 || advice == outcome.bands->advice);
            outcome.bands->advice = alike ? advice : std::nullopt;
        }
        add(outcome, band);
        if (!outcome.picture.complete && outcome.bands->done == 0) return;
        const Stopwatch writing;
        hash.add(band.color);
        file.add(layersOf(band, command, outcome.output));
        writeSeconds += writing.seconds();
        if (!band.complete) {
            const Stopwatch filling;
            fillRest(request, command, outcome, part.region.y1, file, hash);
            writeSeconds += filling.seconds();
            break;
        }
    }
    const Stopwatch writing;
    outcome.files = file.finish();
    outcome.hash = hash.text();
    outcome.writeSeconds = writeSeconds + writing.seconds();
}

}  // namespace glint::app
