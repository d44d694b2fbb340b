#include "report/sweep.h"

#include <cmath>
#include <cstdio>

#include "core/file_io.h"
#include "core/hash.h"
#include "core/stopwatch.h"
#include "pack/pack_samples.h"
#include "pack/scene_arrays.h"
#include "scene/sampling.h"
#include "verify/stiffness.h"

namespace glint::report {

namespace {

// Rounding does not grow with the number of samples, so the double-precision picture of the very same
// samples is made for few of them alone.
constexpr int kMaxArithmeticSamples = 16;
// Longer runs need no warming up: what is compiled on first use is timed apart.
constexpr int kMaxWarmUpSamples = 4;
// A configuration that has run for so long has been measured well enough with fewer runs, but two at least.
constexpr double kLongRunSeconds = 3;
constexpr int kLeastRepeats = 2;

gpu::Access otherThan(gpu::Access access) {
    return access == gpu::Access::StorageBuffer ? gpu::Access::TexelBuffer : gpu::Access::StorageBuffer;
}

// Without what a renderer is told anew for each picture.
Configuration machineKind(Configuration c) {
    c.family.clear();
    c.sampler = Sampler::Grid;
    c.spp = 1;
    c.maxDepth.reset();
    c.methods = {};
    c.minContribution = 0;
    return c;
}

glm::dvec3 colorOf(const Picture& picture, size_t i) {
    const float* p = &picture.color.pixels[i * 4];
    return {p[0], p[1], p[2]};
}

}  // namespace

struct SceneSweep::Run {
    Configuration configuration;
    render::Renderer* renderer = nullptr;
    Measured measured;
    std::vector<double> wall, device;
    double spent = 0;

