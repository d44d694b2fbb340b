#include <glm/vec3.hpp>

#include "gpu_fixture.h"

namespace glint::gpu::kernel_test {
class KernelTest : public GpuTest, public testing::WithParamInterface<Access> {
  protected:
    // What `kernel` makes of 0, 1, 2, ... with this push constant.
    std::vector<uint32_t> madeBy(Kernel& kernel, ScalePush push, size_t values) {
        const Buffer buffer = countingBuffer(device_, values, GetParam());
        const Buffer* const buffers[] = {&buffer};
        kernel.bind(buffers);
        run(device_, kernel, groupsFor(push.count), bytesOf(push));
        return read(device_, buffer, values);
    }
};

INSTANTIATE_TEST_SUITE_P(All, KernelTest, testing::Values(Access::StorageBuffer, Access::TexelBuffer),
                         accessName);

TEST_P(KernelTest, SpecializationConstantsFollowTheirIds) {
    // FACTOR and ADDS; left out, the shader's own 1 and false stand.
    Kernel triple = scaleKernel(device_, GetParam(), {3});
    Kernel both = scaleKernel(device_, GetParam(), {5, 1});
    Kernel defaults = scaleKernel(device_, GetParam(), {});
    const std::vector<uint32_t> tripled = madeBy(triple, {16, 1000}, 64);
    const std::vector<uint32_t> sums = madeBy(both, {16, 1000}, 64);
    const std::vector<uint32_t> same = madeBy(defaults, {16, 1000}, 64);
    for (uint32_t i = 0; i < 64; ++i) {
        ASSERT_EQ(tripled[i], 3 * i);
        ASSERT_EQ(sums[i], 5 * i + 1000);
        ASSERT_EQ(same[i], i);
    }
}

TEST_P(KernelTest, PushConstantsChangeFromDispatchToDispatch) {
    const Buffer buffer = countingBuffer(device_, 64, GetParam());
    Kernel kernel = scaleKernel(device_, buffer, {1, 1});
    Submission submission(device_);
    submission.dispatch(kernel, 1, bytesOf(ScalePush{16, 100}));  // all
    submission.dispatch(kernel, 1, bytesOf(ScalePush{4, 1000}));  // the first 4 texels
    submission.submit();
    const std::vector<uint32_t> values = read(device_, buffer, 64);
    for (uint32_t i = 0; i < 64; ++i) ASSERT_EQ(values[i], i + (i < 16 ? 1100 : 100));
}

TEST_P(KernelTest, RebindingMovesItToAnotherBuffer) {
    Kernel kernel = scaleKernel(device_, GetParam(), {2});
    const std::vector<uint32_t> first = madeBy(kernel, {4, 0}, 16);
    const std::vector<uint32_t> second = madeBy(kernel, {2, 0}, 16);  // another buffer; the first one is gone
    for (uint32_t i = 0; i < 16; ++i) {
        ASSERT_EQ(first[i], 2 * i);
        ASSERT_EQ(second[i], i < 8 ? 2 * i : i);
    }
}

class OneKernelTest : public GpuTest {};

// A kernel that was compiled before is not compiled again; one that differs in anything is.
TEST_F(OneKernelTest, SharesItsProgram) {
    const Kernel first = emptyKernel(device_);
    const Kernel again = emptyKernel(device_);
    EXPECT_EQ(first.state().program, again.state().program);
    KernelOptions options;
    options.spirv = first.state().program->key.spirv;
    options.constants = {1};
    EXPECT_NE(Kernel(device_, options).state().program, first.state().program);
    options.constants = {};
    EXPECT_EQ(Kernel(device_, options).state().program, first.state().program);
    for (uint32_t i = 2; i < 2 + DeviceState::kKeptPrograms; ++i) {
        options.constants = {i};
        const Kernel other(device_, options);
    }
    EXPECT_EQ(device_.state().programs.size(), DeviceState::kKeptPrograms);
    options.constants = {};
    EXPECT_NE(Kernel(device_, options).state().program, first.state().program);  // dropped since
}

TEST_F(OneKernelTest, CompilesAgainWhereProgramsAreNotKept) {
    const Device device(DeviceOptions{.keepPrograms = false});
    const Kernel first = emptyKernel(device);
    EXPECT_NE(first.state().program, emptyKernel(device).state().program);
}

// The source of this kernel, GLSL without its calls and variables, is C++ too.
namespace twists {
using uint = uint32_t;
using glm::uvec3;
#define GLINT_INOUT(T) T&
#include "twists.h"
}  // namespace twists

TEST_F(OneKernelTest, CallsStructuresAndLoopsComputeTheSame) {
    constexpr uint32_t kSeeds = 500;
    const Buffer buffer = countingBuffer(device_, kSeeds);
    const Buffer* const buffers[] = {&buffer};
    Kernel kernel = twistsKernel(device_);
    kernel.bind(buffers);
    run(device_, kernel, kSeeds);
    const std::vector<uint32_t> values = read(device_, buffer, kSeeds);
    for (uint32_t seed = 0; seed < kSeeds; ++seed) ASSERT_EQ(values[seed], twists::twisted(seed)) << seed;
}

}  // namespace glint::gpu::kernel_test
