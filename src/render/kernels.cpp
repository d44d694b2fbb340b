#include "render/kernels.h"

#include "adapt.spv.h"
#include "adapt_texel.spv.h"
#include "generate.spv.h"
#include "generate_texel.spv.h"
#include "intersect.spv.h"
#include "intersect_any.spv.h"
#include "intersect_any_texel.spv.h"
#include "intersect_texel.spv.h"
#include "light.spv.h"
#include "light_packet.spv.h"
#include "light_packet_texel.spv.h"
#include "light_texel.spv.h"
#include "packet_intersect.spv.h"
#include "packet_intersect_any.spv.h"
#include "packet_intersect_any_texel.spv.h"
#include "packet_intersect_texel.spv.h"
#include "shade.spv.h"
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

}  // namespace glint::render
