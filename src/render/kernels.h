// The embedded SPIR-V of the kernels (kernels.def), and their modes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

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
class KernelCode {
  public:
    std::span<const uint32_t>& operator[](KernelId id) { return code_[static_cast<size_t>(id)]; }
    std::span<const uint32_t> operator[](KernelId id) const { return code_[static_cast<size_t>(id)]; }

  private:
    std::array<std::span<const uint32_t>, kKernels.size()> code_;
};

const KernelCode& embeddedKernels();

const char* nameOf(KernelId id);
// The name of the kernel's SPIR-V file, without its extension.
const char* moduleOf(KernelId id);

// The kernel that does for packets what `id` does for single rays.
KernelId packetKernel(KernelId id);
// Paths that an invocation of the kernel takes: more than one of those for packets.
uint32_t raysOfLane(KernelId id);

// Kernel modes that a request selects: GLINT_MODES in shaders/shared/dispatch.h, and the tests of rays.
struct TraceModes {
    bool aovs = false, cost = false, resume = false, shadowless = false, ledger = false;
    bool scattered = false, adaptive = false, tally = false, given = false;
    bool list = false, leaves = false;
    Methods methods = {};
    auto operator<=>(const TraceModes&) const = default;
};
TraceModes modesOf(const Request& request);

}  // namespace glint::render
