#include "empty.spv.h"
#include "gpu_fixture.h"
#include "reverse.spv.h"
#include "scale.spv.h"
#include "scale_texel.spv.h"
#include "twists.spv.h"

namespace glint::gpu {

Kernel scaleKernel(const Device& device, Access access, std::vector<uint32_t> constants) {
    const bool texels = access == Access::TexelBuffer;
    return Kernel(device, {.name = "scale",
                           .spirv = texels ? std::span<const uint32_t>(scale_texel_spv) : scale_spv,
                           .bindings = {access},
                           .constants = std::move(constants),
                           .pushConstantBytes = sizeof(ScalePush)});
}

Kernel scaleKernel(const Device& device, const Buffer& buffer, std::vector<uint32_t> constants) {
    Kernel kernel = scaleKernel(device, buffer.state().access, std::move(constants));
    const Buffer* const buffers[] = {&buffer};
    kernel.bind(buffers);
    return kernel;
}

Kernel reverseKernel(const Device& device) {
    return Kernel(device, {.name = "reverse",
                           .spirv = reverse_spv,
                           .bindings = {Access::TexelBuffer, Access::StorageBuffer},
                           .pushConstantBytes = sizeof(uint32_t)});
}

Kernel twistsKernel(const Device& device) {
    return Kernel(device, {.name = "twists", .spirv = twists_spv, .bindings = {Access::StorageBuffer}});
}

Kernel emptyKernel(const Device& device) {
    return Kernel(device, {.name = "empty", .spirv = empty_spv});
}

}  // namespace glint::gpu
