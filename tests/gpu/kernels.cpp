#include "empty.spv.h"
#include "gpu_fixture.h"
#include "reverse.spv.h"
#include "scale.spv.h"
#include "scale_texel.spv.h"
#include "twists.spv.h"

namespace glint::gpu {

Kernel scaleKernel(const Device& device, Access access, std::vector<uint32_t> constants) {
    KernelOptions options;
    options.name = "scale";
    if (access == Access::StorageBuffer) {
        options.spirv = scale_spv;
    } else {
        options.spirv = scale_texel_spv;
    }
    options.bindings = {access};
    options.constants = std::move(constants);
    options.pushConstantBytes = sizeof(ScalePush);
    return Kernel(device, options);
}

Kernel scaleKernel(const Device& device, const Buffer& buffer, std::vector<uint32_t> constants) {
    Kernel kernel = scaleKernel(device, buffer.access(), std::move(constants));
    const Buffer* const buffers[] = {&buffer};
    kernel.bind(buffers);
    return kernel;
}

Kernel reverseKernel(const Device& device) {
    KernelOptions options;
    options.name = "reverse";
    options.spirv = reverse_spv;
    options.bindings = {Access::TexelBuffer, Access::StorageBuffer};
    options.pushConstantBytes = sizeof(ReversePush);
    return Kernel(device, options);
}

Kernel twistsKernel(const Device& device) {
    KernelOptions options;
    options.name = "twists";
    options.spirv = twists_spv;
    options.bindings = {Access::StorageBuffer};
    return Kernel(device, options);
}

Kernel emptyKernel(const Device& device) {
    KernelOptions options;
    options.name = "empty";
    options.spirv = empty_spv;
    return Kernel(device, options);
}

}  // namespace glint::gpu
