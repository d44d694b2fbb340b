#include "render/renderer.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "core/stopwatch.h"
#include "pack/request_environment.h"
#include "render/film.h"
#include "render/path_limits.h"
#include "render/path_state.h"
#include "render/pipelines.h"
#include "render/scene_buffers.h"

namespace glint::render {

namespace {

// All samples and bounces of a slice together: Ctrl-C loses the slice at hand.
constexpr double kWholeSliceSeconds = 2.0;

}  // namespace

struct Renderer::State {
    const gpu::Device& device;
    const PackedScene& scene;
    Options options;
    SceneFeatures features;  // of the pipelines
    gpu::Access access;
    TraversalChoice traversal;  // with the default methods, which have the most to choose from
    uint32_t tripBudget;
    bool wholePathsGivenUp = false;  // one ran out of trips
    SceneBuffers buffers;
    gpu::Buffer counters;
    Pipelines pipelines;
    PathState paths;
    gpu::Submission submission;
    StageTimes times;
    RayCounts rayCounts;
    shared::Environment environment;       // of the picture at hand
    uint32_t sliceTiles = 64;              // of the next slice, of the next picture too
    std::vector<Trail>* trails = nullptr;  // record of the image at hand, or null
    // Longest submission of the current slice, in seconds.
    double longestInSlice = 0;

