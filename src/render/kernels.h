// The embedded SPIR-V of the kernels.
#pragma once

#include <cstdint>
#include <span>

#include "gpu/compute.h"
#include "pack/packed_scene.h"

namespace glint::render {

// One entry for each kernel; `any` is intersect.comp with any-hit rays. `packet...` are for packets
// of rays (shaders/packet.glsl), `list` is count.comp that writes down what it counts.
struct KernelCode {
    std::span<const uint32_t> generate, intersect, intersectAny, light, shade, packetIntersect,
        packetIntersectAny, packetLight, adapt, count, list, whole, packetCount, certify, packetCertify;
};

// How kernels are given the arrays: each by a binding of its own, or all but the samples in one storage
// buffer, for devices that bind fewer than there are.
enum class Arrays { Apart, Together };

// The kernels that read arrays with `access`, each by itself.
const KernelCode& embeddedKernels(gpu::Access access);

// The kernels that find the arrays together, without those for packets.
const KernelCode& togetherKernels();

}  // namespace glint::render
