#include "bench/measure.h"

#include <sys/resource.h>

#include <cmath>
#include <deque>
#include <mutex>
#include <optional>

#include "core/content_hash.h"
#include "core/device_layout.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "pack/pack_samples.h"
#include "pack/request_environment.h"
#include "pack/scene_arrays.h"
#include "reference/render.h"
#include "reference/sampling.h"

namespace glint::bench {

namespace {

// A part of a second of the reference, and its counts a ray repeat within a percent.
constexpr int kCountedPixels = 1 << 14;
// The renderer sizes its slices by the images before, and the driver compiles on first use.
constexpr int kMinWarmUps = 2, kMaxWarmUps = 8;
constexpr double kWarmUpSeconds = 0.3;
constexpr int kApartRepeats = 3;

render::StageTimes difference(render::StageTimes after, const render::StageTimes& before) {
    using render::KernelTimes;
    using render::StageTimes;
    for (double StageTimes::*time :
         {&StageTimes::compile, &StageTimes::trace, &StageTimes::device, &StageTimes::readback})
        after.*time -= before.*time;
    for (uint64_t StageTimes::*count : {&StageTimes::submissions, &StageTimes::slices, &StageTimes::resumes,
                                        &StageTimes::pathRays, &StageTimes::invocations})
        after.*count -= before.*count;
    for (double KernelTimes::*time : {&KernelTimes::generate, &KernelTimes::primary, &KernelTimes::shadow,
                                      &KernelTimes::secondary, &KernelTimes::shade, &KernelTimes::adapt,
                                      &KernelTimes::whole, &KernelTimes::mirrored, &KernelTimes::refracted})
        after.kernels.*time -= before.kernels.*time;
    return after;
}

std::vector<std::string> namesOf(const SceneFeatures& features) {
    std::vector<std::string> names;
#define GLINT_NAME(ID, NAME, field) \
    if (features.field) names.push_back(#field);
    GLINT_FEATURES(GLINT_NAME)
#undef GLINT_NAME
    return names;
}

// getrusage(2) counts in kilobytes.
uint64_t hostPeak() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

void describe(const LoadedScene& loaded, const Request& request, Result& result) {
    const PackedScene& packed = loaded.packed;
    result.width = request.width;
    result.height = request.height;
    result.samples = request.samplesPerPixel;
    result.depth = static_cast<int>(depthOf(packed, request));
    result.lights = packed.lights.size();
    result.triangles = packed.triangles.size() - packed.statistics.splitTriangles;
    visitKinds(packed, [&](const KindCount& kind) {
        result.primitives += kind.kind == shared::PrimitiveKind::Instance ? 0 : kind.count;
    });
    result.used = namesOf(packed.features);
    result.load = loaded.loadSeconds;
    result.build = packed.statistics.buildSeconds;
    result.pack = loaded.packSeconds - result.build;
    result.threads = defaultThreadCount();
}

// One scene's work: what all ways of measuring have in common.
struct Task {
    const LoadedScene& loaded;
    const Options& options;
    Request request;
};

Task taskOf(const LoadedScene& loaded, const Options& options) {
    Task task = {loaded, options, options.request};
    task.request.adaptive.reset();
    task.request.samples = packSamples(task.request, task.request.camera);
    // Same request as `glint render` without --stats.
    task.request.ledger = loaded.packed.features.transmission;
    task.request.cancelled = options.context.cancelled;
    return task;
}

// The reference's rays of every `stride`-th pixel in either direction.
void countRays(const Task& task, int stride, uint32_t samples, Result& result) {
    const reference::Tracer tracer(task.loaded.packed, task.request);
    const shared::Camera camera = cameraOf(task.loaded.packed, task.request);
    const Context& context = task.options.context;
    const int columns = (result.width + stride - 1) / stride, rows = (result.height + stride - 1) / stride;
    std::mutex mutex;
    parallelFor(context, static_cast<size_t>(rows), [&](size_t row) {
        std::array<reference::RayTally, reference::kRayClasses> sums;
        const int y = static_cast<int>(row) * stride;
        for (int x = 0; x < result.width; x += stride) {
            context.checkCancelled();
            for (uint32_t i = 0; i < samples; ++i) {
                const reference::PixelRecord record =
                    tracer.trace(reference::pixelSample(tracer, camera, task.request.samples, i, x, y).ray);
                for (size_t k = 0; k < sums.size(); ++k) sums[k] += record.tally[k];
            }
        }
        const std::lock_guard lock(mutex);
        for (size_t k = 0; k < sums.size(); ++k) result.counted[k] += sums[k];
    });
    result.countedPixels = static_cast<uint64_t>(columns) * static_cast<uint64_t>(rows);
}

void summarize(const std::vector<Timing>& timings, Result& result) {
    const auto quartiles = [&](const auto& secondsOf) {
        std::vector<double> seconds;
        for (const Timing& timing : timings) seconds.push_back(secondsOf(timing));
        return quartilesOf(seconds);
    };
    using render::KernelTimes;
    for (const auto& [to, from] : {std::pair(&Result::generate, &KernelTimes::generate),
                                   {&Result::primary, &KernelTimes::primary},
                                   {&Result::shadow, &KernelTimes::shadow},
                                   {&Result::secondary, &KernelTimes::secondary},
                                   {&Result::shade, &KernelTimes::shade}})
        result.*to = quartiles([from = from](const Timing& t) { return t.stages.kernels.*from; });
    const bool device = result.backend == Backend::Gpu;
    result.trace = quartiles([=](const Timing& t) { return device ? t.stages.trace : t.wall; });
    result.readback = quartiles([](const Timing& t) { return t.stages.readback; });
    result.processors = quartiles([](const Timing& t) { return t.processors; });
}

// The rays of an image, and where they are of both kinds, what each takes for itself.
void countOnDevice(render::Renderer& renderer, Request request, Result& result) {
    request.tally = true;
    std::vector<double> mirrored, refracted;
    for (int i = 0; i <= kApartRepeats; ++i) {
        const render::KernelTimes before = renderer.times().kernels;
        if (!renderer.render(request).complete) throw Cancelled();
        const render::KernelTimes& after = renderer.times().kernels;
        if (i == 0) result.rays = renderer.rays();
        if (result.rays.mirrored == 0 || result.rays.refracted == 0) return;
        if (i == 0) continue;  // to warm up
        mirrored.push_back(after.mirrored - before.mirrored);
        refracted.push_back(after.refracted - before.refracted);
    }
    result.mirrored = quartilesOf(mirrored);
    result.refracted = quartilesOf(refracted);
}

// A renderer, or the reference without a device, whose images are timed.
class Contestant {
  public:
    Contestant(const Task& task, const gpu::Device* device, const render::Options& options,
               const Result& described)
        : task_(task), result_(described) {
        if (device == nullptr) {
            result_.device = "CPU reference (double precision)";
            result_.driver = counted(defaultThreadCount(), "thread");
            return;
        }
        renderer_.emplace(*device, task.loaded.packed, options);
        result_.device = device->info().name;
        result_.driver = device->info().driver;
        result_.traversal = nameOf(renderer_->traversal(task.request.methods));
        result_.access = nameOf(renderer_->access());
    }

    void warmUp() {
        const Stopwatch warming;
        result_.picture = pictureHash(draw().color);
        if (!renderer_) return;
        result_.compile = renderer_->times().compile;
        result_.codeBytes = renderer_->codeBytes();
        for (int i = 1; i < kMaxWarmUps && (i < kMinWarmUps || warming.seconds() < kWarmUpSeconds); ++i)
            draw();
    }
    void timeOne() {
        Picture picture;
        timings_.push_back(timeImage(renderer_ ? &*renderer_ : nullptr, [&] { picture = draw(); }));
        result_.livePaths = timings_.back().stages.pathRays;
        result_.invocations = timings_.back().stages.invocations;
    }
    Result finish() {
        summarize(timings_, result_);
        if (!renderer_) return result_;
        countOnDevice(*renderer_, task_.request, result_);
        result_.upload = renderer_->times().upload;
        result_.deviceBytes = renderer_->deviceBytes();
        return result_;
    }

  private:
    Picture draw() {
        Picture picture = renderer_ ? renderer_->render(task_.request)
                                    : reference::render(task_.loaded.packed, task_.request);
        if (!picture.complete) throw Cancelled();
        return picture;
    }

    const Task& task_;
    std::optional<render::Renderer> renderer_;  // empty: the reference
    Result result_;
    std::vector<Timing> timings_;
};

// One image of each way in turns, so that other work of the machine affects all alike.
std::vector<Result> measureInTurns(const Task& task, const gpu::Device* device,
                                   const std::vector<render::Traversal>& ways, const Result& described) {
    std::deque<Contestant> contestants;
    for (const render::Traversal traversal : ways) {
        render::Options options = task.options.renderer;
        options.profile = options.wholePaths != render::WholePaths::On;
        options.traversal = traversal;
        contestants.emplace_back(task, device, options, described).warmUp();
    }
    for (int i = 0; i < task.options.repeats; ++i) {
        task.options.context.report((i + 1.0) / (task.options.repeats + 2));
        for (Contestant& contestant : contestants) contestant.timeOne();
    }
    std::vector<Result> results;
    for (Contestant& contestant : contestants) results.push_back(contestant.finish());
    return results;
}

// The traversals that the device has for the scene.
std::vector<render::Traversal> waysOf(const Task& task, const gpu::Device& device) {
    std::vector<render::Traversal> ways;
    for (const render::Traversal traversal : {render::Traversal::Lane, render::Traversal::Packet}) {
        if (traversal == render::Traversal::Packet && !render::runsPackets(device.info())) continue;
        if (nameOf(chooseTraversal(traversal, device.info(), task.loaded.packed, task.request.methods)) ==
            nameOf(traversal))
            ways.push_back(traversal);
    }
    return ways;
}

}  // namespace

Timing timeImage(const render::Renderer* renderer, const std::function<void()>& draw) {
    const render::StageTimes before = renderer ? renderer->times() : render::StageTimes();
    const ProcessorWatch processors;
    const Stopwatch watch;
    draw();
    Timing timing;
    timing.wall = watch.seconds();
    timing.processors = processors.seconds();
    if (renderer) timing.stages = difference(renderer->times(), before);
    timing.wall -= timing.stages.compile;
    return timing;
}

Result measure(const std::string& scene, const LoadedScene& loaded, const gpu::Device* device,
               const Options& options) {
    const Task task = taskOf(loaded, options);
    Result result;
    result.scene = scene;
    result.backend = device == nullptr ? Backend::Cpu : Backend::Gpu;
    result.repeats = options.repeats;
    result.also = namesOf(options.renderer.leaveOut ? options.renderer.also : allFeatures());
    describe(loaded, task.request, result);
    const Result described = result;
    result = measureInTurns(task, device, {options.renderer.traversal}, described).front();
    if (device != nullptr) {
        if (options.everyWalk) result.walks = measureInTurns(task, device, waysOf(task, *device), described);
        const double pixels = static_cast<double>(result.width) * result.height;
        const int stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / kCountedPixels))));
        countRays(task, stride, 1, result);
    } else {
        countRays(task, 1, task.request.samples.count(), result);
        const auto rays = [&](reference::RayClass k) { return result.counted[static_cast<size_t>(k)].rays; };
        result.rays = {rays(reference::RayClass::Primary), rays(reference::RayClass::Shadow),
                       rays(reference::RayClass::Mirrored), rays(reference::RayClass::Refracted)};
    }
    result.hostPeakBytes = hostPeak();
    return result;
}

}  // namespace glint::bench
