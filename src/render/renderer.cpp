#include "render/renderer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <future>
#include <map>
#include <set>
#include <stdexcept>

#include "core/parallel.h"
#include "core/processor_watch.h"
#include "core/stopwatch.h"
#include "pack/request_environment.h"
#include "render/film.h"
#include "render/host_rays.h"
#include "render/kernel_choice.h"
#include "render/path_limits.h"
#include "render/path_state.h"
#include "render/pipelines.h"
#include "render/scene_buffers.h"

namespace glint::render {

namespace {

// One slice's paths at most; they fill any GPU.
constexpr uint32_t kMaxSlicePaths = 1u << 20;
constexpr uint32_t kFirstSliceTiles = 256;
// All samples and bounces of a slice together: Ctrl-C loses the slice at hand.
constexpr double kWholeSliceSeconds = 2.0;

}  // namespace

struct Renderer::State {
    const gpu::Device& device;
    const PackedScene& scene;
    Options options;
    SceneFeatures features;  // of the pipelines
    gpu::Access access;
    Arrays arrays;
    TraversalChoice traversal;  // with the default methods, which have the most to choose from
    uint32_t tripBudget;
    SceneBuffers buffers;
    gpu::Buffer counters;
    Pipelines pipelines;
    std::map<std::pair<KernelId, TraceModes>, std::future<gpu::Kernel>> translating;  // as Options::expected
    PathState paths;
    gpu::Submission submission;
    StageTimes times;
    RayCounts rayCounts;
    std::set<std::pair<KernelId, TraceModes>> compiled;
    shared::Environment environment;         // as it is on the device
    std::vector<shared::Light> lights;       // the same
    uint32_t sliceTiles = kFirstSliceTiles;  // of the next slice, of the next picture too
    // Of the submissions of the slice at hand.
    double longestInSlice = 0;

    State(const gpu::Device& dev, const PackedScene& packed, const Options& opts)
        : device(dev),
          scene(packed),
          options(opts),
          features(opts.leaveOut ? either(packed.features, opts.also) : allFeatures()),
          access(opts.access ? *opts.access : chooseAccess(dev.info(), largestArray(packed))),
          arrays(chooseArrays(dev.info(), access)),
          traversal(chooseTraversal(traversalFor(opts.traversal, opts.doublePrecision, dev.info()),
                                    dev.info(), packed)),
          tripBudget(opts.tripBudget ? opts.tripBudget
                                     : deriveTripBudget(dev.info(), features, packed.polygonTripsPerLeaf)),
          pipelines(dev, kernelsFor(opts, access, arrays), access, arrays, features, opts.stack,
                    opts.ownArithmetic),
          submission(dev),
          environment(packed.environment),
          lights(packed.lights) {
        options.expected = nullptr;
        if (opts.expected) {
            const TraversalChoice choice = traversalOf(opts.expected->methods);
            startTranslating(modesOf(*opts.expected, choice.nodes),
                             kernelsOf(scene, *opts.expected, choice.packets));
        }
        const Stopwatch watch;
        buffers = SceneBuffers(device, scene, access, traversal, arrays);
        counters = gpu::Buffer(device, "counters", shared::kCounterCount * sizeof(uint32_t),
                               gpu::Access::StorageBuffer, gpu::MemoryKind::Host);
        times.upload += watch.seconds();
    }

