#include "loop_limit.h"

#include <algorithm>

#include "gpu/compute.h"
#include "loop_probe.spv.h"

namespace glint::render::test {

bool endsLoops(const gpu::Device& device) {
    constexpr uint32_t kTrips = 100'000, kLanes = 64;
    const gpu::Buffer buffer(device, "words", 3 * kLanes * sizeof(uint32_t), gpu::Access::StorageBuffer,
                             gpu::MemoryKind::Host);
    auto* const words = static_cast<uint32_t*>(buffer.mapped());
    for (uint32_t i = 0; i < kLanes; ++i) words[i] = (i + 1) % kLanes;
    gpu::KernelOptions options;
    options.name = "loop_probe";
    options.spirv = loop_probe_spv;
    options.bindings = {gpu::Access::StorageBuffer};
    gpu::Kernel kernel(device, options);
    const gpu::Buffer* const bound[] = {&buffer};
    kernel.bind(bound);
    gpu::Submission submission(device);
    submission.dispatch(kernel, 1, {});
    submission.submit();
    return *std::min_element(words + kLanes, words + 2 * kLanes) < kTrips;
}

}  // namespace glint::render::test
