#include "render/renderer.h"

#include <algorithm>
#include <stdexcept>

#include "core/stopwatch.h"
#include "pack/request_environment.h"
#include "render/engine.h"
#include "render/path_limits.h"

namespace glint::render {

namespace {

// All samples and bounces of a slice together: Ctrl-C loses the slice at hand.
constexpr double kWholeSliceSeconds = 2.0;

}  // namespace

struct Renderer::State : DeviceScene {
    Options options;
    bool wholePathsGivenUp = false;  // a path ran out of trips
    Engine engine;
    StageTimes times;
    RayCounts rayCounts;
    uint32_t sliceTiles = 64;   // of the next slice, also of the next image
    double longestInSlice = 0;  // longest submission of the current slice, in seconds

    // ---- The current image ----

    const Request* request = nullptr;
    TraceModes modes;
    TraversalChoice choice;
    shared::Environment environment;
    std::vector<Trail>* trails = nullptr;  // record, or null

    State(const gpu::Device& dev, const PackedScene& packed, const Options& opts)
        : DeviceScene(dev, packed, imageFeatures(packed, opts), opts), options(opts), engine(*this) {
        options.expected = nullptr;
        if (opts.expected) {
            begin(*opts.expected, environmentOf(scene, *opts.expected));
            engine.start(modes, kernels());
        }
        const Stopwatch watch;
        upload();
        times.upload += watch.seconds();
    }

    void begin(const Request& wanted, const shared::Environment& its) {
        request = &wanted;
        modes = modesOf(wanted);
        choice = traversalOf(wanted.methods, wanted.cost);
        environment = its;
    }

    bool cancelled() const { return request->cancelled && request->cancelled(); }

    // cost: rays count their tests.
    TraversalChoice traversalOf(const Methods& methods, bool cost) const {
        if (cost) return {false, "packets do not count their tests"};
        if (methods == Methods{}) return traversal;
        return chooseTraversal(options.traversal, device.info(), scene, methods);
    }

    // Trips of a path in whole.comp.
    uint32_t wholeTrips() const {
        return wholeTripBudget(device.info(), features, scene.polygonTripsPerLeaf, environment);
    }

    // Auto excludes what whole.comp lacks: times of each step, packets, and the caller's kernels.
    bool drawsWholePaths() const {
        if (options.wholePaths == WholePaths::Off || wholePathsGivenUp || !wholePathsSupport(modes))
            return false;
        if (options.wholePaths == WholePaths::On) return true;
        const bool free = options.traversal != Traversal::Packet && !options.profile && !options.kernels;
        const WholePathsWork work = {.furtherRays = goesOnAfterHits(scene.features, environment),
                                     .tripBudget = wholeTrips(),
                                     .rays = options.cameraRays * (1 + uint64_t{environment.lightCount})};
        return free && wholePathsPay(device.info(), choice, work);
    }

    std::vector<KernelId> kernels() const {
        std::vector<KernelId> kernels = drawsWholePaths() ? std::vector{KernelId::Whole}
                                                          : kernelsOfSteps(scene, *request, choice.packets);
        if (modes.adaptive) kernels.push_back(KernelId::Adapt);
        return kernels;
    }

    void compile() {
        const Stopwatch watch;
        engine.compile(modes, kernels());
        times.compile += watch.seconds();
    }

    // ---- Kernels ----

    void record(KernelId id, const shared::Dispatch& dispatch, uint32_t groups) {
        engine.record(id, modes, dispatch, groups);
    }

    // Adds the time to that kernel's account.
    void submit(double KernelTimes::*account) {
        const gpu::Submission::Times t = engine.submit();
        times.trace += t.wall;
        times.device += t.device;
        times.kernels.*account += t.device > 0 ? t.device : t.wall;
        rayCounts.shadow += engine.counter(shared::kCounterShadow);
        rayCounts.refracted += engine.counter(shared::kCounterRefracted);
        times.longestSubmission = std::max(times.longestSubmission, t.wall);
        longestInSlice = std::max(longestInSlice, t.wall);
        ++times.submissions;
    }

    // Camera rays and their shadow rays start in packets if these were chosen.
    void traceRays(KernelId id, const shared::Dispatch& dispatch, uint32_t groups,
                   double KernelTimes::*account) {
        const bool packets = choice.packets && dispatch.bounce == 0;
        times.resumes += engine.trace(id, modes, dispatch, groups, packets, [&] { submit(account); });
    }

