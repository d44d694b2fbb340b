#include "app/units.h"

#include <ostream>
#include <utility>

#include "app/common.h"
#include "core/available_memory.h"
#include "core/error.h"
#include "core/format.h"
#include "core/stopwatch.h"
#include "core/text_file.h"

namespace glint::app {

namespace {

bool needsRows(const farm::UnitHeader& header, const std::filesystem::path& output, uint64_t heldBytes,
               bool wanted) {
    const Region& region = header.region;
    if (!goesByRows(output, header.aovs, region, unitBytes(header.aovs, 1), heldBytes, wanted)) return false;
    const uint64_t needed = heldBytes + unitBytes(header.aovs, static_cast<uint64_t>(4 * shared::kTileSize) *
                                                                   static_cast<uint64_t>(region.width()));
    requireMemory(format("an image of %dx%d pixels in ", region.width(), region.height()) +
                      counted(static_cast<uint64_t>(header.parts), "unit"),
                  needed, availableMemory(), "use more parts (--part K/N) or a smaller --size");
    return true;
}

}  // namespace

UnitPicture::UnitPicture(const farm::UnitHeader& header, const std::filesystem::path& output,
                         uint64_t heldBytes, bool byRows, std::optional<double> exposure)
    : output_(output), scale_(scaleOf(output, exposure)), assembly_(header.region, header.aovs) {
    if (needsRows(header, output, heldBytes, byRows))
        file_.emplace(output, header.region, header.aovs, scale_);
}

void UnitPicture::add(const farm::UnitResult& result) {
    assembly_.add(result);
    if (!file_) return;
    farm::Rows rows = assembly_.take();
    if (rows.picture.region.height() > 0) file_->add(rows.picture, std::move(rows.layers));
}

Outcome UnitPicture::write() {
    if (!assembly_.complete())
        throw Error(ErrorKind::Failed, "the parts leave some of the image's pixels out");
    Outcome outcome;
    outcome.output = output_;
    outcome.picture.region = assembly_.region();
    if (file_) {
        outcome.totals = file_->totals();
        outcome.bands = file_->bands();
        file_->finish(outcome);
    } else {
        farm::Rows rows = assembly_.take();
        outcome.picture = std::move(rows.picture);
        outcome.totals.add(outcome.picture);
        writeLayersOf(outcome, std::move(rows.layers), scale_);
    }
    outcome.picture.losses = assembly_.losses();
    outcome.picture.notFinite = assembly_.notFinite();
    outcome.picture.firstNotFinite = assembly_.firstNotFinite();
    return outcome;
}

std::string textOf(const farm::Producer& producer) {
    return producer.driver.empty() ? producer.device : producer.device + ", " + producer.driver;
}

void warnOfMixedBits(const std::vector<farm::Producer>& producers, const std::string& start,
                     std::ostream& err) {
    std::vector<std::string> own;
    for (const farm::Producer& producer : producers)
        if (!producer.sharesBits) own.push_back(textOf(producer));
    if (producers.size() < 2 || own.empty()) return;
    err << start << "the parts come from several devices, and the bits of some are their own ("
        << joined(own, "; ") << "): the last digits may differ from part to part\n";
}

uint64_t unitBytes(const std::vector<Aov>& aovs, uint64_t pixels) {
    return 2 * pixels * bytesPerPixel(aovs);  // as rendered, and as layers
}

}  // namespace glint::app
