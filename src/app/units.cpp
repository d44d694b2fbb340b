#include "app/units.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <ostream>
#include <utility>

#include "app/common.h"
#include "app/loading.h"
#include "app/version.h"
#include "core/available_memory.h"
#include "core/content_hash.h"
#include "core/error.h"
#include "core/image_io.h"
#include "core/interrupt.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "farm/cut.h"
#include "pack/request_environment.h"
#include "scene/sampling.h"

namespace glint::app {

namespace {

std::string samplesText(const ImageSettings& image) {
    std::string text = std::to_string(image.samplesPerPixel) + " " + std::string(nameOf(samplerOf(image))) +
                       ", filter " + std::string(nameOf(image.filter)) + " " + describe(image.filterRadius) +
                       ", seed " + std::to_string(image.seed);
    if (image.adaptive)
        text += ", adaptive " + std::to_string(image.adaptive->maxSamples) + "," +
                describe(image.adaptive->threshold);
    return text;
}

std::string regionText(const Region& r) {
    return format("%d,%d,%d,%d", r.x0, r.y0, r.x1, r.y1);
}

uint64_t pixelsOf(const std::vector<Region>& regions) {
    uint64_t pixels = 0;
    for (const Region& r : regions)
        pixels += static_cast<uint64_t>(r.width()) * static_cast<uint64_t>(r.height());
    return pixels;
}

// All parts must use the same cut, so that each pixel is rendered exactly once.
std::string hashOf(const std::vector<std::vector<Region>>& cut) {
    std::string text;
    for (const auto& regions : cut) {
        for (const Region& r : regions) text += regionText(r) + ",";
        text += ";";
    }
    return hashText(contentHash(text));
}

// Units of about a second on a processor: a process that ends loses its unit, and several processes share
// them out. Beyond a thousand units, their number and their cost both grow, because each unit costs rank 0
// two messages.
int partsFor(const farm::CostMap& costs, uint32_t samples) {
    constexpr double kTests = 1e8, kLeast = 16, kMany = 1024, kMost = 16384;
    const auto total =
        static_cast<double>(std::accumulate(costs.costs.begin(), costs.costs.end(), uint64_t{0}));
    const double parts = total * samples / kTests;
    return static_cast<int>(std::clamp(parts > kMany ? std::sqrt(kMany * parts) : parts, kLeast, kMost));
}

uint64_t mostPixelsOf(const std::vector<std::vector<Region>>& cut) {
    uint64_t most = 0;
    for (const std::vector<Region>& regions : cut) most = std::max(most, pixelsOf(regions));
    return most;
}

// Renderer and collector hold whole units. The cheapest units, of sky, have most pixels.
std::vector<std::vector<Region>> cutToHold(const farm::CostMap& costs, int parts, uint64_t bytesPerPixel) {
    constexpr uint64_t kUnitBytes = uint64_t{1} << 28;
    auto cut = farm::cutPicture(costs, parts);
    while (mostPixelsOf(cut) * bytesPerPixel > kUnitBytes && parts < farm::kMostParts) {
        parts = std::min(2 * parts, farm::kMostParts);
        cut = farm::cutPicture(costs, parts);
    }
    return cut;
}

// Version, files, settings; not the device, nor where files lie. `request` is the whole image's.
farm::Identity identityOf(const RenderCommand& command, const LoadedScene& loaded, const Request& request) {
    const Scene& scene = loaded.scene;
    farm::Identity identity;
    const auto add = [&](const std::string& name, const std::string& value) {
        identity.facts.emplace_back(name, value);
    };
    add("glint", std::string(GLINT_VERSION) + " of commit " + builtCommit());
    add("scene", command.scene.scene.filename().string());
    for (const SourceFile& file : scene.sources) add("file " + file.name, hashText(file.hash));
    if (!command.scene.camera.empty()) add("camera", command.scene.camera);
    if (command.scene.time) add("time", describe(*command.scene.time));
    add("size", std::to_string(request.width) + "x" + std::to_string(request.height));
    add("crop", regionText(regionOf(request)));
    add("samples", samplesText(request.image));
    add("maxDepth", std::to_string(depthOf(loaded.packed, request)));
    add("min-contribution", describe(command.scene.limits.minContribution));
    add("intersector", std::string(nameOf(command.scene.methods.triangles)));
    add("sphere", std::string(nameOf(command.scene.methods.spheres)));
    add("layers", joined(namesOf(command.aovs), ","));
    add("backend", std::string(nameOf(command.backend)));
    add("traversal", std::string(nameOf(command.device.traversal)));
    add("build-quality", std::string(nameOf(command.scene.buildQuality)));
    return identity;
}

}  // namespace

UnitRenderer::UnitRenderer(const RenderCommand& command, int parts, std::ostream& err, int leastParts)
    : command_(command),
      drawing_(command.backend, command.device, command.quiet ? nullptr : &err),
      loaded_(loadAndPack(command.scene, err, command.quiet)) {
    constexpr int kLikelyParts = 64;  // to know how many before they are cut
    request_ = requestOf(command, loaded_);
    const auto costs =
        farm::estimateCosts(loaded_.packed, loaded_.scene.camera, request_, parts > 0 ? parts : kLikelyParts);
    cut_ = parts > 0 ? farm::cutPicture(costs, parts)
                     : cutToHold(costs, std::max(partsFor(costs, request_.samples.count()), leastParts),
                                 bytesPerPixel(command.aovs, false));
    parts = static_cast<int>(cut_.size());
    header_ = {identityOf(command, loaded_, request_), regionOf(request_), command.aovs, parts};
    header_.identity.facts.emplace_back("parts", std::to_string(parts));
    header_.identity.facts.emplace_back("cut", hashOf(cut_));
}

uint64_t UnitRenderer::pixelsOf(int part) const {
    return app::pixelsOf(cut_[static_cast<size_t>(part) - 1]);
}

uint64_t UnitRenderer::mostPixels() const {
    return mostPixelsOf(cut_);
}

std::optional<farm::UnitResult> UnitRenderer::draw(int part, const std::function<void(double)>& progress,
                                                   const std::function<bool()>& unwanted) {
    Request request = request_;
    request.progress = progress;
    if (unwanted) request.cancelled = [&] { return interrupted() || unwanted(); };
    if (!uploaded_) drawing_.load(loaded_, request);
    uploaded_ = true;
    auto result = drawing_.whole([&] {
        return farm::drawUnit([&](const Request& r) { return drawing_.draw(r); }, request,
                              cut_[static_cast<size_t>(part) - 1], command_.aovs);
    });
    if (!result) return result;
    // Losses are told where a picture drawn at once would tell them.
    if (!loaded_.packed.features.transmission && command_.scene.limits.minContribution == 0)
        result->losses = {};
    const DrawingFacts facts = drawing_.facts();
    result->part = part;
    result->producer = {facts.device, drawing_.backend() == Backend::Cpu ? "" : facts.driver,
                        facts.sharesBits()};
    return result;
}

void UnitRenderer::complete(Outcome& outcome, const std::vector<farm::Producer>& producers,
                            std::ostream& err) const {
    outcome.drawn = drawing_.facts();
    outcome.request = request_;
    outcome.picture.samplesPerPixel = request_.samples.count();
    warnAboutPicture(outcome, command_, loaded_, err);
    if (!command_.quiet)
        warnOfMixedBits(producers, "glint: warning: " + command_.scene.scene.string() + ": ", err);
}

bool needsRows(const farm::UnitHeader& header, const std::filesystem::path& output, uint64_t heldBytes,
               uint64_t available, bool wanted) {
    const Region& region = header.region;
    const uint64_t perPixel = 2 * bytesPerPixel(header.aovs, false);  // as drawn, and as layers
    const uint64_t whole =
        static_cast<uint64_t>(region.width()) * static_cast<uint64_t>(region.height()) * perPixel;
    const bool able = canWriteRows(output, header.aovs);
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
    : output_(output), scale_(scale), assembly_(header.region, header.aovs) {
    if (rows) file_.emplace(output, header.region, header.aovs, scale);
}

void UnitPicture::add(const farm::UnitResult& result) {
    assembly_.add(result);
    if (!file_) return;
    farm::Rows rows = assembly_.take();
    if (rows.picture.region.height() > 0) file_->add(rows.picture, std::move(rows.layers));
}

Outcome UnitPicture::write() {
    if (!assembly_.complete())
        throw Error(ErrorKind::Failed, "the parts leave some of the picture's pixels out");
    Outcome outcome;
    outcome.output = output_;
    if (file_) {
        outcome.picture.region = assembly_.region();
        file_->finish(outcome);
    } else {
        const Stopwatch writing;
        farm::Rows rows = assembly_.take();
        outcome.picture = std::move(rows.picture);
        outcome.hash = pictureHash(outcome.picture.color);
        expose(rows.layers, scale_);
        outcome.files = writeLayers(output_, rows.layers);
        outcome.writeSeconds = writing.seconds();
    }
    outcome.picture.losses = assembly_.losses();
    outcome.picture.notFinite = assembly_.notFinite();
    outcome.picture.firstNotFinite = assembly_.firstNotFinite();
    return outcome;
}

std::string producerText(const farm::Producer& producer) {
    return producer.driver.empty() ? producer.device : producer.device + ", " + producer.driver;
}

void warnOfMixedBits(const std::vector<farm::Producer>& producers, const std::string& start,
                     std::ostream& err) {
    std::vector<std::string> own;
    for (const farm::Producer& producer : producers)
        if (!producer.sharesBits) own.push_back(producerText(producer));
    if (producers.size() < 2 || own.empty()) return;
    err << start << "the parts come from several devices, and the bits of some are their own ("
        << joined(own, "; ") << "): the last digits may differ from part to part\n";
}

}  // namespace glint::app