    void traceBounce(shared::Dispatch dispatch, uint32_t groups) {
        if (dispatch.bounce == 0) {
            traceRays(KernelId::Intersect, dispatch, groups, &KernelTimes::primary);
        } else if (modes.tally && features.transmission) {
            dispatch.rayClass = shared::kRayMirrored;
            traceRays(KernelId::Intersect, dispatch, groups, &KernelTimes::mirrored);
            dispatch.rayClass = shared::kRayRefracted;
            traceRays(KernelId::Intersect, dispatch, groups, &KernelTimes::refracted);
        } else {
            traceRays(KernelId::Intersect, dispatch, groups, &KernelTimes::secondary);
        }
    }

    // All lights of a bounce; false if that was cancelled.
    bool castShadows(shared::Dispatch dispatch, uint32_t groups) {
        const uint32_t atOnce = lightsAtOnce(tripBudget, environment.planeCount);
        for (uint32_t first = 0; first < environment.lightCount; first = dispatch.lightEnd) {
            dispatch.lightIndex = first;
            dispatch.lightEnd = std::min(first + atOnce, environment.lightCount);
            traceRays(KernelId::Light, dispatch, groups, &KernelTimes::shadow);
            if (cancelled()) return false;
        }
        return true;
    }

    // ---- Samples and slices; false if the image was cancelled ----

    bool renderSample(const Slice& slice, shared::Dispatch dispatch) {
        record(KernelId::Generate, dispatch, slice.groups());
        if (options.profile) submit(&KernelTimes::generate);
        uint32_t running = slice.paths();  // invocations that have a path, alive or not
        for (dispatch.bounce = 0;; ++dispatch.bounce) {
            const uint32_t groups = (running + shared::kWorkgroupSize - 1) / shared::kWorkgroupSize;
            times.invocations += static_cast<uint64_t>(groups) * shared::kWorkgroupSize;
            traceBounce(dispatch, groups);
            if (cancelled()) return false;
            if (trails) addRays(engine.paths(), slice, *trails);
            if (!castShadows(dispatch, groups)) return false;
            record(KernelId::Shade, dispatch, groups);
            submit(&KernelTimes::shade);
            if (cancelled()) return false;
            const uint32_t alive = engine.counter(shared::kCounterAlive);
            if (alive == 0) return true;
            if (alive < running) {  // continue with the list of live paths that `shade` wrote
                dispatch.listed = running = alive;
                dispatch.listRead ^= 1u;
            }
            times.pathRays += alive;
            if (modes.tally) rayCounts.mirrored += alive;
        }
    }

    // The same by whole.comp. `complete` becomes false if a path ran out of trips.
    bool renderWholeSample(const Slice& slice, shared::Dispatch dispatch, bool& complete) {
        dispatch.tripBudget = options.tripBudget ? options.tripBudget : wholeTrips();
        dispatch.mostFollowed = mostRaysAfterFirst(features, environment);
        times.invocations += slice.paths();
        record(KernelId::Whole, dispatch, slice.groups());
        submit(&KernelTimes::whole);
        times.pathRays += engine.counter(shared::kCounterAlive);
        complete = engine.counter(shared::kCounterUnfinished) == 0;
        return !cancelled();
    }

    // After a sample of an adaptive image; false if no pixel goes on.
    bool adapt(const Slice& slice, shared::Dispatch dispatch) {
        const PackedSamples& samples = request->samples;
        const bool last = dispatch.sampleIndex + 1 == samples.count();
        dispatch.lastOfRound = last || (dispatch.sampleIndex + 1) % samples.round == 0 ? 1 : 0;
        dispatch.threshold = glm::vec3(*samples.threshold);
        record(KernelId::Adapt, dispatch, slice.groups());
        submit(&KernelTimes::adapt);
        return engine.counter(shared::kCounterFlagged) != 0;
    }

    bool renderSlice(const Slice& slice, double progressFrom, double progressTo) {
        const PackedSamples& samples = request->samples;
        longestInSlice = 0;
        ++times.slices;
        shared::Dispatch dispatch = engine.dispatchOf(slice);
        const uint32_t count = samples.count();
        bool whole = drawsWholePaths();
        const uint64_t raysBefore = times.pathRays, invocationsBefore = times.invocations;
        uint32_t reported = 0;
        for (uint32_t i = 0; i < count;) {
            dispatch.sampleIndex = i;
            if (!modes.scattered) dispatch.sampleOffset = glm::vec3(samples.offsets[i], 0.0);
            bool complete = true;
            if (!(whole ? renderWholeSample(slice, dispatch, complete) : renderSample(slice, dispatch)))
                return false;
            if (!complete) {
                // From the first sample on: the sum so far has what the path did not finish.
                whole = false;
                wholePathsGivenUp = true;
                times.pathRays = raysBefore;
                times.invocations = invocationsBefore;
                compile();
                i = 0;
                continue;
            }
            if (modes.adaptive && !adapt(slice, dispatch)) break;
            reported = std::max(reported, ++i);
            if (request->progress)
                request->progress(progressFrom + (progressTo - progressFrom) * reported / count);
        }
        return true;
    }

