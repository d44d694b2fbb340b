// Queue families, memory types and what fits, on tables made up after real devices.
#include <gtest/gtest.h>

#include "gpu/device_state.h"

namespace glint::gpu::choose_resources_test {
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

}  // namespace glint::gpu::choose_resources_test
