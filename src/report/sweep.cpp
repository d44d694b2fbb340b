#include "report/sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "converge/bounds.h"
#include "converge/converge.h"
#include "converge/replicates.h"
#include "core/content_hash.h"
#include "core/image_diff.h"
#include "core/text_file.h"
#include "pack/pack_samples.h"
#include "pack/request_environment.h"
#include "pack/scene_arrays.h"
#include "reference/render.h"
#include "reference/sensitivity.h"
#include "report/write.h"
#include "scene/sampling.h"

namespace glint::report {

namespace {

// Seeds that no run has: an image must not be close to the truth because it shares its samples.
constexpr uint32_t kTruthSeed = 0x40000000;
constexpr int kMostTruthSamples = 4096;
constexpr double kMostErrorSamples = 1024;  // per pixel, for --error
constexpr double kOverdue = 1;              // seconds past the budget after which an image is given up

// By pixel, in double precision if the picture has that.
std::vector<glm::dvec3> colorsOf(const Picture& picture) {
    if (!picture.exact.empty()) return {picture.exact.begin(), picture.exact.end()};
    std::vector<glm::dvec3> colors;
    for (size_t i = 0; i < picture.done.size(); ++i) {
        const float* p = &picture.color.pixels[4 * i];
        colors.emplace_back(p[0], p[1], p[2]);
    }
    return colors;
}

std::vector<uint32_t> pathsOf(const Picture& picture) {
    std::vector<uint32_t> paths;
    for (const PixelData& data : picture.data) paths.push_back(data.pathHash);
    return paths;
}

// The file, for camera and image, and the packed arrays, for the meshes and images that it names. The BVH
// changes no image.
std::string hashOf(const std::string& file, const PackedScene& scene) {
    std::string hashes = hashText(contentHash(file));
    visitArrays(scene, [&](std::string_view name, const auto& array) {
        const auto* bytes = reinterpret_cast<const uint8_t*>(array.data());
        if (name != "nodes") hashes += hashText(contentHash({bytes, array.size() * sizeof(array[0])}));
    });
    return hashText(contentHash(hashes));
}

}  // namespace

SceneSweep::SceneSweep(const gpu::Device& device, std::filesystem::path path, LoadedScene loaded,
                       const Options& options, double truthSeconds)
    : device_(device),
      path_(std::move(path)),
      options_(options),
      truthSeconds_(truthSeconds),
      loaded_(std::move(loaded)) {
    image_ = loaded_.scene.image;
    image_.height = std::max(
        1, static_cast<int>(std::lround(static_cast<double>(options.width) * image_.height / image_.width)));
    image_.width = options.width;
    image_.filter = Filter::Box;  // the same for all settings, and its samples all have the same weight
    image_.filterRadius = defaultRadius(Filter::Box);
    image_.adaptive.reset();
    arrayBytes_ = rendererOf({})->deviceBytes();
    settings_ = planScene(loaded_.packed.features, loaded_.packed.environment.root != shared::kNone,
                          static_cast<int>(depthOf(loaded_.packed, {})));
    std::erase_if(settings_, [&](const Setting& s) {
        return !options.only.empty() &&
               std::none_of(options.only.begin(), options.only.end(),
                            [&](const std::string& start) { return s.family.starts_with(start); });
    });
}

SceneReport SceneSweep::emptyReport() const {
    SceneReport report;
    report.path = path_.generic_string();
    report.hash = hashOf(readWholeFile(path_, {}, ErrorKind::Failed), loaded_.packed);
    report.width = image_.width;
    report.height = image_.height;
    report.depth = static_cast<int>(depthOf(loaded_.packed, {}));
    return report;
}

// Colors in double precision: the converged image with its halves, at most five images of the same samples
// for each sampler, and those of --error; AOVs of the image that is judged. A driver on the processor adds
// paths of at most 1 GiB, the arrays, and 48 MiB for the code of each renderer.
uint64_t SceneSweep::memory() const {
    const uint64_t pixels = static_cast<uint64_t>(image_.width) * static_cast<uint64_t>(image_.height);
    constexpr uint64_t renderers = 2;
    const uint64_t images = (4 + 6 + 4) * sizeof(glm::dvec4) + 2 * sizeof(PixelData) + 8 * sizeof(float) * 4;
    return pixels * images + renderers * (arrayBytes_ + (uint64_t{48} << 20));
}

Request SceneSweep::requestFor(const Setting& s, uint32_t seed) const {
    ImageSettings image = image_;
    image.sampler = s.sampler;
    image.samplesPerPixel = s.spp;
    image.seed = seed;
    if (s.contrast) image.adaptive = AdaptiveSampling{64, *s.contrast};
    Request request = requestOf(image, loaded_.scene.camera);
    request.methods = s.methods;
    request.limits = s.limits;
    request.cancelled = [this] { return options_.cancelled() || options_.secondsLeft() < -kOverdue; };
    return request;
}

render::Renderer* SceneSweep::rendererOf(const Setting& s) {
    if (s.onReference) return nullptr;
    std::unique_ptr<render::Renderer>& renderer = renderers_[s.leaveOut];
    if (renderer) return renderer.get();
    render::Options options;
    options.leaveOut = s.leaveOut;
    renderer = std::make_unique<render::Renderer>(device_, loaded_.packed, options);
    return renderer.get();
}

// Renders as `glint render` does without AOVs. An --error includes all its rounds.
Picture SceneSweep::draw(const Setting& s, const Request& request) {
    if (s.onReference) return reference::render(loaded_.packed, request);
    render::Renderer& renderer = *rendererOf(s);
    if (!s.error) return renderer.render(request);
    converge::Target target;
    target.error = *s.error;
    target.depthCounts = false;  // the converged image has the same depth
    target.maxSamples = static_cast<uint32_t>(kMostErrorSamples);
    converge::Job job = converge::jobFor(loaded_.packed, request, target);
    job.rounding = (kappa_ + 1) * reference::kFloatUnit;
    converge::Result result =
        converge::converge([&](const Request& part) { return renderer.render(part); }, job);
    if (result.stop == converge::Stop::Interrupted) result.picture.complete = false;
    result.picture.samplesPerPixel = result.samplesPerPixel;
    return std::move(result.picture);
}

// Each renderer compiles for the first image of a setting.
bench::Timing SceneSweep::drawTimed(const Setting& s, uint32_t seed, Picture& picture) {
    const Request request = requestFor(s, seed);
    const bench::Timing timing = bench::timeImage(rendererOf(s), [&] { picture = draw(s, request); });
    compileSeconds_ = std::max(compileSeconds_, timing.stages.compile);
    return timing;
}

// Seconds for one sample per pixel, warm.
double SceneSweep::secondsOf(const Setting& s) {
    if (const auto known = seconds_.find(s.onReference); known != seconds_.end()) return known->second;
    Setting one;
    one.onReference = s.onReference;
    one.spp = 1;
    Picture picture;
    if (!s.onReference) drawTimed(one, image_.seed, picture);
    return seconds_[s.onReference] = drawTimed(one, image_.seed, picture).wall;
}

double SceneSweep::predictedSeconds(const Setting& s, const Measured* known) {
    if (known) return *std::max_element(known->seconds.begin(), known->seconds.end());
    const double samples = s.contrast ? 32 : s.error ? 64 : s.spp;
    const double judged = hasArithmetic(s) && !sameSamples_.contains({s.sampler, s.spp}) ? samples : 0;
    Setting reference;
    reference.onReference = true;
    return 2 * samples * secondsOf(s) + compileSeconds_ + (judged > 0 ? judged * secondsOf(reference) : 0);
}

const SceneSweep::SameSamples* SceneSweep::sameSamples(const Setting& s) {
    const auto key = std::make_tuple(s.sampler, s.spp);
    if (const auto found = sameSamples_.find(key); found != sameSamples_.end()) return &found->second;
    Setting plain;
    plain.onReference = true;
    plain.sampler = s.sampler;
    plain.spp = s.spp;
    Request request = requestFor(plain, image_.seed);
    request.data = request.exact = true;
    const Picture picture = draw(plain, request);
    if (!picture.complete) return nullptr;
    return &sameSamples_.emplace(key, SameSamples{colorsOf(picture), pathsOf(picture)}).first->second;
}

// The mean of two halves of different seeds; their difference gives its error (converge/bounds.h).
bool SceneSweep::drawTruth(SceneReport& report) {
    if (!converged_.empty()) return true;
    // Not before, so that nothing is drawn for a report that is complete.
    if (report.stiffness.empty()) {
        report.kappa = reference::conditionNumber(loaded_.packed, requestFor({}, 0));
        report.stiffness = reference::stiffnessOf(report.kappa);
    }
    kappa_ = report.kappa;
    Setting half;
    half.onReference = true;
    int samples = report.truthSamples > 0 ? report.truthSamples : options_.truthSamples;
    if (samples == 0) {
        const double allowed = truthSeconds_ / secondsOf(half);
        for (samples = 2; 2 * samples <= allowed && samples < kMostTruthSamples;) samples *= 2;
        if (samples * secondsOf(half) > options_.secondsLeft()) return false;
    }
    half.spp = std::max(1, samples / 2);
    std::vector<glm::dvec3> halves[2];
    for (uint32_t i = 0; i < 2; ++i) {
        Request request = requestFor(half, image_.seed + kTruthSeed + i);
        request.exact = true;
        const Picture picture = draw(half, request);
        if (!picture.complete) return false;
        halves[i] = colorsOf(picture);
    }
    convergedImage_ = Image(image_.width, image_.height, 3);
    for (size_t k = 0; k < halves[0].size(); ++k) {
        converged_.push_back((halves[0][k] + halves[1][k]) / 2.0);
        for (int c = 0; c < 3; ++c)
            convergedImage_.pixels[3 * k + static_cast<size_t>(c)] = static_cast<float>(converged_[k][c]);
    }
    report.truthSamples = 2 * half.spp;
    report.truthError = std::sqrt(converge::meanSquareOf(halves[0], halves[1]).value);
    return true;
}

// By an image of its own, with paths and losses, which is not timed.
bool SceneSweep::judgeArithmetic(const Setting& s, Measured& m) {
    if (!hasArithmetic(s)) return true;
    const SameSamples* same = sameSamples(s);
    if (same == nullptr) return false;
    Request request = requestFor(s, image_.seed);
    request.data = request.ledger = true;
    const Picture picture = draw(s, request);
    if (!picture.complete) return false;
    m.arithmetic = measureArithmetic(picture.color, pathsOf(picture), same->colors, same->paths);
    if (s.limits.depth || s.limits.minContribution > 0) {
        converge::Ledger ledger;
        ledger.add(picture, picture.done.size(), 1);  // its losses are already those of one sample
        converge::ErrorBudget budget;
        ledger.writeTo(budget);
        m.bound = budget.depth + budget.cut;
    }
    return true;
}

// Each run of a setting has a seed of its own, the same for all settings.
bool SceneSweep::addRun(const Setting& s, Measured& m, const SceneReport& report) {
    const uint32_t seed = image_.seed + static_cast<uint32_t>(m.seconds.size());
    Picture picture;
    const bench::Timing timing = drawTimed(s, seed, picture);
    if (!picture.complete) return false;
    const ErrorMeasures error = measureError(picture.color, converged_);
    if (m.rmse.empty()) {
        m.total = error;
        const double alike = structuralSimilarity(convergedImage_, picture.color);
        if (std::isfinite(alike)) m.ssim = alike;
    }
    m.rmse.push_back(error.rmse);
    m.seconds.push_back(timing.wall);
    m.deviceSeconds.push_back(timing.stages.device);
    m.compile += timing.stages.compile;
    m.rays = timing.stages.pathRays;
    double samples = picture.samplesPerPixel;
    if (!picture.samples.empty())
        samples = std::accumulate(picture.samples.begin(), picture.samples.end(), 0.0) /
                  static_cast<double>(picture.samples.size());
    const auto runs = static_cast<double>(m.seconds.size());
    m.samples += (samples - m.samples) / runs;
    double squares = 0;
    for (const double rmse : m.rmse) squares += rmse * rmse / runs;
    // The converged image's own error, from other seeds, adds its square.
    const double own = report.truthError * report.truthError;
    m.error = std::sqrt(std::max(squares - own, 0.0));
    m.hidden = squares < 2 * own;
    return true;
}

SceneSweep::Outcome SceneSweep::run(const Setting& s, SceneReport& report) {
    const auto unfinished = [&] { return options_.cancelled() ? Outcome::Cancelled : Outcome::Skipped; };
    const double infinite = std::numeric_limits<double>::infinity();
    if (options_.cancelled()) return Outcome::Cancelled;
    if (options_.secondsLeft() <= 0 || !drawTruth(report)) return unfinished();
    // Rounding alone must not exceed the --error.
    if (s.error && 2 * (report.kappa + 1) * reference::kFloatUnit >= *s.error) return Outcome::Skipped;
    const auto known = std::find_if(report.measured.begin(), report.measured.end(),
                                    [key = keyOf(s)](const Measured& m) { return m.key == key; });
    const bool isKnown = known != report.measured.end();
    if (options_.secondsLeft() != infinite &&
        predictedSeconds(s, isKnown ? &*known : nullptr) > options_.secondsLeft())
        return unfinished();
    if (isKnown) return addRun(s, *known, report) ? Outcome::Done : unfinished();
    Measured m;
    m.key = keyOf(s);
    m.family = s.family;
    m.sampler = nameOf(s.sampler);
    m.spp = s.spp;
    m.depth = static_cast<int>(depthOf(loaded_.packed, requestFor(s, 0)));
    m.minContribution = s.limits.minContribution;
    m.asked = s.error.value_or(0);
    Picture warm;
    if (!judgeArithmetic(s, m)) return unfinished();
    m.compile = drawTimed(s, image_.seed, warm).stages.compile;
    if (!warm.complete || !addRun(s, m, report)) return unfinished();
    report.measured.push_back(std::move(m));
    return Outcome::Done;
}

}  // namespace glint::report
