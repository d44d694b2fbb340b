#include "render/kernels.h"

#include "adapt.spv.h"
#include "adapt_together.spv.h"
#include "certify.spv.h"
#include "certify_together.spv.h"
#include "count.spv.h"
#include "count_list.spv.h"
#include "count_list_together.spv.h"
#include "count_together.spv.h"
#include "generate.spv.h"
#include "generate_together.spv.h"
#include "intersect.spv.h"
#include "intersect_any.spv.h"
#include "intersect_any_together.spv.h"
#include "intersect_together.spv.h"
#include "light.spv.h"
#include "light_packet.spv.h"
#include "light_together.spv.h"
#include "packet_certify.spv.h"
#include "packet_count.spv.h"
#include "packet_intersect.spv.h"
#include "packet_intersect_any.spv.h"
#include "shade.spv.h"
#include "shade_together.spv.h"
#include "shared/dispatch.h"
#include "whole.spv.h"
#include "whole_together.spv.h"

namespace glint::render {

const KernelCode& embeddedKernels(gpu::Access access) {
    static const KernelCode texel = {generate_spv,
                                     intersect_spv,
                                     intersect_any_spv,
                                     light_spv,
                                     shade_spv,
                                     packet_intersect_spv,
                                     packet_intersect_any_spv,
                                     light_packet_spv,
                                     adapt_spv,
                                     count_spv,
                                     count_list_spv,
                                     whole_spv,
                                     packet_count_spv,
                                     certify_spv,
                                     packet_certify_spv};
    static const KernelCode together = {generate_together_spv,
                                        intersect_together_spv,
                                        intersect_any_together_spv,
                                        light_together_spv,
                                        shade_together_spv,
                                        {},
                                        {},
                                        {},
                                        adapt_together_spv,
                                        count_together_spv,
                                        count_list_together_spv,
                                        whole_together_spv,
                                        {},
                                        certify_together_spv,
                                        {}};
    return access == gpu::Access::TexelBuffer ? texel : together;
}

}  // namespace glint::render
