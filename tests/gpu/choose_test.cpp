// Which device, queue family and memory are taken.
#include <gtest/gtest.h>

#include "core/error.h"
#include "gpu/device_state.h"
#include "support/environment.h"

namespace glint::gpu::choose_test {

// Which device a selector means, and what is said of the others; on lists made up here.

DeviceInfo made(uint32_t index, const std::string& name, const std::string& type,
                const std::string& refused = "") {
    DeviceInfo device;
    device.index = index;
    device.name = name;
    device.type = type;
    device.usable = refused.empty();
    device.reason = refused.empty() ? "has all that glint needs" : refused;
    return device;
}

std::string errorOf(const std::vector<DeviceInfo>& devices, const std::string& selector) {
    try {
        return "chose " + chooseDevice(devices, selector).name;
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::Device);
        return error.what();
    }
}

const std::vector<DeviceInfo> kDesktop = {
    made(0, "llvmpipe (LLVM 15.0.6, 256 bits)", "CPU"),
    made(1, "Intel(R) UHD Graphics 630", "integrated GPU"),
    made(2, "NVIDIA GeForce RTX 3060", "discrete GPU"),
    made(3, "NVIDIA GeForce GT 1030", "discrete GPU"),
    made(4, "Old Card", "discrete GPU", "knows Vulkan 1.0 only, glint needs 1.1"),
};

TEST(ChooseDevice, FollowsTheWholeOrderOfTypes) {
    const std::vector<std::string> order = {"discrete GPU", "integrated GPU", "virtual GPU", "other", "CPU"};
    for (size_t i = 0; i < order.size(); ++i) {
        for (size_t j = i + 1; j < order.size(); ++j) {
            EXPECT_EQ(chooseDevice({made(0, "a", order[j]), made(1, "b", order[i])}, "").index, 1u)
                << order[i] << " before " << order[j];
        }
    }
}

TEST(ChooseDevice, TakesANumberAsTheIndex) {
    EXPECT_EQ(chooseDevice(kDesktop, "0").index, 0u);
    EXPECT_EQ(chooseDevice(kDesktop, "3").index, 3u);
}

TEST(ChooseDevice, TakesPartOfTheNameInAnyCase) {
    EXPECT_EQ(chooseDevice(kDesktop, "LLVMPIPE").index, 0u);
    EXPECT_EQ(chooseDevice(kDesktop, "gt 1030").index, 3u);
    EXPECT_EQ(chooseDevice(kDesktop, "uhd").index, 1u);
}

TEST(ChooseDevice, OfSeveralMatchesTheBest) {
    EXPECT_EQ(chooseDevice(kDesktop, "nvidia").index, 2u);
}

TEST(ChooseDevice, OfAMatchingRefusedAndAMatchingUsableOneTheUsable) {
    EXPECT_EQ(
        chooseDevice({made(0, "card A", "discrete GPU", "has no compute queue"), made(1, "card B", "CPU")},
                     "card")
            .index,
        1u);
}

TEST(ChooseDevice, AnEmptyListNamesThePackageOrTheVariable) {
    const glint::test::ScopedEnvironment files("VK_DRIVER_FILES", nullptr);
    {
        const glint::test::ScopedEnvironment names("VK_ICD_FILENAMES", "x.json");
        EXPECT_EQ(errorOf({}, ""),
                  "no Vulkan device found: VK_ICD_FILENAMES is \"x.json\"; unset it, or name a driver's "
                  ".json file");
    }
    const glint::test::ScopedEnvironment names("VK_ICD_FILENAMES", nullptr);
    EXPECT_EQ(errorOf({}, ""), "no Vulkan device found: install a driver such as mesa-vulkan-drivers");
    EXPECT_EQ(errorOf({}, "nvidia"), errorOf({}, ""));
}

TEST(ChooseDevice, WithoutAUsableOneSaysWhyForEach) {
    EXPECT_EQ(errorOf({made(0, "A", "CPU", "has no compute queue"),
                       made(1, "B", "discrete GPU", "knows Vulkan 1.0 only, glint needs 1.1")},
                      ""),
              "no usable Vulkan device: 0 \"A\" has no compute queue; 1 \"B\" knows Vulkan 1.0 only, glint "
              "needs 1.1");
}

TEST(ChooseDevice, AnUnknownNameListsWhatThereIs) {
    EXPECT_EQ(errorOf({made(0, "A", "CPU"), made(1, "B", "discrete GPU")}, "radeon"),
              "no Vulkan device has \"radeon\" in its name; devices: 0 \"A\", 1 \"B\"");
}

TEST(ChooseDevice, AnUnknownIndexListsWhatThereIs) {
    EXPECT_EQ(errorOf({made(0, "A", "CPU")}, "1"), "no Vulkan device has index 1; devices: 0 \"A\"");
    // More digits than any integer holds, and whose low 64 bits are 0.
    EXPECT_EQ(errorOf({made(0, "A", "CPU")}, "18446744073709551616"),
              "no Vulkan device has index 18446744073709551616; devices: 0 \"A\"");
}

