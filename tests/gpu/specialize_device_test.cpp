// A kernel without calls and variables does what its source says: the source is C++ too.
#include <glm/vec3.hpp>

#include "gpu_fixture.h"

namespace glint::gpu::specialize_device_test {
using uint = uint32_t;
using glm::uvec3;
#define GLINT_INOUT(T) T&
#include "twists.h"

using SpecializeDevice = GpuTest;

TEST_F(SpecializeDevice, CallsStructuresAndLoopsComputeTheSame) {
    constexpr uint32_t kSeeds = 500;
    const Buffer buffer(device_, "values", kSeeds * 4, Access::StorageBuffer, MemoryKind::Device);
    write(device_, buffer, counting(kSeeds));
    const Buffer* const buffers[] = {&buffer};
    Kernel kernel = twistsKernel(device_);
    kernel.bind(buffers);
    Submission submission(device_);
    submission.dispatch(kernel, kSeeds, {});
    submission.submit();
    const std::vector<uint32_t> values = read(device_, buffer, kSeeds);
    for (uint32_t seed = 0; seed < kSeeds; ++seed) ASSERT_EQ(values[seed], twisted(seed)) << seed;
}

}  // namespace glint::gpu::specialize_device_test
