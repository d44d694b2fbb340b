#include "gpu/device.h"

#include <thread>

#include "gpu_fixture.h"

namespace glint::gpu::device_test {
TEST(ListDevices, FindsTheDriversDevice) {
    const std::vector<DeviceInfo> devices = listDevices();
    ASSERT_EQ(devices.size(), 1u)
        << "the tests set VK_DRIVER_FILES to one driver alone; run them through ctest";
    const DeviceInfo& device = devices[0];
    EXPECT_EQ(device.index, 0u);
    EXPECT_FALSE(device.name.empty());
    EXPECT_FALSE(device.driver.empty());
    EXPECT_EQ(device.software, device.type == "CPU");
    EXPECT_TRUE(device.usable) << device.reason;
    EXPECT_EQ(device.reason, "has all that glint needs");
    EXPECT_EQ(device.api.substr(0, 2), "1.");
}

// Properties of lavapipe; the other tests run on any device.
TEST(Lavapipe, IsKnown) {
    const DeviceInfo lavapipe = listDevices().at(0);
    EXPECT_HAS(lavapipe.name, "llvmpipe");
    EXPECT_HAS(lavapipe.driver, "Mesa");
    EXPECT_EQ(lavapipe.type, "CPU");
    EXPECT_TRUE(lavapipe.llvmpipe);
}

TEST(Lavapipe, ArithmeticIsCorrectlyRounded) {
    const Device device;
    const Arithmetic& arithmetic = device.arithmetic();
    EXPECT_TRUE(arithmetic.sound && arithmetic.denormals && arithmetic.quotients && arithmetic.roots)
        << arithmetic.text();
}

// The minima are those that Vulkan 1.1 requires (tables "Required Limits" and "Required Limit Types").
TEST(ListDevices, TellsTheLimits) {
    const DeviceLimits limits = listDevices().at(0).limits;
    EXPECT_GE(limits.maxStorageBufferRange, uint64_t{1} << 27);
    EXPECT_GE(limits.maxTexelBufferElements, 65536u);
    EXPECT_GE(limits.maxAllocationSize, uint64_t{1} << 30);
    EXPECT_GT(limits.memory, 0u);
    EXPECT_GE(limits.maxWorkgroupInvocations, 128u);
    EXPECT_GE(limits.maxWorkgroupSizeX, 128u);
    EXPECT_GE(limits.maxWorkgroupCountX, 65535u);
    EXPECT_GE(limits.maxPushConstantBytes, 128u);
    EXPECT_GE(limits.maxStorageBuffersPerStage, 8u);
    EXPECT_GE(limits.maxStorageImagesPerStage, 8u);
    EXPECT_GE(limits.subgroupSize, 1u);
    EXPECT_GT(limits.timestampPeriod, 0.0);
}

// The other tests rely on the layer's silence, so it must report a known error here.
TEST(Validation, CollectsWhatTheLayerSays) {
    const Device device(withValidation());
    VkBufferCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
    info.size = 0;
    info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    const DeviceState& state = device.state();
    VkBuffer buffer = VK_NULL_HANDLE;
    if (state.vk.vkCreateBuffer(state.device, &info, nullptr, &buffer) == VK_SUCCESS) {
        state.vk.vkDestroyBuffer(state.device, buffer, nullptr);
    }
    ASSERT_FALSE(device.validationMessages().empty());
    EXPECT_HAS(device.validationMessages()[0], "VUID-VkBufferCreateInfo-size-00912");
}

TEST(Validation, SynchronisationIsChecked) {
    Device device(withValidation());
    const Buffer a(device, "a", 1024, Access::StorageBuffer, MemoryKind::Device);
    const Buffer b(device, "b", 1024, Access::StorageBuffer, MemoryKind::Device);
    Submission submission(device);
    DeviceState& state = device.state();
    // Without barriers the second copy overwrites what the first one may still be writing.
    const auto noBarrier = [](VkCommandBuffer, VkPipelineStageFlags, VkPipelineStageFlags, VkDependencyFlags,
                              uint32_t, const VkMemoryBarrier*, uint32_t, const VkBufferMemoryBarrier*,
                              uint32_t, const VkImageMemoryBarrier*) {};
    state.vk.vkCmdPipelineBarrier = noBarrier;
    submission.copy(a, 0, b, 0, 512);
    submission.copy(a, 512, b, 0, 512);
    ASSERT_FALSE(device.validationMessages().empty());
    EXPECT_HAS(device.validationMessages()[0], "SYNC-HAZARD-WRITE");
}

TEST(Validation, SilentWhenEverythingIsDestroyed) {
    std::shared_ptr<ValidationLog> log;
    {
        const Device device(withValidation());
        log = device.state().log;
        device.state().physical.unified = false;  // so that there is a staging buffer
        const Buffer buffer = countingBuffer(device, 16, Access::TexelBuffer);
        Kernel kernel = scaleKernel(device, buffer, {2, 0});
        Submission submission(device);
        submission.dispatch(kernel, 1, bytesOf(ScalePush{4, 0}));
        submission.submit();
        submission.dispatch(kernel, 1, bytesOf(ScalePush{4, 0}));  // recorded, never submitted
    }
    for (const std::string& message : log->messages()) ADD_FAILURE() << message;
}

void doubleOn(const Device& device, std::vector<uint32_t>& values) {
    const Buffer buffer(device, "values", values.size() * 4, Access::TexelBuffer, MemoryKind::Device);
    write(device, buffer, values);
    const uint32_t texels = static_cast<uint32_t>(values.size() / 4);
    run(device, scaleKernel(device, buffer, {2, 0}), groupsFor(texels), bytesOf(ScalePush{texels, 0}));
    values = read(device, buffer, values.size());
}

TEST_F(GpuTest, DevicesWorkSideBySide) {
    std::vector<uint32_t> here = counting(400);
    std::vector<uint32_t> there = counting(400, 1000);
    {
        const Device other;
        doubleOn(other, there);
        doubleOn(device_, here);
    }
    doubleOn(device_, here);  // the other one's end, and its instance's, does not touch this one
    for (uint32_t i = 0; i < 400; ++i) {
        ASSERT_EQ(here[i], 4 * i);
        ASSERT_EQ(there[i], 2 * (1000 + i));
    }
}

TEST(Device, OpensAndWorksInSeveralThreads) {
    constexpr uint32_t kThreads = 4;
    std::vector<std::vector<uint32_t>> values(kThreads);
    std::vector<std::thread> threads;
    for (uint32_t t = 0; t < kThreads; ++t) {
        values[t] = counting(400, 1000 * t);
        threads.emplace_back([&values, t] { doubleOn(Device(), values[t]); });
    }
    for (std::thread& thread : threads) thread.join();
    for (uint32_t t = 0; t < kThreads; ++t) {
        for (uint32_t i = 0; i < 400; ++i) ASSERT_EQ(values[t][i], 2 * (1000 * t + i));
    }
}

TEST_F(GpuTest, ArithmeticIsProbedOnce) {
    const Arithmetic& arithmetic = device_.arithmetic();
    EXPECT_EQ(&device_.arithmetic(), &arithmetic) << "asked twice";
    EXPECT_EQ(&Device().arithmetic(), &arithmetic) << "asked once more for a device of the same name";
}

}  // namespace glint::gpu::device_test