    void readSlice(const Slice& slice, Picture& picture) {
        const Stopwatch watch;
        readFilm(engine.paths(), slice, modes, picture);
        if (!picture.data.empty()) readData(engine.paths(), slice, scene.origin, picture);
        if (modes.ledger) readLosses(engine.paths(), slice, modes, firstTreeRow(features, modes), picture);
        times.readback += watch.seconds();
    }

    // Aims below both bounds, and grows by at most 4: a pixel of the next slice may cost four times as much
    // as in this slice. Ignores an image's last slice, which is shorter.
    void sizeNextSlice(const Slice& slice, bool whole, double seconds) {
        const double load =
            std::max({longestInSlice / options.sliceSeconds, seconds / kWholeSliceSeconds, 1e-6});
        const double factor = std::clamp(0.7 / load, 0.1, 4.0);
        if (!whole && factor >= 1) return;
        sliceTiles = std::clamp(static_cast<uint32_t>(slice.tileCount * factor), slice.interleave,
                                kMaxSlicePaths / shared::kWorkgroupSize);
    }

    Picture render(const Request& wanted) {
        const shared::Camera camera = cameraOf(scene, wanted);
        const bool parallel = camera.originStepX != glm::vec3(0) || camera.originStepY != glm::vec3(0);
        if (parallel && !features.parallelCamera)
            throw std::invalid_argument("a parallel camera, but the pipeline has no code for one");
        Picture picture = blankPicture(wanted);
        const size_t pixels = picture.done.size();
        if (trails) trails->assign(pixels, {});
        if (pixels == 0) return picture;
        if (lightsOf(scene, wanted).size() > scene.lights.size())
            throw std::invalid_argument("more lights than the scene has");
        begin(wanted, cameraEnvironment(scene, wanted));
        if (wanted.wantsLosses()) environment.radianceBound = radianceBoundOf(scene, wanted);

        const uint32_t tiles = Slice::tilesIn(picture.region);
        const uint32_t interleave = interleaveOf(device.info());
        const uint32_t rows = pathRows(features, modes, environment);
        const uint32_t paths =
            slicePaths(device.info(), access, rows, picture.region, options.maxSlicePixels);
        const bool grown = buffers.setSamples(wanted.samples.rows);
        engine.reserve(paths, rows, grown);
        buffers.setView(camera, environment, lightsOf(scene, wanted));
        compile();

        const uint64_t before = times.pathRays;
        const RayCounts counted = rayCounts;
        if (!modes.adaptive) times.pathRays += pixels * wanted.samples.count();
        for (uint32_t first = 0; first < tiles;) {
            const uint32_t most = std::clamp(sliceTiles, interleave, paths / shared::kWorkgroupSize);
            const Slice slice = {picture.region, first, std::min(most, tiles - first), interleave};
            first = slice.firstTile + slice.tileCount;
            const double from = static_cast<double>(slice.firstTile) / tiles;
            const double to = static_cast<double>(first) / tiles;
            const Stopwatch watch;
            if (!renderSlice(slice, from, to)) {
                picture.complete = false;
                return picture;
            }
            readSlice(slice, picture);
            sizeNextSlice(slice, slice.tileCount == most, watch.seconds());
        }
        for (const uint32_t taken : picture.samples) times.pathRays += taken;
        if (modes.tally) {  // `mirrored` holds all but the camera rays so far
            rayCounts.primary += times.pathRays - before - (rayCounts.mirrored - counted.mirrored);
            rayCounts.mirrored -= rayCounts.refracted - counted.refracted;
        }
        return picture;
    }
};

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
    return state_->buffers.bytes() + state_->engine.paths().rows() * state_->engine.paths().rowBytes();
}
uint64_t Renderer::codeBytes() const {
    return state_->engine.codeBytes();
}

Picture Renderer::render(const Request& request, std::vector<Trail>* trails) {
    state_->trails = trails;
    return state_->render(request);
}

PixelData Renderer::pixel(Request request, int x, int y) {
    request.region = {x, y, x + 1, y + 1};
    request.samples = PackedSamples::fixed({{0.5, 0.5}});
    request.data = true;
    return render(request).data[0];
}

}  // namespace glint::render
