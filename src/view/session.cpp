#include "view/session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "core/format.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "pack/packed_scene.h"
#include "reference/sensitivity.h"

namespace glint::view {

namespace {

// Weight of the newest frame: three frames follow a change to 94 %, one slow frame is forgotten as soon.
constexpr double kNewest = 0.6;
// Before the first measurement: a quarter of the pixels.
constexpr double kFirstScale = 0.5;
// Sizes in steps of 1/16, so that the picture does not swim with every frame.
constexpr double kSteps = 16;
// Least part of a frame for rendering, however long presenting takes.
constexpr double kLeastShare = 0.3;

constexpr double kSliceSeconds = 0.03;  // those of `glint render` are longer
constexpr int kBandRows = 8;            // a tile's height

double radicalInverse(int k, int base) {
    double result = 0, digit = 1.0 / base;
    for (; k > 0; k /= base, digit /= base) result += digit * (k % base);
    return result;
}

// Equal but for the display of the image, the visible part, and edits, which need the scene packed again.
bool tracesAlike(const PictureSettings& a, const PictureSettings& b) {
    PictureSettings same = a;
    same.layer = b.layer;
    same.sampleLimit = b.sampleLimit;
    same.sampling.samplesPerPixel = b.sampling.samplesPerPixel;
    same.sampling.adaptive = b.sampling.adaptive;
    same.edits = b.edits;
    return same == b;
}

}  // namespace

void Pace::measured(double pixels, double renderSeconds, double otherSeconds) {
    const double fresh = renderSeconds / std::max(pixels, 1.0);
    const double weight = secondsPerPixel_ > 0 ? kNewest : 1.0;
    secondsPerPixel_ += weight * (fresh - secondsPerPixel_);
    other_ += weight * (otherSeconds - other_);
}

double Pace::scale(double fullPixels) const {
    if (secondsPerPixel_ <= 0) return kFirstScale;
    const double budget = std::max(target_ - other_, kLeastShare * target_);
    const double wanted = std::sqrt(budget / (secondsPerPixel_ * std::max(fullPixels, 1.0)));
    return std::clamp(std::floor(wanted * kSteps) / kSteps, kLeast, 1.0);
}

int Pace::depth(int full, double fullPixels, bool glass) const {
    const double s = scale(fullPixels);
    const int bound = s >= 0.75 ? full : s >= 0.4 ? 2 : 1;
    return std::min(full, glass ? std::max(bound, kGlassDepth) : bound);
}

// ---- the image ----

std::string inWords(const converge::State& state, double error) {
    const converge::ErrorBudget& budget = state.budget;
    const uint32_t samples = state.samplesPerPixel;
    const double other = budget.rounding + budget.cut;
    if (state.rounds == 0) return format("error not known yet; until %.3g", error);
    if (!state.stop) return format("error <= %.3g after %u; until %.3g", budget.total(), samples, error);
    if (state.stop != converge::Stop::Fixed)
        return format("error <= %.3g, ", budget.total()) + counted(samples, "sample");
    if (budget.depthCounts && !std::isfinite(budget.depth))
        return "out of reach: with depth 0 no bound on reflections is known";
    if (budget.depthCounts && budget.depth > other)
        return format("out of reach: beyond the depth there may be %.2g", budget.depth);
    return format("out of reach: rounding and cuts may take %.2g", other);
}

render::Options windowOptions(const ViewScene& scene) {
    render::Options options;
    options.sliceSeconds = kSliceSeconds;
    options.also = scene.also;
    return options;
}

glm::dvec2 progressiveOffset(int k) {
    return k == 0 ? glm::dvec2(0.5) : glm::dvec2(radicalInverse(k, 2), radicalInverse(k, 3));
}

Session::Session(const gpu::Device& device, std::shared_ptr<const ViewScene> scene)
    : device_(device),
      scene_(std::move(scene)),
      renderer_(device, scene_->packed, windowOptions(*scene_)),
      settings_(PictureSettings::of(scene_->scene)),
      camera_(scene_->scene.camera) {}

void Session::apply(const PictureSettings& settings) {
    if (settings == settings_) return;
    const bool kept = tracesAlike(settings, settings_);
    settings_ = settings;
    if (!kept) restart();
    ++version_;
}

// Lights that are off are left out altogether: their shadow rays cost most of a frame.
Tracing Session::tracing() const {
    Tracing tracing;
    tracing.limits.depth = settings_.depth();
    tracing.shadows = settings_.shadows;
    tracing.methods = settings_.methods;
    Lighting& lighting = tracing.lighting.emplace();
    lighting.background = settings_.background;
    for (const LightSetting& setting : settings_.lights) {
        if (!setting.on || setting.dim <= 0) continue;
        for (shared::Light& row : packLights({&setting.light, 1}, scene_->packed.origin)) {
            row.intensity *= setting.dim;
            lighting.lights.push_back(row);
        }
    }
    return tracing;
}

void Session::setView(const Camera& camera, int width, int height) {
    if (width == width_ && height == height_ && camera == camera_) return;
    camera_ = camera;
    width_ = width;
    height_ = height;
    restart();
}

void Session::restart() {
    samples_ = nextRow_ = 0;
    hasData_ = colorBegun_ = coarseIsCurrent_ = false;
    goal_.reset();
    rounding_.reset();
    ++view_;
    ++version_;
}

Request Session::requestFor(int width, int height, bool data) const {
    Request request;
    static_cast<ImageSettings&>(request) = settings_.sampling;
    static_cast<Tracing&>(request) = tracing();
    request.camera = camera_;
    request.width = width;
    request.height = height;
    request.data = request.cost = data;
    return request;
}

Picture Session::render(const Request& request) {
    const Stopwatch watch;
    const render::StageTimes before = renderer_.times();
    Picture picture = renderer_.render(request);
    const render::StageTimes& now = renderer_.times();
    facts_.width = request.width;
    facts_.height = request.height;
    facts_.depth = static_cast<int>(request.limits.depth.value());
    facts_.renderSeconds = watch.seconds() - (now.compile - before.compile);
    if (now.trace > before.trace)
        facts_.raysPerSecond =
            static_cast<double>(now.pathRays - before.pathRays) / (now.trace - before.trace);
    return picture;
}

bool Session::coarseShown() const {
    return coarseIsCurrent_ && !(needsData(settings_.layer) && coarse_.data.empty());
}

// Pinhole and pixel centres: a moving image must be clear.
bool Session::renderMoving(double scale, int depth) {
    if (coarseShown() || ready() || width_ == 0 || height_ == 0) return false;
    const auto scaled = [&](int pixels) {
        return std::max(1, static_cast<int>(std::lround(pixels * scale)));
    };
    Request request = requestFor(scaled(width_), scaled(height_), needsData(settings_.layer));
    request.limits.depth = std::min(static_cast<uint32_t>(std::max(depth, 0)), settings_.depth());
    coarse_ = render(request);
    coarseIsCurrent_ = true;
    ++version_;
    return true;
}

bool Session::ready() const {
    return needsData(settings_.layer) ? hasData_ : samples_ > 0;
}

bool Session::finished() const {
    if (width_ == 0 || height_ == 0) return true;
    return hasData_ && samples_ > 0 && (needsData(settings_.layer) || enough());
}

bool Session::enough() const {
    if (settings_.until.error > 0) return goal_ && goal_->state.stop;
    return samples_ >= std::max(settings_.sampleLimit, 1);
}

double Session::progress() const {
    return height_ == 0 ? 0 : static_cast<double>(nextRow_) / height_;
}

// The colour comes first: a pass that brings all layers takes 1.6 to 3 times as long.
void Session::beginPass() {
    full_.region = {0, 0, width_, height_};
    if (full_.color.width != width_ || full_.color.height != height_) {
        full_.color = Image(width_, height_, 4);
        full_.data.resize(full_.color.pixels.size() / 4);
    }
    passHasData_ = !hasData_ && (needsData(settings_.layer) || samples_ > 0);
    // A pass whose first band was cut short has its samples already.
    if (passHasData_ || std::exchange(colorBegun_, true)) return;
    if (samples_ == 0) {
        sum_.assign(full_.color.pixels.size(), 0);
        sequence_ = sequence();
        if (settings_.until.error > 0)
            goal_.emplace(progressiveSampling(), settings_.until,
                          !converge::missesReflections(scene_->scene, settings_.depth()));
    }
    const uint32_t least = leastSamples(settings_.sampling.filter);
    colorPass_ = goal_       ? goal_->begin(least)
                 : sequence_ ? sequence_->next(least)
                             : PackedSamples::fixed({progressiveOffset(samples_)});
}

void Session::endPass() {
    nextRow_ = 0;
    if (passHasData_) {
        hasData_ = true;
        return;
    }
    colorBegun_ = false;
    samples_ += static_cast<int>(colorPass_.count());
    if (goal_) goal_->end();
}

// A grid depends on its number of samples.
ImageSettings Session::progressiveSampling() const {
    ImageSettings image = settings_.sampling;
    if (image.sampler == Sampler::Grid) image.sampler = Sampler::LowDiscrepancy;
    return image;
}

// progressiveOffset replaces a grid that all pixels share.
std::optional<SampleSequence> Session::sequence() const {
    ImageSettings image = settings_.sampling;
    image.adaptive.reset();
    if (image.sampler != Sampler::Jittered) image.sampler = Sampler::Grid;
    if (!packSamples(image, camera_).scattered()) return std::nullopt;
    return SampleSequence(progressiveSampling());
}

PackedSamples Session::taken() const {
    if (goal_ && samples_ > 0) return goal_->taken();
    if (std::optional<SampleSequence> all = sequence())
        return all->next(std::max(static_cast<uint32_t>(samples_), leastSamples(settings_.sampling.filter)));
    std::vector<glm::dvec2> offsets;
    for (int k = 0; k < std::max(samples_, 1); ++k) offsets.push_back(progressiveOffset(k));
    return PackedSamples::fixed(offsets);
}

Request Session::nextPiece(double seconds) const {
    int rows = kBandRows;
    if (secondsPerPixel_ > 0) {
        const double wanted = seconds / (secondsPerPixel_ * width_ * kBandRows);
        rows = kBandRows * static_cast<int>(std::clamp(wanted, 1.0, 4096.0));
    }
    Request request = requestFor(width_, height_, passHasData_);
    request.region = {0, nextRow_, width_, std::min(nextRow_ + rows, height_)};
    if (!passHasData_) request.samples = colorPass_;
    request.ledger = !passHasData_ && goal_;
    return request;
}

// The reference traces some thousand pixels for it, in the background.
void Session::askForRounding() {
    if (!rounding_ && findsRounding_.valid()) {
        if (findsRounding_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
        const double found = findsRounding_.get();
        if (roundingView_ == view_) rounding_ = found;
    }
    if (rounding_) return;
    roundingView_ = view_;
    findsRounding_ = std::async(std::launch::async, [scene = scene_, request = request()] {
        return reference::roundingError(scene->packed, request, reference::kFloatUnit);
    });
}

bool Session::lookAtError(double seconds) {
    if (!goal_ || goal_->state.stop) return false;
    askForRounding();
    if (!goal_->isDue()) return false;
    if (!rounding_) {
        findsRounding_.wait_for(std::chrono::duration<double>(seconds));
        return true;
    }
    goal_->look(*rounding_);
    ++version_;
    return true;
}

bool Session::refine(double seconds, const std::function<bool()>& cancelled) {
    if (finished()) return false;
    if (lookAtError(seconds)) return true;
    if (nextRow_ == 0) beginPass();
    Request request = nextPiece(seconds);
    request.cancelled = cancelled;
    const Picture picture = render(request);
    const Region& band = request.region;
    secondsPerPixel_ = facts_.renderSeconds / (static_cast<double>(band.width()) * band.height());
    if (!picture.complete) return true;
    addBand(picture);
    nextRow_ = band.y1;
    if (passHasData_ == needsData(settings_.layer)) ++version_;
    if (nextRow_ == height_) endPass();
    return true;
}

// One sample alone keeps the bits that the device gave it.
void Session::addBand(const Picture& band) {
    const size_t first = static_cast<size_t>(band.region.y0) * static_cast<size_t>(width_);
    if (passHasData_) {
        std::copy(band.data.begin(), band.data.end(), full_.data.begin() + static_cast<long>(first));
        return;
    }
    if (goal_) goal_->add(band, full_.region);
    const auto count = static_cast<float>(colorPass_.count());
    const float scale = 1.0f / (static_cast<float>(samples_) + count);
    for (size_t i = 0; i < band.color.pixels.size(); ++i) {
        sum_[4 * first + i] += count * band.color.pixels[i];
        full_.color.pixels[4 * first + i] = sum_[4 * first + i] * scale;
    }
}

// All rows by one range, also where the lower ones are still coarse.
LayerRange Session::range() const {
    return rangeOf(!hasData_ && coarseShown() ? coarse_ : full_, settings_.layer);
}

Canvas Session::canvas(const Display& display) const {
    Canvas target(width_, height_);
    const ViewLayer layer = settings_.layer;
    const LayerRange together = range();
    const bool whole = ready();
    if (!whole && !coarse_.color.pixels.empty()) {
        const bool smooth = layer == ViewLayer::Color || layer == ViewLayer::Depth;
        target = stretched(colorize(coarse_, layer, display, together), width_, height_, smooth);
    }
    const int rows = whole ? height_ : passHasData_ == needsData(layer) ? nextRow_ : 0;
    if (rows == 0) return target;
    const Canvas full = colorize(full_, layer, display, together);
    std::copy_n(full.pixels.begin(), static_cast<long>(rows) * width_, target.pixels.begin());
    return target;
}

PixelData Session::pixel(int x, int y) {
    return renderer_.pixel(requestFor(width_, height_, true), x, y);
}

}  // namespace glint::view
