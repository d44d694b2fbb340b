// State of a renderer, for the source files that implement Renderer.
#pragma once

#include <functional>
#include <future>
#include <map>
#include <set>

#include "core/stopwatch.h"
#include "pack/request_environment.h"
#include "render/kernel_choice.h"
#include "render/path_limits.h"
#include "render/path_state.h"
#include "render/pipelines.h"
#include "render/renderer.h"
#include "render/scene_buffers.h"
#include "render/trails.h"

namespace glint::render {

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
    std::map<std::pair<KernelId, TraceModes>, std::future<gpu::Kernel>> translating;  // as Options::expected
    PathState paths;
    gpu::Submission submission;
    StageTimes times;
    RayCounts rayCounts;
    std::set<std::pair<KernelId, TraceModes>> compiled;
    shared::Environment environment;    // as it is on the device
    std::vector<shared::Light> lights;  // the same
    uint32_t sliceTiles = 256;          // of the next slice, of the next picture too
    TrailRecorder* recorder = nullptr;  // of the image at hand, or null
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
          environment(packed.environment),
          lights(packed.lights) {
        options.expected = nullptr;
        if (opts.expected) {
            const TraversalChoice choice = traversalOf(opts.expected->methods);
            const TraceModes modes = modesOf(*opts.expected);
            const shared::Environment wanted = glint::environmentOf(scene, *opts.expected);
            startTranslating(modes, kernelsFor(*opts.expected, modes, choice, wanted));
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
    // Records one kernel that traces rays, submits, and goes on with unfinished rays until there are none.
    // With `packets`, it is the one for packets that starts.
    void traceRays(KernelId id, TraceModes modes, const shared::Dispatch& dispatch, uint32_t groups,
                   bool packets, double KernelTimes::*account);
    // All lights of a bounce; false if that was cancelled.
    bool castShadows(const TraceModes& modes, shared::Dispatch dispatch, uint32_t groups, bool packets,
                     const std::function<bool()>& cancelled);
    void traceBounce(const TraceModes& modes, shared::Dispatch dispatch, uint32_t groups, bool packets);
    TraversalChoice traversalOf(const Methods& methods) const;
    // Trip budget of a path in whole.comp.
    uint32_t wholeBudget(const shared::Environment& of) const;
    bool drawsWholePaths(const TraceModes& modes, const TraversalChoice& choice,
                         const shared::Environment& of) const;
    std::vector<KernelId> kernelsFor(const Request& request, const TraceModes& modes,
                                     const TraversalChoice& choice, const shared::Environment& of) const;
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
    // The same by whole.comp. `complete` becomes false if a path ran out of trips.
    bool renderWholeSample(const Slice& slice, shared::Dispatch dispatch, const Request& request,
                           const TraceModes& modes, bool& complete);
    void readSlice(const Slice& slice, const TraceModes& modes, Picture& picture);
    void sizeNextSlice(const Slice& slice, bool whole, double seconds);
    void traceBatch(std::span<const RayInput> rays, const LocalBatch& wanted, std::span<RayHit> hits);
};

}  // namespace glint::render
