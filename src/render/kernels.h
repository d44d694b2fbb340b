// The embedded SPIR-V of the kernels.
#pragma once

#include <cstdint>
#include <span>

#include "bvh/packed_scene.h"
#include "gpu/compute.h"

namespace glint::render {

// One entry for each kernel; `any` is intersect.comp with any-hit rays. The last three are for packets of
// rays (shaders/packet.glsl).
struct KernelCode {
    std::span<const uint32_t> generate, intersect, intersectAny, light, shade, packetIntersect,
        packetIntersectAny, packetLight, adapt;
};

// The kernels that read arrays with `access`.
const KernelCode& embeddedKernels(gpu::Access access);

// The same, but triangles, spheres and planes are tested in double precision; for rays by themselves, not for
// packets, and for devices with DeviceLimits::float64.
const KernelCode& doubleKernels(gpu::Access access);

// The same kernels without the code of GLINT_FURTHER_FEATURES and of other methods than the default ones; and
// whether they can draw such a scene.
const KernelCode& basicKernels(gpu::Access access);
bool basicKernelsDo(const SceneFeatures& features, const Methods& methods);

// Of these the leanest that do: in double precision, or basic, or all.
const KernelCode& kernelsFor(bool doublePrecision, gpu::Access access, const SceneFeatures& features,
                             const Methods& methods);

}  // namespace glint::render
