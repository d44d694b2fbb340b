// Which kernels a renderer draws by, and their translation.
#include "core/parallel.h"
#include "render/renderer_state.h"
#include "render/whole_paths.h"

namespace glint::render {

TraversalChoice Renderer::State::traversalOf(const Methods& methods) const {
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
        .furtherRays = goesOnAfterHits(scene.features) && of.maxDepth > 0,
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
// after the other on a thread of its own (docs/lab/speed.md).
void Renderer::State::compile(const TraceModes& modes, const std::vector<KernelId>& ids) {
    std::vector<KernelId> fresh;
    for (KernelId id : ids) {
        if (compiled.insert({id, modes}).second) fresh.push_back(id);
    }
    if (fresh.empty()) return;
    const Stopwatch watch;
    Slice nothing;
    nothing.region = {0, 0, 1, 1};
    shared::Dispatch dispatch = dispatchFor(nothing);
    // They run in any order, so no path may be alive; and they read what is in its rows even so.
    dispatch.capacity = shared::kWorkgroupSize;
    paths.writeEnded(device);
    std::vector<gpu::Kernel> kernels(fresh.size());
    parallelFor({.threads = static_cast<unsigned>(fresh.size())}, fresh.size(), [&](size_t i) {
        kernels[i] = translated(fresh[i], modes);
        gpu::Submission first(device);
        first.dispatch(kernels[i], 1, std::as_bytes(std::span<const shared::Dispatch, 1>(&dispatch, 1)));
        first.submit();
    });
    for (size_t i = 0; i < fresh.size(); ++i) pipelines.add(fresh[i], modes, std::move(kernels[i]));
    times.compile += watch.seconds();
}

}  // namespace glint::render
