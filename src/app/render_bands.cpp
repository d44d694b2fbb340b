#include "app/render_bands.h"

#include <algorithm>

#include "app/picture_advice.h"
#include "core/available_memory.h"
#include "core/error.h"
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

// A row of the picture, its layers, and what becomes of these for the file.
uint64_t bytesOfRow(const RenderCommand& command, const Region& region) {
    return static_cast<uint64_t>(region.width()) * 2 * bytesPerPixel(command.aovs, needsData(command));
}

// Adds what is known of a band, and makes its colours finite.
void add(Picture& all, Picture& band) {
    // Bands come from the top, so the first place is that of the first band that has one.
    if (all.notFinite == 0) all.firstNotFinite = band.firstNotFinite;
    all.notFinite += band.notFinite;
    all.losses.add(band.losses);
    all.complete = all.complete && band.complete;
    blackenNotFinite(band);
}

}  // namespace

bool canWriteRows(const std::filesystem::path& output, const std::vector<Aov>& aovs) {
    return output != "-" && glint::canWriteRows(output, namesOf(aovs));
}

RowFile::RowFile(const std::filesystem::path& output, const Region& region, const std::vector<Aov>& aovs,
                 float scale)
    : scale_(scale),
      left_(region.height()),
      file_(output, region.width(), left_, makeLayers(Picture(), aovs)) {}

void RowFile::add(const Picture& rows, std::vector<Layer> layers) {
    const Stopwatch writing;
    left_ -= rows.region.height();
    totals_.add(rows);
    hash_.add(rows.color);
    expose(layers, scale_);
    file_.add(layers);
    seconds_ += writing.seconds();
}

void RowFile::fill(const Picture& row, std::vector<Layer> layers) {
    if (left_ == 0) return;
    const Stopwatch writing;
    hash_.fill(left_, row.color);
    expose(layers, scale_);
    file_.fill(layers);
    seconds_ += writing.seconds();
}

void RowFile::finish(Outcome& outcome) {
    const Stopwatch writing;
    outcome.bands = totals_;
    outcome.files = file_.finish();
    outcome.hash = hash_.text();
    outcome.writeSeconds = seconds_ + writing.seconds();
}

int bandRowsOf(const RenderCommand& command, const std::filesystem::path& output, const Region& region,
               uint64_t available) {
    const bool able = !command.target.error && canWriteRows(output, command.aovs);
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
    const float scale = scaleOf(outcome.output, command.exposure);
    outcome.picture.region = region;
    outcome.picture.samplesPerPixel = request.samples.count();
    RowFile file(outcome.output, region, command.aovs, scale);
    std::optional<std::string> advice;
    bool alike = !command.quiet;  // all bands so far lack the same
    Request part = request;
    for (int y = region.y0; y < region.y1 && outcome.picture.complete; y += rows) {
        part.region = {region.x0, y, region.x1, std::min(y + rows, region.y1)};
        const auto share = [&](int row) { return static_cast<double>(row - region.y0) / region.height(); };
        const double from = share(y), to = share(part.region.y1);
        part.progress = [&](double done) { request.progress(from + (to - from) * done); };
        Picture band = drawing.whole([&] { return drawing.draw(part); });
        if (alike) {
            const auto reason = pictureAdvice(band, loaded.scene, loaded.packed, request, scale);
            alike = reason && (y == region.y0 || reason == advice);
            advice = alike ? reason : std::nullopt;
        }
        add(outcome.picture, band);
        file.add(band, makeLayers(band, command.aovs));
    }
    if (file.totals().done == 0) {
        outcome.bands = file.totals();  // nothing is written
        return;
    }
    // After an interrupt, rows from here on are blank.
    part.region = {region.x0, part.region.y1, region.x1, part.region.y1 + 1};
    const Picture blank = blankPicture(part);
    file.fill(blank, makeLayers(blank, command.aovs));
    file.finish(outcome);
    outcome.bands->advice = advice;
}

}  // namespace glint::app