    bool enough(int repeats) const {
        const int done = static_cast<int>(wall.size());
        return done >= repeats || (done >= kLeastRepeats && spent > kLongRunSeconds);
    }
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
    image.height =
        std::max(1, static_cast<int>(std::lround(static_cast<double>(width) * image.height / image.width)));
    image.width = width;
    image.filter = Filter::Box;  // the same for all, and its samples all count alike
    image.filterRadius = defaultRadius(Filter::Box);
    image.adaptive.reset();
    camera_ = cameraOf(loaded_);
    const render::Renderer probe(device_, loaded_.packed);
    batches_ = planScene(loaded_.packed.features, loaded_.packed.environment.root != shared::kNone,
                         loaded_.scene.maxDepth, otherThan(probe.access()), device_.info().limits.float64,
                         nameOf(probe.traversal()) != nameOf(render::Traversal::Lane));
    for (Batch& batch : batches_)
        std::erase_if(batch.configurations, [&](const Configuration& c) { return !limits_.wanted(c); });
}

SceneSweep::~SceneSweep() = default;

SceneReport SceneSweep::emptyReport() const {
    SceneReport report;
    report.path = path_.generic_string();
    report.name = path_.stem().string();
    report.hash = hashOf(readFile(path_), loaded_.packed);
    report.width = loaded_.scene.image.width;
    report.height = loaded_.scene.image.height;
    report.maxDepth = loaded_.scene.maxDepth;
    report.defaultSampler = nameOf(loaded_.scene.image.sampler);
    return report;
}

double SceneSweep::work(const Batch& batch, const SceneReport& report) const {
    double sum = 0;
    for (const Configuration& c : batch.configurations)
        if (report.find(keyOf(c)) == nullptr) sum += c.spp * (limits_.repeats + 1.0);
    return sum;
}

Request SceneSweep::requestFor(Sampler sampler, int spp, uint32_t seed) const {
    ImageSettings image = loaded_.scene.image;
    image.sampler = sampler;
    image.samplesPerPixel = spp;
    image.seed = seed;
    Request request = requestOf(image, loaded_.scene.camera.lensRadius > 0);
    request.cancelled = limits_.cancelled;
    return request;
}

const SceneSweep::Truth* SceneSweep::truthOf(Sampler sampler, int spp, uint32_t seed) {
    const auto key = std::make_tuple(sampler, spp, seed);
    if (const auto found = truths_.find(key); found != truths_.end()) return &found->second;
    Request request = requestFor(sampler, spp, seed);
    request.data = request.exact = true;
    const Picture picture = reference::render(loaded_.packed, camera_, request);
    if (!picture.complete) return nullptr;
    Truth truth;
    for (size_t i = 0; i < picture.done.size(); ++i) {
        truth.colors.emplace_back(picture.exact[i]);
        truth.paths.push_back(picture.data[i].pathHash);
    }
    return &truths_.emplace(key, std::move(truth)).first->second;
}

const SceneSweep::Truth* SceneSweep::converged() {
    // Another seed: a picture must not be close to the truth because it shares its samples.
    const uint32_t seed = loaded_.scene.image.seed + 1;
    if (limits_.truth == Backend::Cpu) return truthOf(Sampler::LowDiscrepancy, limits_.truthSamples, seed);
    if (deviceTruth_) return deviceTruth_.get();
    render::Renderer renderer(device_, loaded_.packed);
    const Request request = requestFor(Sampler::LowDiscrepancy, limits_.truthSamples, seed);
    const Picture picture = renderer.render(camera_, request);
    if (!picture.complete) return nullptr;
    deviceTruth_ = std::make_unique<Truth>();
    for (size_t i = 0; i < picture.done.size(); ++i) deviceTruth_->colors.push_back(colorOf(picture, i));
    return deviceTruth_.get();
}

render::Renderer& SceneSweep::rendererOf(const Configuration& c) {
    std::unique_ptr<render::Renderer>& renderer = renderers_[keyOf(machineKind(c))];
    if (renderer) return *renderer;
    render::Options options;
    options.leaveOut = c.leaveOut;
    options.doublePrecision = c.doublePrecision;
    if (c.rayByRay) options.traversal = render::Traversal::Lane;
    options.access = c.access;
    renderer = std::make_unique<render::Renderer>(device_, loaded_.packed, options);
    return *renderer;
}

bool SceneSweep::judge(Run& run, const Picture& picture) {
    const Configuration& c = run.configuration;
    const Truth* truth = converged();
    if (truth == nullptr) return false;
    run.measured.total = measureError(picture.color, truth->colors);
    if (c.spp > kMaxArithmeticSamples) return true;
    const Truth* same = truthOf(c.sampler, c.spp, loaded_.scene.image.seed);
    if (same == nullptr) return false;
    std::vector<uint32_t> paths;
    for (const PixelData& data : picture.data) paths.push_back(data.pathHash);
    run.measured.arithmetic = measureArithmetic(picture.color, paths, same->colors, same->paths);
    return true;
}

bool SceneSweep::renderOnce(Run& run, bool timed) {
    const Configuration& c = run.configuration;
    Request request = requestFor(c.sampler, c.spp, loaded_.scene.image.seed);
    request.data = true;  // the error by paths and the time come from one run
    request.methods = c.methods;
    request.minContribution = c.minContribution;
    request.maxDepth = c.maxDepth;
    render::Renderer& renderer = *run.renderer;
    const render::StageTimes before = renderer.times();
    const Stopwatch watch;
    const Picture picture = renderer.render(camera_, request);
    if (!picture.complete) return false;
    const render::StageTimes& after = renderer.times();
    const double compile = after.compile - before.compile;
    const double seconds = watch.seconds() - compile;
    limits_.worked(c.spp);
    run.measured.compile += compile;
    run.measured.upload = after.upload;
    if (!timed) return true;
    run.spent += seconds;
    run.wall.push_back(seconds);
    run.device.push_back(after.device - before.device);
    run.measured.readback = after.readback - before.readback;
    run.measured.rays = after.pathRays - before.pathRays;
    return run.wall.size() > 1 || judge(run, picture);
}

bool SceneSweep::warmUp(const Batch& batch, SceneReport& report, std::vector<Run>& runs) {
    for (const Configuration& c : batch.configurations) {
        const std::string key = keyOf(c);
        if (report.find(key) != nullptr) continue;
        if (limits_.late()) {
            report.leftOut.push_back(key);
            continue;
        }
        Run run;
        run.configuration = c;
        run.renderer = &rendererOf(c);
        run.measured.key = key;
        run.measured.family = c.family;
        run.measured.sampler = nameOf(c.sampler);
        run.measured.spp = c.spp;
        run.measured.depth = c.maxDepth.value_or(loaded_.scene.maxDepth);
        run.measured.minContribution = c.minContribution;
        if (c.spp <= kMaxWarmUpSamples && !renderOnce(run, false)) return false;
        runs.push_back(std::move(run));
    }
    return true;
}

bool SceneSweep::measure(const Batch& batch, SceneReport& report) {
    std::vector<Run> runs;
    if (!warmUp(batch, report, runs)) return false;
    if (report.stiffness.empty() && !runs.empty()) {
        report.kappa = verify::conditionNumber(reference::Tracer(loaded_.packed), camera_,
                                               loaded_.scene.image.width, loaded_.scene.image.height);
        report.stiffness = nameOf(verify::classOf(report.kappa));
    }
    for (int round = 0; round < limits_.repeats; ++round) {
        for (Run& run : runs) {
            if (limits_.cancelled()) return false;
            if (run.enough(limits_.repeats)) {
                limits_.worked(run.configuration.spp);
            } else if (!renderOnce(run, true)) {
                return false;
            }
        }
    }
    for (Run& run : runs) {
        run.measured.wall = quartilesOf(run.wall);
        run.measured.device = quartilesOf(run.device);
        run.measured.repeats = static_cast<int>(run.wall.size());
        report.measured.push_back(std::move(run.measured));
    }
    std::erase_if(renderers_, [](const auto& entry) { return entry.first != keyOf(machineKind({})); });
    return true;
}

}  // namespace glint::report