TEST(ChooseDevice, ARefusedSelectionSaysWhy) {
    EXPECT_EQ(errorOf(kDesktop, "4"),
              "device 4 cannot be used: 4 \"Old Card\" knows Vulkan 1.0 only, glint needs 1.1");
    EXPECT_EQ(errorOf(kDesktop, "old"),
              "device old cannot be used: 4 \"Old Card\" knows Vulkan 1.0 only, glint needs 1.1");
}

// What Vulkan 1.1 guarantees of every device (table "Required Limits"), except for the bindings, where it
// guarantees 4.
DeviceLimits sufficientLimits() {
    DeviceLimits limits;
    limits.maxTexelBufferElements = 65536;
    limits.maxWorkgroupInvocations = 128;
    limits.maxWorkgroupSizeX = 128;
    limits.maxPushConstantBytes = 128;
    limits.maxStorageBuffersPerStage = 25;
    limits.maxStorageImagesPerStage = 25;
    return limits;
}

TEST(Refusal, NamesWhatIsMissing) {
    EXPECT_EQ(refusal(VK_MAKE_API_VERSION(0, 1, 0, 255), true, sufficientLimits()),
              "knows Vulkan 1.0 only, glint needs 1.1");
    EXPECT_EQ(refusal(VK_API_VERSION_1_3, false, sufficientLimits()), "has no compute queue");
    const auto refusalWith = [](uint32_t DeviceLimits::*limit, uint32_t value) {
        DeviceLimits limits = sufficientLimits();
        limits.*limit = value;
        return refusal(VK_API_VERSION_1_1, true, limits);
    };
    EXPECT_EQ(refusalWith(&DeviceLimits::maxWorkgroupInvocations, 63),
              "runs workgroups of at most 63 invocations, glint needs 64");
    EXPECT_EQ(refusalWith(&DeviceLimits::maxWorkgroupSizeX, 32),
              "runs workgroups of at most 32 invocations, glint needs 64");
    EXPECT_EQ(refusalWith(&DeviceLimits::maxPushConstantBytes, 127),
              "has 127 bytes of push constants, glint needs 128");
}

TEST(Refusal, NeedsTheStorageBuffersThatVulkanPromises) {
    DeviceLimits limits = sufficientLimits();
    limits.maxStorageImagesPerStage = 0;
    limits.maxTexelBufferElements = 0;
    limits.maxStorageBuffersPerStage = 4;
    EXPECT_EQ(refusal(VK_API_VERSION_1_1, true, limits), "");
    limits.maxStorageBuffersPerStage = 3;
    EXPECT_EQ(refusal(VK_API_VERSION_1_1, true, limits),
              "binds 3 storage buffers to a kernel, glint needs 4");
}

// Queue families, memory types and what fits, on tables made up after real devices.

VkQueueFamilyProperties family(VkQueueFlags flags, uint32_t timestampBits) {
    VkQueueFamilyProperties properties{};
    properties.queueFlags = flags;
    properties.queueCount = 1;
    properties.timestampValidBits = timestampBits;
    return properties;
}

constexpr VkQueueFlags kAll = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT | VK_QUEUE_TRANSFER_BIT;
constexpr VkQueueFlags kCompute = VK_QUEUE_COMPUTE_BIT | VK_QUEUE_TRANSFER_BIT;

std::optional<uint32_t> choose(const std::vector<VkQueueFamilyProperties>& families) {
    return chooseQueueFamily(families);
}

TEST(QueueFamily, PrefersComputeAlone) {
    EXPECT_EQ(choose({family(kAll, 64), family(VK_QUEUE_TRANSFER_BIT, 64), family(kCompute, 64)}), 2u);
}

TEST(QueueFamily, DoesNotGiveUpTimestamps) {
    EXPECT_EQ(choose({family(kAll, 36), family(kCompute, 0)}), 0u);
}

TEST(QueueFamily, PrefersComputeAloneIfNoneHasTimestamps) {
    EXPECT_EQ(choose({family(kAll, 0), family(kCompute, 0)}), 1u);
}

TEST(QueueFamily, FirstOfEquals) {
    EXPECT_EQ(choose({family(kCompute, 64), family(kCompute, 64)}), 0u);
}

TEST(QueueFamily, NoneWithoutCompute) {
    EXPECT_EQ(choose({family(VK_QUEUE_GRAPHICS_BIT, 64), family(VK_QUEUE_TRANSFER_BIT, 64)}), std::nullopt);
    EXPECT_EQ(choose({}), std::nullopt);
}

constexpr VkMemoryPropertyFlags kLocal = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
constexpr VkMemoryPropertyFlags kVisible =
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
constexpr VkMemoryPropertyFlags kCached = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
constexpr uint32_t kEvery = ~0u;

