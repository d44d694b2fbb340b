#include "render/kernels.h"

#include "adapt.spv.h"
#include "adapt_basic.spv.h"
#include "adapt_basic_texel.spv.h"
#include "adapt_texel.spv.h"
#include "generate.spv.h"
#include "generate_basic.spv.h"
#include "generate_basic_texel.spv.h"
#include "generate_texel.spv.h"
#include "intersect.spv.h"
#include "intersect_any.spv.h"
#include "intersect_any_basic.spv.h"
#include "intersect_any_basic_texel.spv.h"
#include "intersect_any_fp64.spv.h"
#include "intersect_any_fp64_texel.spv.h"
#include "intersect_any_texel.spv.h"
#include "intersect_basic.spv.h"
#include "intersect_basic_texel.spv.h"
#include "intersect_fp64.spv.h"
#include "intersect_fp64_texel.spv.h"
#include "intersect_texel.spv.h"
#include "light.spv.h"
#include "light_basic.spv.h"
#include "light_basic_texel.spv.h"
#include "light_fp64.spv.h"
#include "light_fp64_texel.spv.h"
#include "light_packet.spv.h"
#include "light_packet_basic.spv.h"
#include "light_packet_basic_texel.spv.h"
#include "light_packet_texel.spv.h"
#include "light_texel.spv.h"
#include "packet_intersect.spv.h"
#include "packet_intersect_any.spv.h"
#include "packet_intersect_any_basic.spv.h"
#include "packet_intersect_any_basic_texel.spv.h"
#include "packet_intersect_any_texel.spv.h"
#include "packet_intersect_basic.spv.h"
#include "packet_intersect_basic_texel.spv.h"
#include "packet_intersect_texel.spv.h"
#include "shade.spv.h"
#include "shade_basic.spv.h"
#include "shade_basic_texel.spv.h"
#include "shade_texel.spv.h"
#include "shared/dispatch.h"

namespace glint::render {

const KernelCode& embeddedKernels(gpu::Access access) {
    static const KernelCode storage = {
        generate_spv, intersect_spv,        intersect_any_spv,        light_spv,
        shade_spv,    packet_intersect_spv, packet_intersect_any_spv, light_packet_spv,
        adapt_spv};
    static const KernelCode texel = {generate_texel_spv,
                                     intersect_texel_spv,
                                     intersect_any_texel_spv,
                                     light_texel_spv,
                                     shade_texel_spv,
                                     packet_intersect_texel_spv,
                                     packet_intersect_any_texel_spv,
                                     light_packet_texel_spv,
                                     adapt_texel_spv};
    return access == gpu::Access::TexelBuffer ? texel : storage;
}

const KernelCode& doubleKernels(gpu::Access access) {
    const auto with = [](KernelCode code, std::span<const uint32_t> closest, std::span<const uint32_t> any,
                         std::span<const uint32_t> light) {
        code.intersect = closest;
        code.intersectAny = any;
        code.light = light;
        return code;
    };
    static const KernelCode storage = with(embeddedKernels(gpu::Access::StorageBuffer), intersect_fp64_spv,
                                           intersect_any_fp64_spv, light_fp64_spv);
    static const KernelCode texel = with(embeddedKernels(gpu::Access::TexelBuffer), intersect_fp64_texel_spv,
                                         intersect_any_fp64_texel_spv, light_fp64_texel_spv);
    return access == gpu::Access::TexelBuffer ? texel : storage;
}

const KernelCode& basicKernels(gpu::Access access) {
    static const KernelCode storage = {generate_basic_spv,
                                       intersect_basic_spv,
                                       intersect_any_basic_spv,
                                       light_basic_spv,
                                       shade_basic_spv,
                                       packet_intersect_basic_spv,
                                       packet_intersect_any_basic_spv,
                                       light_packet_basic_spv,
                                       adapt_basic_spv};
    static const KernelCode texel = {generate_basic_texel_spv,
                                     intersect_basic_texel_spv,
                                     intersect_any_basic_texel_spv,
                                     light_basic_texel_spv,
                                     shade_basic_texel_spv,
                                     packet_intersect_basic_texel_spv,
                                     packet_intersect_any_basic_texel_spv,
                                     light_packet_basic_texel_spv,
                                     adapt_basic_texel_spv};
    return access == gpu::Access::TexelBuffer ? texel : storage;
}

bool basicKernelsDo(const SceneFeatures& features, const Methods& methods) {
    bool further = false;
#define GLINT_ANY(ID, NAME, field) further |= features.field;
    GLINT_FURTHER_FEATURES(GLINT_ANY)
#undef GLINT_ANY
    return !further && methods == Methods{};
}

const KernelCode& kernelsFor(bool doublePrecision, gpu::Access access, const SceneFeatures& features,
                             const Methods& methods) {
    if (doublePrecision) return doubleKernels(access);
    return basicKernelsDo(features, methods) ? basicKernels(access) : embeddedKernels(access);
}

}  // namespace glint::render
