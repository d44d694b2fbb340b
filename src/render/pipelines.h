// The pipelines of one scene, each made when first used.
#pragma once

#include <map>
#include <tuple>

#include "gpu/compute.h"
#include "pack/packed_scene.h"
#include "render/kernels.h"
#include "render/scene_buffers.h"
#include "render/traversal_choice.h"
#include "trace/request.h"

namespace glint::render {

// Kernel modes that a request selects: GLINT_MODES in shaders/shared/dispatch.h, and the tests of rays.
struct TraceModes {
    bool aovs = false, cost = false, resume = false, shadowless = false, ledger = false;
    bool scattered = false, adaptive = false, tally = false, given = false;
    bool list = false, leaves = false;
    Methods methods = {};
    auto operator<=>(const TraceModes&) const = default;
};
TraceModes modesOf(const Request& request);

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

    // Buffers that every kernel sees. Kernels made so far are bound anew.
    void bind(const gpu::Buffer& counters, const gpu::Buffer& paths, const SceneBuffers& scene);
    const gpu::Kernel& get(KernelId id, const TraceModes& modes);

    // A kernel that `add` may keep for `get`, once it is bound. From any thread, at any time.
    gpu::Kernel make(KernelId id, const TraceModes& modes) const;
    void bindTo(gpu::Kernel& kernel) const { kernel.bind(buffers_); }
    void add(KernelId id, const TraceModes& modes, gpu::Kernel kernel);

    // SPIR-V of the kernels made so far.
    uint64_t codeBytes() const;

  private:
    const gpu::Device& device_;
    const KernelCode& code_;
    gpu::Access access_;
    SceneFeatures features_;
    OwnArithmetic own_;
    std::vector<const gpu::Buffer*> buffers_;
    std::map<std::pair<KernelId, TraceModes>, gpu::Kernel> kernels_;
};

}  // namespace glint::render
