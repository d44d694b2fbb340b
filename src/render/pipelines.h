// The pipelines of one scene, each made when first used.
#pragma once

#include <future>
#include <map>
#include <utility>
#include <vector>

#include "gpu/compute.h"
#include "pack/packed_scene.h"
#include "render/kernels.h"
#include "render/scene_buffers.h"

namespace glint::render {

// Features that at least one of the two has.
SceneFeatures either(SceneFeatures features, const SceneFeatures& also);

// Operations that shaders/arithmetic.glsl rounds in place of the device: GLINT_ARITHMETIC in
// shaders/shared/dispatch.h.
struct OwnArithmetic {
    bool quotients = false, roots = false;
};

// Values of all specialization constants by their ids: every feature, no mode.
std::vector<uint32_t> defaultConstants(gpu::Access access);

class Pipelines {
  public:
    // ownArithmetic: all of OwnArithmetic; else what the device does not round correctly.
    Pipelines(const gpu::Device& device, const KernelCode& code, gpu::Access access,
              const SceneFeatures& features, bool ownArithmetic = false);

    // Buffers that every kernel sees. Existing kernels are bound again.
    void bind(const gpu::Buffer& counters, const gpu::Buffer& paths, const SceneBuffers& scene);
    const gpu::Kernel& get(KernelId id, const TraceModes& modes);

    // Translates kernels on other threads, for compile(), unless that has begun. Do not move the pipelines
    // from then on.
    void start(const TraceModes& modes, const std::vector<KernelId>& ids);
    // Those of the kernels that are not made yet.
    std::vector<KernelId> missing(const TraceModes& modes, const std::vector<KernelId>& ids) const;
    // Makes kernels and runs each once, by `dispatch`, which must find no live path.
    void compile(const TraceModes& modes, const std::vector<KernelId>& ids, const shared::Dispatch& dispatch);

    // SPIR-V of the kernels made so far.
    uint64_t codeBytes() const;

  private:
    // From any thread, at any time; not bound.
    gpu::Kernel make(KernelId id, const TraceModes& modes) const;

    const gpu::Device& device_;
    const KernelCode& code_;
    gpu::Access access_;
    SceneFeatures features_;
    OwnArithmetic own_;
    std::vector<const gpu::Buffer*> buffers_;
    std::map<std::pair<KernelId, TraceModes>, gpu::Kernel> kernels_;
    std::map<std::pair<KernelId, TraceModes>, std::future<gpu::Kernel>> translating_;
};

}  // namespace glint::render
