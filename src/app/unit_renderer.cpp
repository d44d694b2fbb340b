#include "app/unit_renderer.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <ostream>

#include "app/render_identity.h"
#include "app/unit_picture.h"
#include "core/content_hash.h"
#include "core/interrupt.h"
#include "farm/cut.h"

namespace glint::app {

namespace {

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
        for (const Region& r : regions)
            for (const int value : {r.x0, r.y0, r.x1, r.y1}) text += std::to_string(value) + ",";
        text += ";";
    }
    return hashText(contentHash(text));
}

// Units of a second or so on a processor: they get lost with who draws them, and shared out. Beyond a
// thousand both grow, their number and what each takes: a picture of so much work is for many processes, of
// which each needs several units, and each unit costs all of them a look at the folder, or rank 0 two
// messages.
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
    if (!loaded_.packed.features.transmission && command_.scene.minContribution == 0) result->losses = {};
    const DrawingFacts facts = drawing_.facts();
    result->part = part;
    result->producer = {facts.device, drawing_.backend() == Backend::Cpu ? "" : facts.driver,
                        facts.sharesBits()};
    return result;
}

void UnitRenderer::complete(Outcome& outcome, const std::vector<farm::Producer>& producers,
                            std::ostream& err) const {
    if (uploaded_) outcome.drawn = drawing_.facts();
    outcome.request = request_;
    outcome.picture.samplesPerPixel = request_.samples.count();
    if (command_.quiet) return;
    warnAboutPicture(outcome, command_, loaded_, err);
    warnOfMixedBits(producers, "glint: warning: " + command_.scene.scene.string() + ": ", err);
}

}  // namespace glint::app