    State(const gpu::Device& dev, const PackedScene& packed, const Options& opts)
        : device(dev),
          scene(packed),
          options(opts),
          features(opts.leaveOut ? either(packed.features, opts.also) : allFeatures()),
          access(opts.access ? *opts.access : chooseAccess(dev.info(), arraySizes(packed))),
          traversal(chooseTraversal(opts.traversal, dev.info(), packed)),
          tripBudget(opts.tripBudget ? opts.tripBudget
                                     : deriveTripBudget(dev.info(), features, packed.polygonTripsPerLeaf)),
          pipelines(dev, opts.kernels ? *opts.kernels : embeddedKernels(), access, features,
                    opts.ownArithmetic),
          submission(dev),
          environment(packed.environment) {
        options.expected = nullptr;
        if (opts.expected) {
            const TraversalChoice choice = traversalOf(opts.expected->methods, opts.expected->cost);
            const TraceModes modes = modesOf(*opts.expected);
            const shared::Environment wanted = glint::environmentOf(scene, *opts.expected);
            pipelines.start(modes, kernelsFor(*opts.expected, modes, choice, wanted));
        }
        const Stopwatch watch;
        buffers = SceneBuffers(device, scene, access, traversal);
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
    // Records one kernel that traces rays, submits, and continues unfinished rays until all have ended.
    // With `packets`, it is the one for packets that starts.
    void traceRays(KernelId id, TraceModes modes, const shared::Dispatch& dispatch, uint32_t groups,
                   bool packets, double KernelTimes::*account);
    // All lights of a bounce; false if that was cancelled.
    bool castShadows(const TraceModes& modes, shared::Dispatch dispatch, uint32_t groups, bool packets,
                     const std::function<bool()>& cancelled);
    void traceBounce(const TraceModes& modes, shared::Dispatch dispatch, uint32_t groups, bool packets);
    // cost: rays count their tests.
    TraversalChoice traversalOf(const Methods& methods, bool cost) const;
    // Trip budget of a path in whole.comp.
    uint32_t wholeBudget(const shared::Environment& of) const;
    bool drawsWholePaths(const TraceModes& modes, const TraversalChoice& choice,
                         const shared::Environment& of) const;
    std::vector<KernelId> kernelsFor(const Request& request, const TraceModes& modes,
                                     const TraversalChoice& choice, const shared::Environment& of) const;
    void compile(const TraceModes& modes, const std::vector<KernelId>& ids);
    shared::Environment environmentOf(const shared::Camera& camera, const Request& request) const;
    bool renderSlice(const Slice& slice, const Request& request, const TraceModes& modes, double progressFrom,
                     double progressTo);
    // After a sample of an adaptive picture; false if no pixel goes on.
    bool adapt(const Slice& slice, shared::Dispatch dispatch, const PackedSamples& samples,
               const TraceModes& modes);
    bool renderSample(const Slice& slice, shared::Dispatch dispatch, const Request& request,
                      const TraceModes& modes);
    // The same by whole.comp. `complete` becomes false if a path ran out of trips.
    bool renderWholeSample(const Slice& slice, shared::Dispatch dispatch, const Request& request,
                           const TraceModes& modes, bool& complete);
    void readSlice(const Slice& slice, const TraceModes& modes, Picture& picture);
    void sizeNextSlice(const Slice& slice, bool whole, double seconds);
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

TraversalChoice Renderer::State::traversalOf(const Methods& methods, bool cost) const {
    if (cost) return {false, "packets do not count their tests"};
    if (methods == Methods{}) return traversal;
    return chooseTraversal(options.traversal, device.info(), scene, methods);
}

uint32_t Renderer::State::wholeBudget(const shared::Environment& of) const {
    return options.tripBudget ? options.tripBudget
                              : wholeTripBudget(device.info(), features, scene.polygonTripsPerLeaf, of);
}

// Auto excludes what whole.comp lacks: times of each step, packets, and the caller's kernels.
bool Renderer::State::drawsWholePaths(const TraceModes& modes, const TraversalChoice& choice,
                                      const shared::Environment& of) const {
    if (options.wholePaths == WholePaths::Off || wholePathsGivenUp || !wholePathsKnow(modes)) return false;
    if (options.wholePaths == WholePaths::On) return true;
    const bool free = options.traversal != Traversal::Packet && !options.profile && !options.kernels;
    const WholePathsWork work = {
        .furtherRays = goesOnAfterHits(scene.features, of),
        .tripBudget = wholeTripBudget(device.info(), features, scene.polygonTripsPerLeaf, of),
        .rays = options.cameraRays * (1 + uint64_t{of.lightCount})};
    return free && wholePathsPay(device.info(), choice, work);
}

std::vector<KernelId> Renderer::State::kernelsFor(const Request& request, const TraceModes& modes,
                                                  const TraversalChoice& choice,
                                                  const shared::Environment& of) const {
    return drawsWholePaths(modes, choice, of) ? wholeKernelsOf(request)
                                              : kernelsOf(scene, request, choice.packets);
}

void Renderer::State::compile(const TraceModes& modes, const std::vector<KernelId>& ids) {
    const std::vector<KernelId> missing = pipelines.missing(modes, ids);
    if (missing.empty()) return;
    const Stopwatch watch;
    Slice nothing;
    nothing.region = {0, 0, 1, 1};
    shared::Dispatch dispatch = dispatchFor(nothing);
    // Kernels run in any order, so no path may be alive; they read the path's rows even so.
    dispatch.capacity = shared::kWorkgroupSize;
    paths.writeEnded(device);
    pipelines.compile(modes, missing, dispatch);
    times.compile += watch.seconds();
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
        const uint32_t perLane = infoOf(packetKernel(id)).raysOfLane;
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
    const uint32_t atOnce = lightsAtOnce(tripBudget, environment.planeCount);
    for (uint32_t first = 0; first < environment.lightCount; first = dispatch.lightEnd) {
        dispatch.lightIndex = first;
        dispatch.lightEnd = std::min(first + atOnce, environment.lightCount);
        traceRays(KernelId::Light, modes, dispatch, groups, packets, &KernelTimes::shadow);
        if (cancelled()) return false;
    }
    return true;
}

bool Renderer::State::renderSample(const Slice& slice, shared::Dispatch dispatch, const Request& request,
                                   const TraceModes& modes) {
    const auto cancelled = [&] { return request.cancelled && request.cancelled(); };
    record(KernelId::Generate, modes, dispatch, slice.groups());
    if (options.profile) submit(&KernelTimes::generate);
    const TraversalChoice choice = traversalOf(request.methods, request.cost);
    LivePaths live(slice.paths());
    for (dispatch.bounce = 0;; ++dispatch.bounce) {
        live.writeTo(dispatch);
        const uint32_t groups = live.groups();
        times.invocations += static_cast<uint64_t>(groups) * shared::kWorkgroupSize;
        const bool packets = choice.packets && dispatch.bounce == 0;
        traceBounce(modes, dispatch, groups, packets);
        if (cancelled()) return false;
        if (trails) addRays(paths, device, slice, *trails);
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

bool Renderer::State::renderWholeSample(const Slice& slice, shared::Dispatch dispatch, const Request& request,
                                        const TraceModes& modes, bool& complete) {
    dispatch.tripBudget = wholeBudget(environment);
    dispatch.bounce = mostRaysAfterFirst(features, environment);
    times.invocations += slice.paths();
    record(KernelId::Whole, modes, dispatch, slice.groups());
    submit(&KernelTimes::whole);
    times.pathRays += counter()[shared::kCounterAlive];
    complete = counter()[shared::kCounterUnfinished] == 0;
    return !(request.cancelled && request.cancelled());
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
    const TraversalChoice choice = traversalOf(request.methods, request.cost);
    bool whole = drawsWholePaths(modes, choice, environment);
    const uint64_t raysBefore = times.pathRays, invocationsBefore = times.invocations;
    uint32_t reported = 0;
    for (uint32_t i = 0; i < count;) {
        dispatch.sampleIndex = i;
        if (!modes.scattered) dispatch.sampleOffset = glm::vec3(samples.offsets[i], 0.0);
        bool complete = true;
        if (!(whole ? renderWholeSample(slice, dispatch, request, modes, complete)
                    : renderSample(slice, dispatch, request, modes)))
            return false;
        if (!complete) {
            // From the first sample on: the sum so far has what the path did not finish.
            whole = false;
            wholePathsGivenUp = true;
            times.pathRays = raysBefore;
            times.invocations = invocationsBefore;
            compile(modes, kernelsOf(scene, request, choice.packets));
            i = 0;
            continue;
        }
        if (modes.adaptive && !adapt(slice, dispatch, samples, modes)) break;
        reported = std::max(reported, ++i);
        if (request.progress) request.progress(progressFrom + (progressTo - progressFrom) * reported / count);
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

// Aims below both bounds, and grows by at most 4: a pixel of the next slice may cost four times as much as in
// this slice. Ignores an image's last slice, which is shorter.
void Renderer::State::sizeNextSlice(const Slice& slice, bool whole, double seconds) {
    const double load = std::max({longestInSlice / options.sliceSeconds, seconds / kWholeSliceSeconds, 1e-6});
    const double factor = std::clamp(0.7 / load, 0.1, 4.0);
    if (!whole && factor >= 1) return;
    sliceTiles = std::clamp(static_cast<uint32_t>(slice.tileCount * factor), slice.interleave,
                            kMaxSlicePaths / shared::kWorkgroupSize);
}

Renderer::Renderer(const gpu::Device& device, const PackedScene& scene, const Options& options)
    : state_(std::make_shared<State>(device, scene, options)) {}

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
    return state_->traversalOf(methods, false);
}
uint64_t Renderer::deviceBytes() const {
    return state_->buffers.bytes() + (state_->paths.capacity() ? state_->paths.buffer().size() : 0);
}

uint64_t Renderer::codeBytes() const {
    return state_->pipelines.codeBytes();
}

Picture Renderer::render(const shared::Camera& camera, const Request& request, std::vector<Trail>* trails) {
    State& s = *state_;
    const bool parallel = camera.originStepX != glm::vec3(0) || camera.originStepY != glm::vec3(0);
    if (parallel && !s.features.parallelCamera)
        throw std::invalid_argument("a parallel camera, but the pipeline has no code for one");
    Picture picture = blankPicture(request);
    const size_t pixels = picture.done.size();
    s.trails = trails;
    if (trails) trails->assign(pixels, {});
    if (pixels == 0) return picture;
    const PackedSamples& samples = request.samples;
    if (lightsOf(s.scene, request).size() > s.scene.lights.size())
        throw std::invalid_argument("more lights than the scene has");
    const TraversalChoice choice = s.traversalOf(request.methods, request.cost);
    const TraceModes modes = modesOf(request);

    const uint32_t tiles = Slice::tilesIn(picture.region);
    const uint32_t interleave = interleaveOf(s.device.info());
    const shared::Environment environment = s.environmentOf(camera, request);
    const PathRoom room = roomFor(s.device.info(), s.access, s.features, modes, environment, picture.region,
                                  s.options.maxSlicePixels);
    const uint32_t maxTiles = room.paths / shared::kWorkgroupSize;
    const bool grown = s.buffers.setSamples(s.device, samples.rows);
    s.reservePaths(room.paths, room.rows, grown);
    s.buffers.setCamera(s.device, camera);
    s.environment = environment;
    s.buffers.setEnvironment(s.device, environment);
    s.buffers.setLights(s.device, lightsOf(s.scene, request));
    s.compile(modes, s.kernelsFor(request, modes, choice, environment));

    const uint64_t before = s.times.pathRays;
    const RayCounts counted = s.rayCounts;
    if (!modes.adaptive) s.times.pathRays += pixels * samples.count();
    for (uint32_t first = 0; first < tiles;) {
        const uint32_t sliceTiles = std::clamp(s.sliceTiles, interleave, maxTiles);
        const Slice slice = {picture.region, first, std::min(sliceTiles, tiles - first), interleave};
        first = slice.firstTile + slice.tileCount;
        const double from = static_cast<double>(slice.firstTile) / tiles;
        const double to = static_cast<double>(first) / tiles;
        const Stopwatch watch;
        if (!s.renderSlice(slice, request, modes, from, to)) {
            picture.complete = false;
            return picture;
        }
        s.readSlice(slice, modes, picture);
        s.sizeNextSlice(slice, slice.tileCount == sliceTiles, watch.seconds());
    }
    for (const uint32_t taken : picture.samples) s.times.pathRays += taken;
    if (modes.tally) {  // `mirrored` holds all but the camera rays so far
        s.rayCounts.primary += s.times.pathRays - before - (s.rayCounts.mirrored - counted.mirrored);
        s.rayCounts.mirrored -= s.rayCounts.refracted - counted.refracted;
    }
    return picture;
}

PixelData Renderer::pixel(const shared::Camera& camera, Request request, int x, int y) {
    request.region = {x, y, x + 1, y + 1};
    request.samples = PackedSamples::fixed({{0.5, 0.5}});
    request.data = true;
    return render(camera, request).data[0];
}

}  // namespace glint::render
