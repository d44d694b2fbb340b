// The embedded SPIR-V of the kernels (kernels.def), their modes and specialization constants.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "gpu/compute.h"
#include "pack/packed_scene.h"
#include "trace/methods.h"
#include "trace/request.h"

namespace glint::render {

enum class KernelId {
#define GLINT_KERNEL(id, module, shader, defines, name, rays) id,
#include "render/kernels.def"
#undef GLINT_KERNEL
};

#define GLINT_KERNEL(id, module, shader, defines, name, rays) KernelId::id,
inline constexpr std::array kKernels = {
#include "render/kernels.def"
};
#undef GLINT_KERNEL

// The SPIR-V of each kernel, for every scene, mode and way to load (gpu/specialize.h).
using KernelCode = std::map<KernelId, std::span<const uint32_t>>;
const KernelCode& embeddedKernels();

// A line of kernels.def.
struct KernelInfo {
    const char* name;     // in messages
    const char* module;   // of the SPIR-V file, without its extension
    uint32_t raysOfLane;  // paths that an invocation takes: several in kernels for packets
};
const KernelInfo& infoOf(KernelId id);

// The kernel that does for packets what `id` does for single rays: Intersect, IntersectAny, Light or Count;
// throws std::logic_error for others.
KernelId packetKernel(KernelId id);

// Kernel modes that a request selects: GLINT_MODES in shaders/shared/dispatch.h, and the tests of rays.
struct TraceModes {
#define GLINT_MODE_FIELD(ID, NAME, field) bool field = false;
    GLINT_MODES(GLINT_MODE_FIELD)
#undef GLINT_MODE_FIELD
    Methods methods = {};
    auto operator<=>(const TraceModes&) const = default;
};
TraceModes modesOf(const Request& request);

// Operations that shaders/arithmetic.glsl rounds in place of the device: GLINT_ARITHMETIC in
// shaders/shared/dispatch.h.
struct OwnArithmetic {
    bool quotients = false, roots = false;
};

// Values of all specialization constants by their ids. convergent: see loopsConverge (kernel_choice.h).
std::vector<uint32_t> constantsOf(const SceneFeatures& features, const TraceModes& modes, bool convergent,
                                  const OwnArithmetic& own, gpu::Access access);

}  // namespace glint::render
