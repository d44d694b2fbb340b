#include "report/sweep.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "converge/bounds.h"
#include "converge/converge.h"
#include "core/file_io.h"
#include "core/hash.h"
#include "core/similarity.h"
#include "core/stopwatch.h"
#include "pack/pack_samples.h"
#include "pack/scene_arrays.h"
#include "render/scene_buffers.h"
#include "scene/sampling.h"
#include "verify/stiffness.h"

namespace glint::report {

namespace {

// The way of loading that the renderer did not choose, if the device has it.
std::optional<gpu::Access> otherAccess(const gpu::DeviceInfo& device, const render::Renderer& renderer,
                                       const PackedScene& scene) {
    const gpu::Access other = renderer.access() == gpu::Access::StorageBuffer ? gpu::Access::TexelBuffer
                                                                              : gpu::Access::StorageBuffer;
    return render::hasAccess(device, other, render::arraySizes(scene)) ? std::optional(other) : std::nullopt;
}

double boundOf(const LostBranches& lost, double pixels) {
    return std::sqrt(lost.greatest * lost.sum / pixels);  // see docs/design/error-targets.md
}

std::string contentsOf(const LoadedScene& loaded) {
    const SceneFeatures& f = loaded.packed.features;
    std::string words;
    const auto say = [&](bool there, const char* word) {
        if (there) words += (words.empty() ? "" : ", ") + std::string(word);
    };
    say(f.transmission, "glass");
    say(f.mirrors, "mirrors");
    say(loaded.scene.camera.lensRadius > 0, "lens");
    say(f.textures || f.checkers, "textures");
    say(f.environmentMap, "environment map");
    return words.empty() ? "diffuse and shadows" : words;
}

}  // namespace

struct SceneSweep::Run {
    Configuration configuration;
    render::Renderer* renderer = nullptr;  // null: the reference
    Measured measured;
    std::vector<double> device;
    std::vector<glm::dvec3> before;  // the last picture of a filter
};

namespace {

// The file, for camera and image, and what both tracers see of the meshes and pictures that it names.
std::string hashOf(const std::vector<uint8_t>& file, const PackedScene& scene) {
    Hash hash;
    hash.add(file);
    // The tree of boxes changes no picture.
    visitArrays(scene, [&](std::string_view name, const auto& array) {
        if (name != "nodes") hash.add(array);
    });
    return hash.text();
}

}  // namespace

SceneSweep::SceneSweep(const gpu::Device& device, const std::filesystem::path& path, LoadedScene loaded,
                       int width, SweepLimits limits)
    : device_(device), path_(path), limits_(std::move(limits)), loaded_(std::move(loaded)) {
    ImageSettings& image = loaded_.scene.image;
    ownWidth_ = image.width;
    ownHeight_ = image.height;
    image.height = heightOf(width);
    image.width = width;
    image.filter = Filter::Box;  // the same for all, and its samples all count alike
    image.filterRadius = defaultRadius(Filter::Box);
    image.adaptive.reset();
    camera_ = cameraOf(loaded_);
    const render::Renderer probe(device_, loaded_.packed);
    arrayBytes_ = probe.deviceBytes();
    access_ = probe.access();
    batches_ = planScene(loaded_.packed.features, loaded_.packed.environment.root != shared::kNone,
                         loaded_.scene.maxDepth, otherAccess(device_.info(), probe, loaded_.packed),
                         nameOf(probe.traversal()) != nameOf(render::Traversal::Lane), limits_.devices);
    for (Batch& batch : batches_)
        std::erase_if(batch.configurations, [&](const Configuration& c) { return !limits_.wanted(c); });
    std::erase_if(batches_, [](const Batch& batch) { return batch.configurations.empty(); });
}

SceneSweep::~SceneSweep() = default;

int SceneSweep::heightOf(int width) const {
    return std::max(1, static_cast<int>(std::lround(static_cast<double>(width) * ownHeight_ / ownWidth_)));
}

SceneReport SceneSweep::emptyReport() const {
    SceneReport report;
    report.path = path_.generic_string();
    report.name = path_.stem().string();
    report.hash = hashOf(readFile(path_), loaded_.packed);
    report.width = loaded_.scene.image.width;
    report.height = loaded_.scene.image.height;
    report.maxDepth = loaded_.scene.maxDepth;
    report.contents = contentsOf(loaded_);
    report.defaultSampler = nameOf(loaded_.scene.image.sampler);
    return report;
}

namespace {

// An error that rounding alone takes up is not asked for.
bool isPossible(const Configuration& c, const SceneReport& report) {
    return !c.error || 2 * (report.kappa + 1) * verify::kFloatUnit < *c.error;
}

bool hasAll(const SceneReport& report, const Batch& batch) {
    return std::all_of(batch.configurations.begin(), batch.configurations.end(), [&](const Configuration& c) {
        return !isPossible(c, report) || report.find(keyOf(c)) != nullptr;
    });
}

double workOf(const Batch& batch, int repeats) {
    double sum = 0;
    for (const Configuration& c : batch.configurations) sum += c.spp * (repeats + 1.0);
    return sum;
}

}  // namespace

double SceneSweep::work(const SceneReport& report) const {
    double sum = 0;
    for (const Batch& batch : batches_)
        if (!hasAll(report, batch)) sum += workOf(batch, limits_.repeats);
    return sum + (sum > 0 ? kTruthWork : 0);
}

Request SceneSweep::requestFor(const Configuration& c, uint32_t seed) const {
    ImageSettings image = loaded_.scene.image;
    image.sampler = c.sampler;
    image.samplesPerPixel = c.spp;
    image.seed = seed;
    if (c.filter) {
        image.filter = *c.filter;
        image.filterRadius = defaultRadius(*c.filter);
    }
    if (c.contrast) image.adaptive = AdaptiveSampling{64, *c.contrast};
    Request request = requestOf(image, loaded_.scene.camera.lensRadius > 0);
    request.methods = c.methods;
    request.minContribution = c.minContribution;
    request.maxDepth = c.maxDepth;
    request.cancelled = limits_.cancelled;
    return request;
}

const gpu::Device& SceneSweep::deviceOf(const Configuration& c) const {
    for (const DeviceBeside& beside : limits_.devices)
        if (beside.device != nullptr && beside.label() == c.on) return *beside.device;
    return device_;
}

render::Renderer& SceneSweep::rendererOf(const Configuration& c) {
    std::unique_ptr<render::Renderer>& renderer = renderers_[keyOf(machineKind(c))];
    if (renderer) return *renderer;
    render::Options options;
    options.leaveOut = c.leaveOut;
    if (c.rayByRay) options.traversal = render::Traversal::Lane;
    options.access = c.access;
    renderer = std::make_unique<render::Renderer>(deviceOf(c), loaded_.packed, options);
    return *renderer;
}

SceneSweep::Run SceneSweep::begin(const Configuration& c, const SceneReport& report) {
    Run run;
    run.configuration = c;
    if (!c.onReference) run.renderer = &rendererOf(c);
    run.measured.key = keyOf(c);
    run.measured.family = c.family;
    run.measured.sampler = nameOf(c.sampler);
    run.measured.spp = c.spp;
    run.measured.depth = c.maxDepth.value_or(report.maxDepth);
    run.measured.minContribution = c.minContribution;
    run.measured.asked = c.error.value_or(0);
    return run;
}

// As a user would have it drawn, without the data of any layer. The time of an --error is that of its rounds.
Picture SceneSweep::draw(Run& run, uint32_t seed) {
    const Configuration& c = run.configuration;
    const Request request = requestFor(c, seed);
    if (c.onReference) return reference::render(loaded_.packed, camera_, request);
    if (!c.error) return run.renderer->render(camera_, request);
    converge::Job job;
    job.image = loaded_.scene.image;
    job.image.sampler = c.sampler;
    job.image.seed = seed;
    job.request = request;
    job.request.ledger = true;
    job.target.error = *c.error;
    job.target.depthCounts = false;  // nor does the converged picture look beyond it
    job.target.maxSamples = static_cast<uint32_t>(kMostErrorSamples);
    job.rounding = (kappa_ + 1) * verify::kFloatUnit;
    job.maxDepth = loaded_.packed.environment.maxDepth;
    converge::Result result =
        converge::converge([&](const Request& part) { return run.renderer->render(camera_, part); }, job);
    result.picture.samplesPerPixel = result.samplesPerPixel;
    return std::move(result.picture);
}

// By a picture of its own, with paths and the account of what it leaves out, that no user waits for.
bool SceneSweep::judge(Run& run) {
    const Configuration& c = run.configuration;
    if (!isJudgedAlone(c)) return true;
    const Truth* same = truthOf(c);
    if (same == nullptr) return false;
    Request request = requestFor(c, loaded_.scene.image.seed);
    request.data = request.ledger = true;
    const Picture picture = run.renderer->render(camera_, request);
    if (!picture.complete) return false;
    std::vector<uint32_t> paths;
    for (const PixelData& data : picture.data) paths.push_back(data.pathHash);
    run.measured.arithmetic = measureArithmetic(picture.color, paths, same->colors, same->paths);
    const double pixels = static_cast<double>(paths.size());
    if (c.maxDepth || c.minContribution > 0) {
        const TreeLosses& lost = picture.losses;
        run.measured.bound =
            boundOf(lost.depth, pixels) + boundOf(lost.cut, pixels) + boundOf(lost.room, pixels);
    }
    return true;
}

// What is compiled on first use is timed apart, and the first picture finds nothing in the caches.
bool SceneSweep::warmUp(Run& run) {
    const double before = run.renderer ? run.renderer->times().compile : 0;
    if (!draw(run, loaded_.scene.image.seed).complete) return false;
    if (run.renderer) run.measured.compile = run.renderer->times().compile - before;
    limits_.worked(run.configuration.spp);
    return true;
}

void SceneSweep::judgeByTruth(Measured& m, const Picture& picture) const {
    const ErrorMeasures error = measureError(picture.color, converged_);
    if (m.rmse.empty()) {
        m.total = error;
        const double alike = structuralSimilarity(convergedImage_, picture.color);
        if (std::isfinite(alike)) m.ssim = alike;
    }
    m.rmse.push_back(error.rmse);
}

// Of two pictures of different seeds each errs by half of the mean square of their difference
// (converge/bounds.h).
void SceneSweep::judgeByRuns(Run& run, const Picture& picture) const {
    std::vector<glm::dvec3> now;
    now.reserve(picture.done.size());
    for (size_t i = 0; i < picture.done.size(); ++i) {
        const float* p = &picture.color.pixels[4 * i];
        now.emplace_back(p[0], p[1], p[2]);
    }
    if (!run.before.empty())
        run.measured.rmse.push_back(std::sqrt(2 * converge::meanSquareOf(run.before, now).value));
    run.before = std::move(now);
}

bool SceneSweep::drawTimed(Run& run, uint32_t seed) {
    Measured& m = run.measured;
    const render::StageTimes none;
    const render::StageTimes before = run.renderer ? run.renderer->times() : none;
    const Stopwatch watch;
    const Picture picture = draw(run, seed);
    const double wall = watch.seconds();
    if (!picture.complete) return false;
    const render::StageTimes& after = run.renderer ? run.renderer->times() : none;
    limits_.worked(run.configuration.spp);
    m.compile += after.compile - before.compile;
    run.configuration.filter ? judgeByRuns(run, picture) : judgeByTruth(m, picture);
    m.seconds.push_back(wall - (after.compile - before.compile));
    run.device.push_back(after.device - before.device);
    m.upload = after.upload;
    m.readback = after.readback - before.readback;
    m.rays = after.pathRays - before.pathRays;
    double samples = picture.samplesPerPixel;
    if (!picture.samples.empty())
        samples = std::accumulate(picture.samples.begin(), picture.samples.end(), 0.0) /
                  static_cast<double>(picture.samples.size());
    m.samples += samples / limits_.repeats;
    return true;
}

// Each turn has a seed of its own, the same for all, and begins with another one: whoever always comes first
// finds the caches as the last one left them.
bool SceneSweep::takeTurns(std::vector<Run>& runs) {
    for (int turn = 0; turn < limits_.repeats; ++turn) {
        for (size_t i = 0; i < runs.size(); ++i) {
            Run& run = runs[(i + static_cast<size_t>(turn)) % runs.size()];
            if (limits_.cancelled()) return false;
            if (!drawTimed(run, loaded_.scene.image.seed + static_cast<uint32_t>(turn))) return false;
        }
    }
    return true;
}

void SceneSweep::finish(Run& run, const SceneReport& report) const {
    Measured& m = run.measured;
    double squares = 0;
    for (const double rmse : m.rmse) squares += rmse * rmse / static_cast<double>(m.rmse.size());
    // The converged picture's own error, of other seeds, adds its square to theirs.
    const double own = run.configuration.filter ? 0 : report.truthError * report.truthError;
    m.error = std::sqrt(std::max(squares - own, 0.0));
    m.hidden = squares < 2 * own || m.rmse.empty();
    m.wall = quartilesOf(m.seconds);
    m.device = quartilesOf(run.device);
    m.repeats = static_cast<int>(m.seconds.size());
}

bool SceneSweep::measure(const Batch& batch, SceneReport& report) {
    if (hasAll(report, batch)) return true;
    std::erase_if(report.measured, [&](const Measured& m) { return m.batch == batch.name; });
    const bool fitting = fits(batch, report);
    if (limits_.cancelled()) return false;
    if (!fitting) {
        report.leftOut.push_back(batch.name);
        limits_.worked(workOf(batch, limits_.repeats));
        return true;
    }
    if (!drawTruth(report)) return false;
    std::vector<Run> runs;
    for (const Configuration& c : batch.configurations) {
        if (!isPossible(c, report)) continue;
        runs.push_back(begin(c, report));
        if (!judge(runs.back())) return false;
        if (!warmUp(runs.back())) return false;
    }
    if (!takeTurns(runs)) return false;
    for (Run& run : runs) {
        finish(run, report);
        run.measured.batch = batch.name;
        report.measured.push_back(std::move(run.measured));
    }
    std::erase_if(renderers_, [](const auto& entry) { return entry.first != keyOf(machineKind({})); });
    return true;
}

}  // namespace glint::report