VkPhysicalDeviceMemoryProperties memory(const std::vector<VkMemoryPropertyFlags>& types) {
    VkPhysicalDeviceMemoryProperties properties{};
    properties.memoryTypeCount = static_cast<uint32_t>(types.size());
    for (size_t i = 0; i < types.size(); ++i) properties.memoryTypes[i].propertyFlags = types[i];
    return properties;
}

// A discrete card with a BAR window: local; host; host cached; the window.
const VkPhysicalDeviceMemoryProperties kDiscrete =
    memory({kLocal, kVisible, kVisible | kCached, kLocal | kVisible});
// An integrated one: write-combined and cached.
const VkPhysicalDeviceMemoryProperties kIntegrated =
    memory({kLocal, kLocal | kVisible, kLocal | kVisible | kCached});

TEST(MemoryType, OfADiscreteCardStaysOutOfTheWindow) {
    EXPECT_EQ(chooseMemoryType(kDiscrete, kEvery, MemoryKind::Device, false), 0u);
    EXPECT_EQ(chooseMemoryType(memory({kLocal | kVisible, kLocal}), kEvery, MemoryKind::Device, false), 1u);
}

TEST(MemoryType, OfADiscreteCardTakesTheWindowIfThereIsNothingElse) {
    EXPECT_EQ(chooseMemoryType(kDiscrete, 0b1110, MemoryKind::Device, false), 3u);
}

TEST(MemoryType, OfAnIntegratedCardIsMappedAndCached) {
    EXPECT_EQ(chooseMemoryType(kIntegrated, kEvery, MemoryKind::Device, true), 2u);
    EXPECT_EQ(chooseMemoryType(kIntegrated, 0b011, MemoryKind::Device, true), 1u);
    EXPECT_EQ(chooseMemoryType(kIntegrated, 0b001, MemoryKind::Device, true), 0u);
}

TEST(MemoryType, ForTheHostIsCachedIfThereIsSuch) {
    EXPECT_EQ(chooseMemoryType(kDiscrete, kEvery, MemoryKind::Host, false), 2u);
    EXPECT_EQ(chooseMemoryType(kDiscrete, 0b0010, MemoryKind::Host, false), 1u);
}

TEST(MemoryType, ForTheHostIsCoherent) {
    const VkMemoryPropertyFlags incoherent = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | kCached;
    EXPECT_EQ(chooseMemoryType(memory({incoherent, kVisible}), kEvery, MemoryKind::Host, false), 1u);
    EXPECT_EQ(chooseMemoryType(memory({incoherent, kLocal}), kEvery, MemoryKind::Host, false), std::nullopt);
}

TEST(MemoryType, NoneIfNoneIsAllowed) {
    EXPECT_EQ(chooseMemoryType(kDiscrete, 0b0110, MemoryKind::Device, false), std::nullopt);
    EXPECT_EQ(chooseMemoryType(kDiscrete, 0, MemoryKind::Host, false), std::nullopt);
}

TEST(MemoryType, AvoidsTypesThatNeedAFeature) {
    EXPECT_EQ(chooseMemoryType(memory({kLocal | VK_MEMORY_PROPERTY_PROTECTED_BIT, kLocal}), kEvery,
                               MemoryKind::Device, false),
              1u);
    EXPECT_EQ(chooseMemoryType(
                  memory({kLocal | kVisible | VK_MEMORY_PROPERTY_DEVICE_COHERENT_BIT_AMD, kLocal | kVisible}),
                  kEvery, MemoryKind::Device, true),
              1u);
}

DeviceLimits limits(uint64_t range, uint64_t texels, uint64_t allocation) {
    DeviceLimits result;
    result.maxStorageBufferRange = range;
    result.maxTexelBufferElements = texels;
    result.maxAllocationSize = allocation;
    return result;
}

TEST(Fits, UpToTheSmallestOfTheLimits) {
    using enum Access;
    EXPECT_TRUE(fits(1024, StorageBuffer, limits(1024, 0, 1 << 20)));
    EXPECT_FALSE(fits(1025, StorageBuffer, limits(1024, 0, 1 << 20)));
    EXPECT_FALSE(fits(1001, StorageBuffer, limits(1007, 0, 1 << 20))) << "1001 bytes become 1008";
    EXPECT_TRUE(fits(1001, StorageBuffer, limits(1008, 0, 1 << 20)));
    EXPECT_FALSE(fits(513, StorageBuffer, limits(1024, 0, 512)));
    EXPECT_FALSE(fits(~uint64_t{0}, StorageBuffer, limits(~uint64_t{0}, 0, ~uint64_t{0})));
    EXPECT_TRUE(fits(16 * 10, TexelBuffer, limits(0, 10, 1 << 20)));
    EXPECT_FALSE(fits(16 * 10 + 1, TexelBuffer, limits(0, 10, 1 << 20)));
    EXPECT_FALSE(fits(0, TexelBuffer, limits(1024, 0, 1024))) << "the device has no texel buffers";
}

}  // namespace glint::gpu::choose_test
