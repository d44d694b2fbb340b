#include "app/unit_picture.h"

#include <ostream>
#include <utility>

#include "app/output_check.h"
#include "core/available_memory.h"
#include "core/error.h"
#include "core/image_io.h"
#include "core/stopwatch.h"
#include "core/wording.h"

namespace glint::app {

namespace {

std::vector<std::string> namesOf(const std::vector<Aov>& aovs) {
    std::vector<std::string> names;
    for (const Aov aov : aovs) names.emplace_back(nameOf(aov));
    return names;
}

}  // namespace

bool needsRows(const farm::UnitHeader& header, const std::filesystem::path& output, uint64_t heldBytes,
               uint64_t available, bool wanted) {
    const Region& region = header.region;
    const uint64_t perPixel = 2 * bytesPerPixel(header.aovs, false);  // as drawn, and as layers
    const uint64_t whole =
        static_cast<uint64_t>(region.width()) * static_cast<uint64_t>(region.height()) * perPixel;
    const bool able = canWriteRows(output, namesOf(header.aovs));
    if (wanted && !able)
        throw Error(ErrorKind::Argument,
                    output.string() + ": bands go into .png (layers color and alpha alone), .exr and .pfm");
    if (!wanted && whole + heldBytes <= available) return false;
    if (!able) {
        checkMemory(region.width(), region.height(), perPixel, available);
        return false;
    }
    const uint64_t strips =
        4 * static_cast<uint64_t>(shared::kTileSize) * static_cast<uint64_t>(region.width()) * perPixel;
    if (heldBytes + strips > available)
        throw Error(ErrorKind::Failed, "a picture of " + std::to_string(region.width()) + "x" +
                                           std::to_string(region.height()) + " pixels takes " +
                                           gibibytes(heldBytes + strips) + " of memory in " +
                                           counted(static_cast<uint64_t>(header.parts), "unit") + ", " +
                                           gibibytes(available) + " are free");
    return true;
}

uint64_t unitBytes(const std::vector<Aov>& aovs, uint64_t pixels) {
    return 2 * pixels * bytesPerPixel(aovs, false);
}

UnitPicture::UnitPicture(const farm::UnitHeader& header, const std::filesystem::path& output, bool rows,
                         float scale)
    : header_(header), output_(output), scale_(scale), assembly_(header.region, header.aovs) {
    if (rows)
        file_.emplace(output, header.region.width(), header.region.height(),
                      makeLayers(Picture(), header.aovs));
}

void UnitPicture::takeRows() {
    const Stopwatch writing;
    farm::Rows rows = assembly_.take();
    if (rows.picture.region.height() == 0) return;
    hash_.add(rows.picture.color);
    bands_.add(rows.picture);
    expose(rows.layers, scale_);
    file_->add(rows.layers);
    writeSeconds_ += writing.seconds();
}

void UnitPicture::add(const farm::UnitResult& result) {
    assembly_.add(result);
    if (file_) takeRows();
}

Outcome UnitPicture::write() {
    if (!assembly_.complete())
        throw Error(ErrorKind::Failed, "the parts leave some of the picture's pixels out");
    const Stopwatch writing;
    Outcome outcome;
    if (file_) {
        outcome.picture.region = header_.region;
        outcome.bands = bands_;
        outcome.files = file_->finish();
        outcome.hash = hash_.text();
    } else {
        farm::Rows rows = assembly_.take();
        outcome.picture = std::move(rows.picture);
        outcome.hash = pictureHash(outcome.picture.color);
        expose(rows.layers, scale_);
        outcome.files = writeLayers(output_, rows.layers);
    }
    outcome.picture.losses = assembly_.losses();
    outcome.picture.notFinite = assembly_.notFinite();
    outcome.picture.firstNotFinite = assembly_.firstNotFinite();
    outcome.writeSeconds = writeSeconds_ + writing.seconds();
    return outcome;
}

std::string producerText(const farm::Producer& producer) {
    return producer.driver.empty() ? producer.device : producer.device + ", " + producer.driver;
}

void warnOfMixedBits(const std::vector<farm::Producer>& producers, const std::string& start,
                     std::ostream& err) {
    std::string list;
    for (const farm::Producer& producer : producers)
        if (!producer.sharesBits) list += (list.empty() ? "" : "; ") + producerText(producer);
    if (producers.size() < 2 || list.empty()) return;
    err << start << "the parts come from several devices, and the bits of some are their own (" << list
        << "): the last digits may differ from part to part\n";
}

}  // namespace glint::app
