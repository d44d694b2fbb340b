// The ray engine of images and ray queries: the kernels of a scene, the state of the paths that they trace,
// and the loop that resumes unfinished rays.
#pragma once

#include <future>
#include <map>
#include <utility>
#include <vector>

#include "render/kernels.h"
#include "render/options.h"
#include "render/path_state.h"
#include "render/scene_buffers.h"

namespace glint::render {

// Features that the kernels of images have code for.
SceneFeatures imageFeatures(const PackedScene& scene, const Options& options);

// A packed scene on a device: the choices that both decide, and the scene's arrays.
struct DeviceScene {
    const gpu::Device& device;
    const PackedScene& scene;
    const KernelCode& code;
    SceneFeatures features;  // that the kernels have code for
    gpu::Access access;
    TraversalChoice traversal;  // with the default methods, which have the most to choose from
    uint32_t tripBudget;        // loop trips of a ray in one dispatch
    OwnArithmetic own;
    SceneBuffers buffers;  // empty before upload()

    // Keeps references to device, scene and Options::kernels. Throws as chooseTraversal.
    DeviceScene(const gpu::Device& device, const PackedScene& scene, const SceneFeatures& features,
                const Options& options);
    DeviceScene(const DeviceScene&) = delete;  // an engine keeps a reference
    DeviceScene& operator=(const DeviceScene&) = delete;
    // Throws Error(Device) for arrays that do not fit.
    void upload() { buffers = SceneBuffers(device, scene, access, traversal); }
};

class Engine {
  public:
    // Keeps a reference to the scene, which must be uploaded before any call but start(). memory: of the path
    // state.
    explicit Engine(const DeviceScene& scene, gpu::MemoryKind memory = gpu::MemoryKind::Device);
    Engine(const Engine&) = delete;  // translations on other threads use it
    Engine& operator=(const Engine&) = delete;

    const PathState& paths() const { return paths_; }
    // Makes room for `capacity` paths of `rows` rows. rebind: a buffer of the scene has been replaced.
    void reserve(uint32_t capacity, uint32_t rows, bool rebind = false);

    // Translates kernels on other threads, for compile() and kernel().
    void start(const TraceModes& modes, const std::vector<KernelId>& ids);
    // Makes the missing kernels and runs each once, on paths that have ended: some drivers compile in the
    // first dispatch. Overwrites the path state.
    void compile(const TraceModes& modes, const std::vector<KernelId>& ids);
    const gpu::Kernel& kernel(KernelId id, const TraceModes& modes);
    uint64_t codeBytes() const;  // SPIR-V of the kernels made so far

    shared::Dispatch dispatchOf(const Slice& slice) const;
    // Records a dispatch over `groups` workgroups of paths.
    void record(KernelId id, const TraceModes& modes, const shared::Dispatch& dispatch, uint32_t groups);
    gpu::Submission& submission() { return submission_; }
    // Clears the counters, submits and waits.
    gpu::Submission::Times submit();
    uint32_t counter(uint32_t which) const { return static_cast<const uint32_t*>(counters_.mapped())[which]; }

    // Traces a ray of each path by the kernel `id`, or at first by that for packets, then resumes unfinished
    // rays until all have ended. `submitRecorded` is called after each dispatch and must call submit().
    // Returns the number of resume dispatches.
    template <typename Submit>
    uint32_t trace(KernelId id, TraceModes modes, const shared::Dispatch& dispatch, uint32_t groups,
                   bool packets, const Submit& submitRecorded) {
        record(packets ? packetKernel(id) : id, modes, dispatch, groups);
        submitRecorded();
        modes.resume = true;
        uint32_t resumes = 0;
        for (; counter(shared::kCounterUnfinished) != 0; ++resumes) {
            record(id, modes, dispatch, groups);
            submitRecorded();
        }
        return resumes;
    }

  private:
    // A kernel, or its translation on another thread, or neither.
    struct Entry {
        std::future<gpu::Kernel> translation;
        gpu::Kernel kernel;
    };

    gpu::Kernel make(KernelId id, const TraceModes& modes) const;  // unbound; callable from any thread
    std::vector<const gpu::Buffer*> bindings() const;

    const DeviceScene& scene_;
    gpu::MemoryKind memory_;
    gpu::Buffer counters_;
    PathState paths_;
    gpu::Submission submission_;
    std::map<std::pair<KernelId, TraceModes>, Entry> kernels_;
};

}  // namespace glint::render
