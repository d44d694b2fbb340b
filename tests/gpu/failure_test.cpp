// Failures of Vulkan calls, made by putting others in their place in the device's function table.

#include "gpu_fixture.h"

namespace glint::gpu::failure_test {
class FailureTest : public GpuTest {
  protected:
    DeviceState& state() { return device_.state(); }
};

TEST_F(FailureTest, OutOfDeviceMemoryNamesTheArray) {
    state().vk.vkAllocateMemory = [](VkDevice, const VkMemoryAllocateInfo*, const VkAllocationCallbacks*,
                                     VkDeviceMemory*) { return VK_ERROR_OUT_OF_DEVICE_MEMORY; };
    EXPECT_EQ(errorOf([&] { Buffer(device_, "nodes", 4096, Access::TexelBuffer, MemoryKind::Device); }),
              "array \"nodes\" needs 4096 bytes, but vkAllocateMemory failed: VK_ERROR_OUT_OF_DEVICE_MEMORY "
              "(out of device memory)");
}

TEST_F(FailureTest, AKernelThatDoesNotCompileIsNamed) {
    state().vk.vkCreateComputePipelines = [](VkDevice, VkPipelineCache, uint32_t,
                                             const VkComputePipelineCreateInfo*, const VkAllocationCallbacks*,
                                             VkPipeline*) { return VK_ERROR_INVALID_SHADER_NV; };
    EXPECT_EQ(errorOf([&] { emptyKernel(device_); }),
              "kernel \"empty\": vkCreateComputePipelines failed: VK_ERROR_INVALID_SHADER_NV (the shader "
              "does not compile)");
}

TEST_F(FailureTest, ALostDeviceIsNamed) {
    state().vk.vkQueueSubmit = [](VkQueue, uint32_t, const VkSubmitInfo*, VkFence) {
        return VK_ERROR_DEVICE_LOST;
    };
    EXPECT_EQ(errorOf([&] { run(device_, emptyKernel(device_), 1); }),
              "vkQueueSubmit failed: VK_ERROR_DEVICE_LOST (the device was reset, or its driver crashed)");
}

TEST_F(FailureTest, ASubmissionWorksAgainAfterAFailure) {
    const Kernel kernel = emptyKernel(device_);
    Submission submission(device_);
    const PFN_vkQueueSubmit real = state().vk.vkQueueSubmit;
    state().vk.vkQueueSubmit = [](VkQueue, uint32_t, const VkSubmitInfo*, VkFence) {
        return VK_ERROR_OUT_OF_HOST_MEMORY;
    };
    submission.dispatch(kernel, 1, {});
    EXPECT_EQ(errorOf([&] { submission.submit(); }),
              "vkQueueSubmit failed: VK_ERROR_OUT_OF_HOST_MEMORY (out of host memory)");
    state().vk.vkQueueSubmit = real;
    submission.dispatch(kernel, 1, {});
    EXPECT_GT(submission.submit().wall, 0.0);
}

TEST_F(FailureTest, AnUnknownResultIsANumber) {
    state().vk.vkCreateFence = [](VkDevice, const VkFenceCreateInfo*, const VkAllocationCallbacks*,
                                  VkFence*) { return static_cast<VkResult>(-12345); };
    EXPECT_EQ(errorOf([&] { Submission submission(device_); }), "vkCreateFence failed: VkResult -12345");
}

bool timesOut = false;
uint64_t waited = 0;  // nanoseconds
PFN_vkWaitForFences realWait;
VkResult waitOrTimeOut(VkDevice device, uint32_t count, const VkFence* fences, VkBool32 all,
                       uint64_t nanoseconds) {
    waited = nanoseconds;
    return timesOut ? VK_TIMEOUT : realWait(device, count, fences, all, nanoseconds);
}

class HangTest : public FailureTest {
  protected:
    // The error of submitting a batch, or "no error".
    std::string errorOfBatch(bool software, bool hangs) {
        const Kernel kernel = emptyKernel(device_);
        Submission submission(device_);
        submission.dispatch(kernel, 1, {});
        realWait = state().vk.vkWaitForFences;
        state().vk.vkWaitForFences = waitOrTimeOut;
        state().physical.info.software = software;
        timesOut = hangs;
        std::string error = errorOf([&] { submission.submit(); });
        EXPECT_EQ(state().abandoned, hangs);
        // The batch does finish, so that this test can clean up.
        state().vk.vkWaitForFences = realWait;
        state().vk.vkDeviceWaitIdle(state().device);
        state().abandoned = false;
        return error;
    }
};

// On a busy machine minutes may pass before a software device has had the processor for a second.
TEST_F(HangTest, IsReportedAfterAMinuteAndOfASoftwareDeviceAfterTen) {
    for (const bool software : {false, true}) {
        const uint64_t seconds = software ? 600 : 60;
        EXPECT_EQ(errorOfBatch(software, false), "no error");
        EXPECT_EQ(errorOfBatch(software, true), "the device \"" + device_.info().name +
                                                    "\" hangs: a batch of work has not finished after " +
                                                    std::to_string(seconds) + " s");
        EXPECT_EQ(waited, seconds * 1'000'000'000);
    }
}

// Destroying what a hung device uses is undefined, and the driver may wait for it for ever. The device and
// its instance outlive the Device, so that this test can destroy them after all.
TEST(Hang, AHungDeviceIsNotDestroyed) {
    static int destroyed;
    destroyed = 0;
    VolkDeviceTable real{};
    VkDevice device = VK_NULL_HANDLE;
    VkPipelineCache cache = VK_NULL_HANDLE;
    {
        const Device hung;
        DeviceState& state = hung.state();
        real = state.vk;
        device = state.device;
        cache = state.pipelineCache.get();
        state.vk.vkDestroyDevice = [](VkDevice, const VkAllocationCallbacks*) { ++destroyed; };
        state.abandoned = true;
    }
    EXPECT_EQ(destroyed, 0);
    real.vkDestroyPipelineCache(device, cache, nullptr);
    real.vkDestroyDevice(device, nullptr);
}

// A 36-bit counter (Intel) of 83.333 ns a tick that wraps: from 2^36 - 10 to 5 are 15 ticks.
TEST_F(FailureTest, TimestampsMayWrap) {
    state().physical.timestampBits = 36;
    state().physical.info.limits.timestampPeriod = 83.333;
    state().vk.vkGetQueryPoolResults = [](VkDevice, VkQueryPool, uint32_t, uint32_t count, size_t bytes,
                                          void* data, VkDeviceSize stride, VkQueryResultFlags) {
        EXPECT_EQ(count, 2u);
        EXPECT_EQ(bytes, 16u);
        EXPECT_EQ(stride, 8u);
        const uint64_t ticks[2] = {(uint64_t{1} << 36) - 10, 5};
        std::memcpy(data, ticks, sizeof(ticks));
        return VK_SUCCESS;
    };
    EXPECT_NEAR(run(device_, emptyKernel(device_), 1).device, 15 * 83.333e-9, 1e-15);
}

}  // namespace glint::gpu::failure_test