    uint32_t* counter() const { return static_cast<uint32_t*>(counters.mapped()); }
    // `rebind`: another buffer has been replaced.
    void reservePaths(uint32_t capacity, uint32_t rows, bool rebind = false);
    shared::Dispatch dispatchFor(const Slice& slice) const;
    void record(KernelId id, const TraceModes& modes, const shared::Dispatch& dispatch, uint32_t groups);
    // The time goes to that kernel's account.
    void submit(double KernelTimes::*account);
    // Records one kernel that traces rays, submits, and goes on with unfinished rays until there are none.
    // With `packets`, it is the one for packets that starts.
    void traceRays(KernelId id, TraceModes modes, const shared::Dispatch& dispatch, uint32_t groups,
                   bool packets, double KernelTimes::*account);
    // All lights of a bounce; false if that was cancelled.
    bool castShadows(const TraceModes& modes, shared::Dispatch dispatch, uint32_t groups, bool packets,
                     const std::function<bool()>& cancelled);
    void traceBounce(const TraceModes& modes, shared::Dispatch dispatch, uint32_t groups, bool packets);
    TraversalChoice traversalOf(const Methods& methods) const;
    void startTranslating(const TraceModes& modes, const std::vector<KernelId>& ids);
    gpu::Kernel translated(KernelId id, const TraceModes& modes);
    void compile(const TraceModes& modes, const std::vector<KernelId>& ids);
    void setSurroundings(const shared::Environment& wanted, const std::vector<shared::Light>& wantedLights);
    shared::Environment environmentOf(const shared::Camera& camera, const Request& request) const;
    bool renderSlice(const Slice& slice, const Request& request, const TraceModes& modes, double progressFrom,
                     double progressTo);
    // After a sample of an adaptive picture; false if no pixel goes on.
    bool adapt(const Slice& slice, shared::Dispatch dispatch, const PackedSamples& samples,
               const TraceModes& modes);
    bool renderSample(const Slice& slice, shared::Dispatch dispatch, const Request& request,
                      const TraceModes& modes);
    void readSlice(const Slice& slice, const TraceModes& modes, Picture& picture);
    void sizeNextSlice(const Slice& slice, bool whole, double seconds);
    void traceBatch(std::span<const RayInput> rays, const LocalBatch& wanted, std::span<RayHit> hits);
};

void Renderer::State::reservePaths(uint32_t capacity, uint32_t rows, bool rebind) {
    if (paths.capacity() < capacity || paths.rows() < rows) {
        const uint32_t newCapacity = std::max(capacity, paths.capacity());
        const uint32_t newRows = std::max(rows, paths.rows());
        paths = PathState();
        paths = PathState(device, access, newCapacity, newRows);
        rebind = true;
    }
    if (rebind) pipelines.bind(counters, paths.buffer(), buffers);
}

void Renderer::State::setSurroundings(const shared::Environment& wanted,
                                      const std::vector<shared::Light>& wantedLights) {
    if (std::memcmp(&wanted, &environment, sizeof(wanted)) != 0) {
        buffers.setEnvironment(device, wanted);
        environment = wanted;
    }
    const bool same = wantedLights.size() == lights.size() &&
                      (lights.empty() || std::memcmp(wantedLights.data(), lights.data(),
                                                     lights.size() * sizeof(shared::Light)) == 0);
    if (same) return;
    buffers.setLights(device, wantedLights);
    lights = wantedLights;
}

shared::Environment Renderer::State::environmentOf(const shared::Camera& camera,
                                                   const Request& request) const {
    shared::Environment wanted = glint::environmentOf(scene, request);
    if (request.wantsLosses()) wanted.radianceBound = radianceBoundOf(scene, request);
    if (scene.features.transmission) {
        const glm::uvec4 media = mediaAt(scene, glm::dvec3(camera.eye));
        wanted.eyeMedium0 = media.x;
        wanted.eyeMedium1 = media.y;
        wanted.eyeMedium2 = media.z;
        wanted.eyeMedium3 = media.w;
    }
    return wanted;
}

shared::Dispatch Renderer::State::dispatchFor(const Slice& slice) const {
    shared::Dispatch dispatch;
    dispatch.firstTile = slice.firstTile;
    dispatch.tileCount = slice.tileCount;
    dispatch.interleave = slice.interleave;
    dispatch.run = slice.run();
    dispatch.regionX = static_cast<uint32_t>(slice.region.x0);
    dispatch.regionY = static_cast<uint32_t>(slice.region.y0);
    dispatch.regionWidth = static_cast<uint32_t>(slice.region.width());
    dispatch.regionHeight = static_cast<uint32_t>(slice.region.height());
    dispatch.capacity = paths.capacity();
    dispatch.tripBudget = tripBudget;
    return dispatch;
}

void Renderer::State::record(KernelId id, const TraceModes& modes, const shared::Dispatch& dispatch,
                             uint32_t groups) {
    submission.dispatch(pipelines.get(id, modes), groups,
                        std::as_bytes(std::span<const shared::Dispatch, 1>(&dispatch, 1)));
}

void Renderer::State::submit(double KernelTimes::*account) {
    std::fill_n(counter(), shared::kCounterCount, 0u);
    const gpu::Submission::Times t = submission.submit();
    times.trace += t.wall;
    times.device += t.device;
    times.kernels.*account += t.device > 0 ? t.device : t.wall;
    rayCounts.shadow += counter()[shared::kCounterShadow];
    rayCounts.refracted += counter()[shared::kCounterRefracted];
    times.longestSubmission = std::max(times.longestSubmission, t.wall);
    longestInSlice = std::max(longestInSlice, t.wall);
    ++times.submissions;
}

void Renderer::State::traceRays(KernelId id, TraceModes modes, const shared::Dispatch& dispatch,
                                uint32_t groups, bool packets, double KernelTimes::*account) {
    if (packets) {
        const uint32_t perLane = raysOfLane(packetKernel(id));
        record(packetKernel(id), modes, dispatch, (groups + perLane - 1) / perLane);
    } else {
        record(id, modes, dispatch, groups);
    }
    submit(account);
    modes.resume = true;
    while (counter()[shared::kCounterUnfinished] != 0) {
        ++times.resumes;
        record(id, modes, dispatch, groups);
        submit(account);
    }
}

TraversalChoice Renderer::State::traversalOf(const Methods& methods) const {
    if (methods == Methods{}) return traversal;
    const Traversal wanted = traversalFor(options.traversal, options.doublePrecision, device.info());
    return chooseTraversal(wanted, device.info(), scene, methods);
}

void Renderer::State::startTranslating(const TraceModes& modes, const std::vector<KernelId>& ids) {
    for (const KernelId id : ids) {
        translating[{id, modes}] = std::async(std::launch::async | std::launch::deferred,
                                              [this, id, modes] { return pipelines.make(id, modes); });
    }
}

gpu::Kernel Renderer::State::translated(KernelId id, const TraceModes& modes) {
    const auto started = translating.find({id, modes});
    gpu::Kernel kernel = started == translating.end() ? pipelines.make(id, modes) : started->second.get();
    pipelines.bindTo(kernel);
    return kernel;
}

// The first dispatch compiles on some drivers (lavapipe), so each kernel runs once over no tile at all. Each
// has a thread: drivers translate SPIR-V on the caller's, and lavapipe then makes machine code of one kernel
// after the other on a thread of its own (docs/lab/cold-start.md).
void Renderer::State::compile(const TraceModes& modes, const std::vector<KernelId>& ids) {
    std::vector<KernelId> fresh;
    for (KernelId id : ids) {
        if (compiled.insert({id, modes}).second) fresh.push_back(id);
    }
    if (fresh.empty()) return;
    const Stopwatch watch;
    Slice nothing;
    nothing.region = {0, 0, 1, 1};
    const shared::Dispatch dispatch = dispatchFor(nothing);
    // They run in any order, so no path may be alive.
    const RowEntry ended = {{0, 0, 0, shared::kInfinity}};
    paths.writeRow(device, shared::kRowDirection, std::vector<RowEntry>(shared::kWorkgroupSize, ended));
    std::vector<gpu::Kernel> kernels(fresh.size());
    parallelFor(
        fresh.size(),
        [&](size_t i) {
            kernels[i] = translated(fresh[i], modes);
            gpu::Submission first(device);
            first.dispatch(kernels[i], 1, std::as_bytes(std::span<const shared::Dispatch, 1>(&dispatch, 1)));
            first.submit();
        },
        static_cast<unsigned>(fresh.size()));
    for (size_t i = 0; i < fresh.size(); ++i) pipelines.add(fresh[i], modes, std::move(kernels[i]));
    times.compile += watch.seconds();
}

void Renderer::State::traceBounce(const TraceModes& modes, shared::Dispatch dispatch, uint32_t groups,
                                  bool packets) {
    if (dispatch.bounce == 0) {
        traceRays(KernelId::Intersect, modes, dispatch, groups, packets, &KernelTimes::primary);
    } else if (modes.tally && features.transmission) {
        dispatch.rayClass = shared::kRayMirrored;
        traceRays(KernelId::Intersect, modes, dispatch, groups, packets, &KernelTimes::mirrored);
        dispatch.rayClass = shared::kRayRefracted;
        traceRays(KernelId::Intersect, modes, dispatch, groups, packets, &KernelTimes::refracted);
    } else {
        traceRays(KernelId::Intersect, modes, dispatch, groups, packets, &KernelTimes::secondary);
    }
}

bool Renderer::State::castShadows(const TraceModes& modes, shared::Dispatch dispatch, uint32_t groups,
                                  bool packets, const std::function<bool()>& cancelled) {
    const uint32_t planes = environment.planeCount;
    uint32_t atOnce = lightsAtOnce(tripBudget, planes);
    const bool inPackets = packets && lightsGoInPackets(environment.lightCount);
    for (uint32_t first = 0; first < environment.lightCount; first = dispatch.lightEnd) {
        dispatch.lightIndex = first;
        dispatch.lightEnd = std::min(first + atOnce, environment.lightCount);
        const uint64_t resumed = times.resumes;
        const Stopwatch watch;
        traceRays(KernelId::Light, modes, dispatch, groups, inPackets, &KernelTimes::shadow);
        if (cancelled()) return false;
        if (!inPackets)
            atOnce =
                lightsNext(atOnce, planes, times.resumes != resumed, watch.seconds(), options.sliceSeconds);
    }
    return true;
}

bool Renderer::State::renderSample(const Slice& slice, shared::Dispatch dispatch, const Request& request,
                                   const TraceModes& modes) {
    const auto cancelled = [&] { return request.cancelled && request.cancelled(); };
    record(KernelId::Generate, modes, dispatch, slice.groups());
    if (options.profile) submit(&KernelTimes::generate);
    const TraversalChoice choice = traversalOf(request.methods);
    LivePaths live(options.compaction, slice.paths());
    for (dispatch.bounce = 0;; ++dispatch.bounce) {
        live.writeTo(dispatch);
        const uint32_t groups = live.groups();
        times.invocations += static_cast<uint64_t>(groups) * shared::kWorkgroupSize;
        const bool packets = choice.packets && dispatch.bounce == 0;
        traceBounce(modes, dispatch, groups, packets);
        if (cancelled()) return false;
        if (!castShadows(modes, dispatch, groups, packets, cancelled)) return false;
        record(KernelId::Shade, modes, dispatch, groups);
        submit(&KernelTimes::shade);
        if (cancelled()) return false;
        const uint32_t alive = counter()[shared::kCounterAlive];
        if (alive == 0) return true;
        live.bounced(alive);
        times.pathRays += alive;
        if (modes.tally) rayCounts.mirrored += alive;
    }
}

bool Renderer::State::adapt(const Slice& slice, shared::Dispatch dispatch, const PackedSamples& samples,
                            const TraceModes& modes) {
    const bool last = dispatch.sampleIndex + 1 == samples.count();
    dispatch.lastOfRound = last || (dispatch.sampleIndex + 1) % samples.round == 0 ? 1 : 0;
    dispatch.threshold = glm::vec3(*samples.threshold);
    record(KernelId::Adapt, modes, dispatch, slice.groups());
    submit(&KernelTimes::adapt);
    return counter()[shared::kCounterFlagged] != 0;
}

bool Renderer::State::renderSlice(const Slice& slice, const Request& request, const TraceModes& modes,
                                  double progressFrom, double progressTo) {
    const PackedSamples& samples = request.samples;
    longestInSlice = 0;
    ++times.slices;
    shared::Dispatch dispatch = dispatchFor(slice);
    const uint32_t count = samples.count();
    for (uint32_t i = 0; i < count; ++i) {
        dispatch.sampleIndex = i;
        if (!modes.scattered) dispatch.sampleOffset = glm::vec3(samples.offsets[i], 0.0);
        if (!renderSample(slice, dispatch, request, modes)) return false;
        if (modes.adaptive && !adapt(slice, dispatch, samples, modes)) break;
        if (request.progress)
            request.progress(progressFrom + (progressTo - progressFrom) * (i + 1.0) / count);
    }
    return true;
}

void Renderer::State::readSlice(const Slice& slice, const TraceModes& modes, Picture& picture) {
    const Stopwatch watch;
    readFilm(paths, device, slice, modes, picture);
    if (!picture.data.empty()) readData(paths, device, slice, scene.origin, picture);
    if (modes.ledger) {
        readLosses(paths, device, slice, modes, firstTreeRow(features, modes), picture);
    }
    times.readback += watch.seconds();
}

// Aims below both bounds, and grows by at most 4: the next slice may be four times dearer a pixel than the
// last. What a picture's last, shorter slice could grow to says nothing about a whole one.
void Renderer::State::sizeNextSlice(const Slice& slice, bool whole, double seconds) {
    const double load = std::max({longestInSlice / options.sliceSeconds, seconds / kWholeSliceSeconds, 1e-6});
    const double factor = std::clamp(0.7 / load, 0.1, 4.0);
    if (!whole && factor >= 1) return;
    sliceTiles = std::clamp(static_cast<uint32_t>(slice.tileCount * factor), slice.interleave,
                            kMaxSlicePaths / shared::kWorkgroupSize);
}

void Renderer::State::traceBatch(std::span<const RayInput> rays, const LocalBatch& wanted,
                                 std::span<RayHit> hits) {
    const TraversalChoice choice = traversalOf(wanted.methods);
    const bool any = wanted.detail == HitDetail::Any, surface = wanted.detail == HitDetail::Surface;
    const TraceModes modes = {
        .aovs = surface, .cost = wanted.cost, .methods = wanted.methods, .nodes = choice.nodes};
    const uint32_t count = static_cast<uint32_t>(rays.size());
    const uint32_t groups = (count + shared::kWorkgroupSize - 1) / shared::kWorkgroupSize;
    writeRays(paths, device, features, modes, rays);
    Slice slice;
    slice.region = {0, 0, 1, 1};
    slice.tileCount = groups;
    const shared::Dispatch dispatch = dispatchFor(slice);
    const ProcessorWatch processor;
    const Stopwatch watch;
    traceRays(any ? KernelId::IntersectAny : KernelId::Intersect, modes, dispatch, groups,
              options.traversal == Traversal::Packet && choice.packets, &KernelTimes::primary);
    if (wanted.times) {
        wanted.times->wall += watch.seconds();
        wanted.times->processor += processor.seconds();
    }
    readHits(paths, device, modes, hits);
    if (!surface) return;
    record(KernelId::Shade, modes, dispatch, groups);
    submit(&KernelTimes::shade);
    const AovRows rows(paths, device, count);
    for (uint32_t i = 0; i < count; ++i) hits[i].data = rows.at(i, scene.origin);
}

Renderer::Renderer(const gpu::Device& device, const PackedScene& scene, const Options& options)
    : state_(std::make_unique<State>(device, scene, options)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;

const StageTimes& Renderer::times() const {
    return state_->times;
}
const RayCounts& Renderer::rays() const {
    return state_->rayCounts;
}
gpu::Access Renderer::access() const {
    return state_->access;
}
TraversalChoice Renderer::traversal(const Methods& methods) const {
    return state_->traversalOf(methods);
}
uint64_t Renderer::deviceBytes() const {
    return state_->buffers.bytes() + (state_->paths.capacity() ? state_->paths.buffer().size() : 0);
}

uint64_t Renderer::codeBytes() const {
    return state_->pipelines.codeBytes();
}

Picture Renderer::render(const shared::Camera& camera, const Request& request) {
    State& s = *state_;
    const bool parallel = camera.originStepX != glm::vec3(0) || camera.originStepY != glm::vec3(0);
    if (parallel && !s.features.parallelCamera)
        throw std::invalid_argument("a parallel camera, but the pipeline has no code for one");
    Picture picture = blankPicture(request);
    const size_t pixels = picture.done.size();
    if (pixels == 0) return picture;
    const PackedSamples& samples = request.samples;
    if (lightsOf(s.scene, request).size() > s.scene.lights.size())
        throw std::invalid_argument("more lights than the scene has");
    const TraversalChoice choice = s.traversalOf(request.methods);
    const TraceModes modes = modesOf(request, choice.nodes);

    const uint32_t tiles = Slice::tilesIn(picture.region);
    const uint32_t interleave = s.device.info().llvmpipe ? 16 : 1;
    const shared::Environment environment = s.environmentOf(camera, request);
    const uint32_t rows = pathRows(s.features, modes, environment.maxDepth);
    const uint32_t limit =
        fittingPaths(s.device.info(), s.access,
                     s.options.maxSlicePixels ? s.options.maxSlicePixels : kMaxSlicePaths, rows);
    const uint32_t wanted =
        std::min({tiles, limit / shared::kWorkgroupSize, s.device.info().limits.maxWorkgroupCountX});
    const uint32_t maxTiles = std::max(wanted / interleave, 1u) * interleave;
    const bool grown = s.buffers.setSamples(s.device, samples.rows, s.access);
    s.reservePaths(maxTiles * shared::kWorkgroupSize, rows, grown);
    s.buffers.setCamera(s.device, camera);
    s.setSurroundings(environment, lightsOf(s.scene, request));
    s.compile(modes, kernelsOf(s.scene, request, choice.packets));

    const uint64_t before = s.times.pathRays;
    const RayCounts counted = s.rayCounts;
    if (!modes.adaptive) s.times.pathRays += pixels * samples.count();
    for (uint32_t first = 0; first < tiles;) {
        const uint32_t sliceTiles = std::clamp(s.sliceTiles, interleave, maxTiles);
        const Slice slice = {picture.region, first, std::min(sliceTiles, tiles - first), interleave};
        const double from = static_cast<double>(first) / tiles;
        const double to = static_cast<double>(first + slice.tileCount) / tiles;
        const Stopwatch watch;
        if (!s.renderSlice(slice, request, modes, from, to)) {
            picture.complete = false;
            return picture;
        }
        s.readSlice(slice, modes, picture);
        first += slice.tileCount;
        s.sizeNextSlice(slice, slice.tileCount == sliceTiles, watch.seconds());
    }
    for (const uint32_t taken : picture.samples) s.times.pathRays += taken;
    if (modes.tally) {  // `mirrored` holds all but the camera rays so far
        s.rayCounts.primary += s.times.pathRays - before - (s.rayCounts.mirrored - counted.mirrored);
        s.rayCounts.mirrored -= s.rayCounts.refracted - counted.refracted;
    }
    return picture;
}

const PackedScene& Renderer::scene() const {
    return state_->scene;
}

std::vector<RayHit> Renderer::traceLocal(std::span<const RayInput> rays, const LocalBatch& wanted) {
    State& s = *state_;
    const TraceModes modes = {.aovs = wanted.detail == HitDetail::Surface};
    const uint32_t rows = pathRows(s.features, modes, s.environment.maxDepth);
    const uint64_t groups = (rays.size() + shared::kWorkgroupSize - 1) / shared::kWorkgroupSize;
    const auto asked = static_cast<uint32_t>(std::clamp<uint64_t>(
        groups, 1,
        std::min(kMaxSlicePaths / shared::kWorkgroupSize, s.device.info().limits.maxWorkgroupCountX)));
    const uint32_t fitting = fittingPaths(s.device.info(), s.access, asked * shared::kWorkgroupSize, rows);
    const uint32_t batch = std::max(fitting / shared::kWorkgroupSize, 1u) * shared::kWorkgroupSize;
    s.reservePaths(batch, rows);
    std::vector<RayHit> hits(rays.size());
    for (size_t first = 0; first < rays.size(); first += batch) {
        const size_t count = std::min<size_t>(batch, rays.size() - first);
        s.traceBatch(rays.subspan(first, count), wanted, std::span(hits).subspan(first, count));
    }
    return hits;
}

}  // namespace glint::render
