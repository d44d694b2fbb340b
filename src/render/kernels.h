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

// The kernels that read each array as a texel buffer with a binding of its own, or those that read all arrays
// but the samples from one storage buffer, which have no packets.
const KernelCode& embeddedKernels(gpu::Access access);

}  // namespace glint::render
