#include "view/session.h"

#include <algorithm>
#include <cmath>

#include "core/stopwatch.h"

namespace glint::view {

namespace {

constexpr double kSliceSeconds = 0.03;  // those of `glint render` are longer
constexpr int kBandRows = 8;            // a tile's height

double radicalInverse(int k, int base) {
    double result = 0, digit = 1.0 / base;
    for (; k > 0; k /= base, digit /= base) result += digit * (k % base);
    return result;
}

render::StageTimes since(const render::StageTimes& now, const render::StageTimes& before) {
    render::StageTimes d = now;
    d.upload -= before.upload;
    d.compile -= before.compile;
    d.trace -= before.trace;
    d.device -= before.device;
    d.readback -= before.readback;
    d.submissions -= before.submissions;
    d.pathRays -= before.pathRays;
    return d;
}

bool sameCamera(const Camera& a, const Camera& b) {
    const auto sameWindow = [&] {
        if (a.window.has_value() != b.window.has_value()) return false;
        if (!a.window) return true;
        return a.window->left == b.window->left && a.window->right == b.window->right &&
               a.window->bottom == b.window->bottom && a.window->top == b.window->top;
    };
    return a.projection == b.projection && a.planeNormal == b.planeNormal && a.height == b.height &&
           a.eye == b.eye && a.target == b.target && a.up == b.up && a.fovY == b.fovY && a.nearT == b.nearT &&
           a.farT == b.farT && sameWindow();
}

}  // namespace

render::Options windowOptions(const ViewScene& scene) {
    render::Options options;
    options.sliceSeconds = kSliceSeconds;
    options.also = scene.also;
    return options;
}

glm::dvec2 progressiveOffset(int k) {
    return k == 0 ? glm::dvec2(0.5) : glm::dvec2(radicalInverse(k, 2), radicalInverse(k, 3));
}

PictureSettings PictureSettings::of(const Scene& scene) {
    PictureSettings s;
    s.maxDepth = scene.maxDepth;
    s.lights.resize(scene.lights.size());
    s.background = glm::vec3(scene.environment ? scene.environment->intensity : scene.background);
    return s;
}

Session::Session(const gpu::Device& device, std::shared_ptr<const ViewScene> scene)
    : device_(device),
      scene_(std::move(scene)),
      renderer_(device, scene_->packed, windowOptions(*scene_)),
      settings_(PictureSettings::of(scene_->scene)),
      camera_(scene_->scene.camera) {}

void Session::apply(const PictureSettings& settings) {
    if (settings == settings_) return;
    PictureSettings kept = settings;
    kept.sampleLimit = settings_.sampleLimit;
    const bool onlyLimit = kept == settings_;
    settings_ = settings;
    if (onlyLimit) {
        ++version_;
        return;
    }
    restart();
}

// Lights that are off are left out altogether: their shadow rays cost most of a frame.
Tracing Session::tracing() const {
    Tracing tracing;
    tracing.maxDepth = settings_.depth();
    tracing.shadows = settings_.shadows;
    Lighting& lighting = tracing.lighting.emplace();
    lighting.background = settings_.background;
    for (size_t i = 0; i < scene_->packed.lights.size(); ++i) {
        shared::Light light = scene_->packed.lights[i];
        const LightSetting setting = i < settings_.lights.size() ? settings_.lights[i] : LightSetting{};
        if (!setting.on || setting.dim <= 0) continue;
        light.intensity *= setting.dim;
        lighting.lights.push_back(light);
    }
    return tracing;
}

void Session::setView(const Camera& camera, int width, int height) {
    if (width == width_ && height == height_ && sameCamera(camera, camera_)) return;
    camera_ = camera;
    width_ = width;
    height_ = height;
    restart();
}

void Session::restart() {
    samples_ = 0;
    nextRow_ = 0;
    coarseCurrent_ = false;
    ++version_;
}

shared::Camera Session::packedCamera() const {
    return packCamera(camera_, width_, height_, scene_->packed.origin);
}

Picture Session::render(int width, int height, const Region& region, const glm::dvec2& offset, int depth,
                        const std::function<bool()>& cancelled) {
    const Stopwatch watch;
    const render::StageTimes before = renderer_.times();
    Request wanted;
    static_cast<Tracing&>(wanted) = tracing();
    wanted.width = width;
    wanted.height = height;
    wanted.region = region;
    wanted.samples = PackedSamples::fixed({offset});
    wanted.data = needsData(settings_.layer);
    wanted.cost = settings_.layer == ViewLayer::Cost;
    wanted.maxDepth = static_cast<uint32_t>(depth);
    wanted.cancelled = cancelled;
    Picture picture = renderer_.render(packCamera(camera_, width, height, scene_->packed.origin), wanted);
    facts_.times = since(renderer_.times(), before);
    facts_.width = width;
    facts_.height = height;
    facts_.depth = depth;
    facts_.renderSeconds = watch.seconds() - facts_.times.compile;
    if (facts_.times.trace > 0) {
        facts_.raysPerSecond = static_cast<double>(facts_.times.pathRays) / facts_.times.trace;
    }
    return picture;
}

bool Session::renderMoving(double scale, int depth) {
    if (coarseCurrent_ || width_ == 0 || height_ == 0) return false;
    const int width = std::max(1, static_cast<int>(std::lround(width_ * scale)));
    const int height = std::max(1, static_cast<int>(std::lround(height_ * scale)));
    coarse_ = render(width, height, {0, 0, width, height}, glm::dvec2(0.5),
                     std::min(depth, static_cast<int>(settings_.depth())), {});
    coarseCurrent_ = true;
    ++version_;
    return true;
}

bool Session::finished() const {
    // Other layers come from the first sample alone.
    const int wanted = needsData(settings_.layer) ? 1 : std::max(settings_.sampleLimit, 1);
    return width_ == 0 || height_ == 0 || samples_ >= wanted;
}

double Session::progress() const {
    return height_ > 0 ? static_cast<double>(nextRow_) / height_ : 0;
}

bool Session::refine(double seconds, const std::function<bool()>& cancelled) {
    if (finished()) return false;
    if (samples_ == 0 && nextRow_ == 0) {
        full_ = Picture();
        full_.region = {0, 0, width_, height_};
        full_.color = Image(width_, height_, 4);
        sum_.assign(full_.color.pixels.size(), 0);
        if (needsData(settings_.layer)) full_.data.resize(sum_.size() / 4);
    }
    int rows = kBandRows;
    if (secondsPerPixel_ > 0) {
        const double wanted = seconds / (secondsPerPixel_ * width_ * kBandRows);
        rows = kBandRows * static_cast<int>(std::clamp(wanted, 1.0, 4096.0));
    }
    const Region band = {0, nextRow_, width_, std::min(nextRow_ + rows, height_)};
    const Picture picture = render(width_, height_, band, progressiveOffset(samples_),
                                   static_cast<int>(settings_.depth()), cancelled);
    secondsPerPixel_ = facts_.renderSeconds / (static_cast<double>(band.width()) * band.height());
    if (!picture.complete) return true;
    addBand(picture);
    nextRow_ = band.y1;
    if (nextRow_ == height_) {
        nextRow_ = 0;
        ++samples_;
    }
    ++version_;
    return true;
}

// One sample alone keeps the bits that the device gave it.
void Session::addBand(const Picture& band) {
    const size_t first = static_cast<size_t>(band.region.y0) * static_cast<size_t>(width_) * 4;
    const float scale = 1.0f / static_cast<float>(samples_ + 1);
    for (size_t i = 0; i < band.color.pixels.size(); ++i) {
        sum_[first + i] += band.color.pixels[i];
        full_.color.pixels[first + i] = sum_[first + i] * scale;
    }
    if (samples_ == 0)
        std::copy(band.data.begin(), band.data.end(), full_.data.begin() + static_cast<long>(first / 4));
}

Canvas Session::canvas(double exposure) const {
    Canvas target(width_, height_);
    const bool anyFull = samples_ > 0 || nextRow_ > 0;
    if (samples_ == 0 && !coarse_.color.pixels.empty()) {
        const bool smooth = settings_.layer == ViewLayer::Color || settings_.layer == ViewLayer::Depth;
        stretch(colorize(coarse_, settings_.layer, exposure), target, smooth);
    }
    if (!anyFull) return target;
    const Canvas full = colorize(full_, settings_.layer, exposure);
    const int rows = samples_ > 0 ? height_ : nextRow_;
    std::copy_n(full.pixels.begin(), static_cast<long>(rows) * width_, target.pixels.begin());
    return target;
}

PixelData Session::pixel(int x, int y) {
    Request wanted;
    static_cast<Tracing&>(wanted) = tracing();
    wanted.width = width_;
    wanted.height = height_;
    return renderer_.pixel(packedCamera(), wanted, x, y);
}

}  // namespace glint::view
