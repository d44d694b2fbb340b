#include "render/engine.h"

#include <algorithm>

#include "core/parallel.h"
#include "render/path_limits.h"

namespace glint::render {

namespace {

uint32_t bindingsOf(gpu::Access access) {
    return access == gpu::Access::StorageBuffer ? GLINT_FEW_BINDINGS : GLINT_BINDING_COUNT;
}

}  // namespace

SceneFeatures imageFeatures(const PackedScene& scene, const Options& options) {
    if (!options.leaveOut) return allFeatures();
    SceneFeatures features = scene.features;
#define GLINT_EITHER(ID, NAME, field) features.field |= options.also.field;
    GLINT_FEATURES(GLINT_EITHER)
#undef GLINT_EITHER
    return features;
}

DeviceScene::DeviceScene(const gpu::Device& dev, const PackedScene& packed, const SceneFeatures& known,
                         const Options& options)
    : device(dev),
      scene(packed),
      code(options.kernels ? *options.kernels : embeddedKernels()),
      features(known),
      access(options.access ? *options.access : chooseAccess(dev.info(), arraySizes(packed))),
      traversal(chooseTraversal(options.traversal, dev.info(), packed)),
      tripBudget(options.tripBudget ? options.tripBudget
                                    : deriveTripBudget(dev.info(), features, packed.polygonTripsPerLeaf)),
      own{options.ownArithmetic || !dev.arithmetic().quotients,
          options.ownArithmetic || !dev.arithmetic().roots} {}

Engine::Engine(const DeviceScene& scene, gpu::MemoryKind memory)
    : scene_(scene),
      memory_(memory),
      counters_(scene.device, "counters", shared::kCounterCount * sizeof(uint32_t),
                gpu::Access::StorageBuffer, gpu::MemoryKind::Host),
      submission_(scene.device) {}

std::vector<const gpu::Buffer*> Engine::bindings() const {
    std::vector<const gpu::Buffer*> buffers = {&counters_, &paths_.buffer()};
    for (uint32_t binding = 2; binding < bindingsOf(scene_.access); ++binding)
        buffers.push_back(&scene_.buffers.at(binding));
    return buffers;
}

void Engine::reserve(uint32_t capacity, uint32_t rows, bool rebind) {
    if (paths_.capacity() < capacity || paths_.rows() < rows) {
        const uint32_t newCapacity = std::max(capacity, paths_.capacity());
        const uint32_t newRows = std::max(rows, paths_.rows());
        paths_ = PathState();  // frees its memory first
        paths_ = PathState(scene_.device, scene_.access, newCapacity, newRows, memory_);
        rebind = true;
    }
    if (!rebind) return;
    for (auto& [key, entry] : kernels_)
        if (entry.kernel) entry.kernel.bind(bindings());
}

const gpu::Kernel& Engine::kernel(KernelId id, const TraceModes& modes) {
    Entry& entry = kernels_[{id, modes}];
    if (!entry.kernel) {
        entry.kernel = entry.translation.valid() ? entry.translation.get() : make(id, modes);
        entry.kernel.bind(bindings());
    }
    return entry.kernel;
}

uint64_t Engine::codeBytes() const {
    uint64_t bytes = 0;
    for (const auto& [key, entry] : kernels_) bytes += entry.kernel ? entry.kernel.codeBytes() : 0;
    return bytes;
}

void Engine::start(const TraceModes& modes, const std::vector<KernelId>& ids) {
    for (const KernelId id : ids) {
        Entry& entry = kernels_[{id, modes}];
        if (entry.kernel || entry.translation.valid()) continue;
        entry.translation = std::async(std::launch::async | std::launch::deferred,
                                       [this, id, modes] { return make(id, modes); });
    }
}

// Each kernel has a thread: drivers translate SPIR-V on the caller's, and lavapipe then makes machine code of
// one kernel after the other on a thread of its own (docs/lab/speed.md).
void Engine::compile(const TraceModes& modes, const std::vector<KernelId>& ids) {
    start(modes, ids);
    std::vector<Entry*> missing;
    for (const KernelId id : ids)
        if (Entry& entry = kernels_[{id, modes}]; !entry.kernel) missing.push_back(&entry);
    if (missing.empty()) return;
    paths_.writeEnded();
    shared::Dispatch dispatch = dispatchOf({.region = {0, 0, 1, 1}});
    dispatch.capacity = shared::kWorkgroupSize;
    parallelFor({.threads = static_cast<unsigned>(missing.size())}, missing.size(), [&](size_t i) {
        gpu::Kernel kernel = missing[i]->translation.get();
        kernel.bind(bindings());
        gpu::Submission first(scene_.device);
        first.dispatch(kernel, 1, gpu::bytesOf(dispatch));
        first.submit();
        missing[i]->kernel = kernel;
    });
}

gpu::Kernel Engine::make(KernelId id, const TraceModes& modes) const {
    gpu::KernelOptions options;
    options.name = infoOf(id).name;
    options.spirv = scene_.code.at(id);
    options.bindings.assign(bindingsOf(scene_.access), scene_.access);
    options.bindings[0] = gpu::Access::StorageBuffer;
    const bool convergent = !modes.resume && loopsConverge(scene_.device.info());
    options.constants = constantsOf(scene_.features, modes, convergent, scene_.own, scene_.access);
    options.pushConstantBytes = sizeof(shared::Dispatch);
    return gpu::Kernel(scene_.device, options);
}

shared::Dispatch Engine::dispatchOf(const Slice& slice) const {
    shared::Dispatch dispatch;
    dispatch.firstTile = slice.firstTile;
    dispatch.tileCount = slice.tileCount;
    dispatch.interleave = slice.interleave;
    dispatch.run = slice.run();
    dispatch.regionX = static_cast<uint32_t>(slice.region.x0);
    dispatch.regionY = static_cast<uint32_t>(slice.region.y0);
    dispatch.regionWidth = static_cast<uint32_t>(slice.region.width());
    dispatch.regionHeight = static_cast<uint32_t>(slice.region.height());
    dispatch.capacity = paths_.capacity();
    dispatch.tripBudget = scene_.tripBudget;
    dispatch.tripsOfPass = tripsOfPass(scene_.features);
    return dispatch;
}

void Engine::record(KernelId id, const TraceModes& modes, const shared::Dispatch& dispatch, uint32_t groups) {
    const uint32_t perLane = infoOf(id).raysOfLane;
    submission_.dispatch(kernel(id, modes), (groups + perLane - 1) / perLane, gpu::bytesOf(dispatch));
}

gpu::Submission::Times Engine::submit() {
    std::fill_n(static_cast<uint32_t*>(counters_.mapped()), shared::kCounterCount, 0u);
    return submission_.submit();
}

}  // namespace glint::render
