// Which device, queue family and memory are taken.
#include <gtest/gtest.h>

#include "core/device_layout.h"
#include "gpu/device_state.h"
#include "support/environment.h"
#include "support/support.h"

namespace glint::gpu::choose_test {

// The device that a selector chooses, and the messages for the others, on invented lists.

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
    return glint::test::errorOf(ErrorKind::Device, [&] { chooseDevice(devices, selector); });
}

const std::vector<DeviceInfo> kDesktop = {
    made(0, "llvmpipe (LLVM 15.0.6, 256 bits)", "CPU"),
    made(1, "Intel(R) UHD Graphics 630", "integrated GPU"),
    made(2, "NVIDIA GeForce RTX 3060", "discrete GPU"),
    made(3, "NVIDIA GeForce GT 1030", "discrete GPU"),
    made(4, "Old Card", "discrete GPU", "supports Vulkan 1.0 only, glint needs 1.1"),
    made(5, "SwiftShader, no card", "CPU"),
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

// In any case of letters; "card" is in the name of a better device that cannot be used.
TEST(ChooseDevice, TakesAnIndexOrTheBestUsableOneWithThatInItsName) {
    const std::pair<const char*, uint32_t> choices[] = {
        {"0", 0}, {"3", 3}, {"LLVMPIPE", 0}, {"gt 1030", 3}, {"uhd", 1}, {"nvidia", 2}, {"card", 5}};
    for (const auto& [selector, index] : choices)
        EXPECT_EQ(chooseDevice(kDesktop, selector).index, index) << selector;
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

TEST(ChooseDevice, AWrongSelectionSaysWhatThereIsOrWhy) {
    const DeviceInfo a = made(0, "A", "CPU"), b = made(1, "B", "discrete GPU");
    const struct {
        std::vector<DeviceInfo> devices;
        std::string selector, message;
    } cases[] = {
        {{made(0, "A", "CPU", "has no compute queue"),
          made(1, "B", "discrete GPU", "supports Vulkan 1.0 only")},
         "",
         "no usable Vulkan device: 0 \"A\" has no compute queue; 1 \"B\" supports Vulkan 1.0 only"},
        {{a, b}, "radeon", "no Vulkan device has \"radeon\" in its name; devices: 0 \"A\", 1 \"B\""},
        {{a}, "1", "no Vulkan device has index 1; devices: 0 \"A\""},
        {{a}, "00", "no Vulkan device has index 00; devices: 0 \"A\""},
        // More digits than any integer holds, and whose low 64 bits are 0.
        {{a}, "18446744073709551616", "no Vulkan device has index 18446744073709551616; devices: 0 \"A\""},
        {kDesktop, "4", "device 4 cannot be used: 4 \"Old Card\" supports Vulkan 1.0 only, glint needs 1.1"},
        {kDesktop, "old",
         "device old cannot be used: 4 \"Old Card\" supports Vulkan 1.0 only, glint needs 1.1"},
    };
    for (const auto& [devices, selector, message] : cases) EXPECT_EQ(errorOf(devices, selector), message);
}

// The limits that Vulkan 1.1 guarantees (table "Required Limits"), but for the bindings, where it
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
              "supports Vulkan 1.0 only, glint needs 1.1");
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
    limits.maxStorageBuffersPerStage = GLINT_FEW_BINDINGS;
    EXPECT_EQ(refusal(VK_API_VERSION_1_1, true, limits), "");
    limits.maxStorageBuffersPerStage = GLINT_FEW_BINDINGS - 1;
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

TEST(QueueFamily, PrefersTimestampsThenComputeAloneThenTheFirst) {
    const struct {
        const char* name;
        std::vector<VkQueueFamilyProperties> families;
        std::optional<uint32_t> chosen;
    } cases[] = {
        {"compute alone", {family(kAll, 64), family(VK_QUEUE_TRANSFER_BIT, 64), family(kCompute, 64)}, 2},
        {"timestamps before that", {family(kAll, 36), family(kCompute, 0)}, 0},
        {"compute alone if none has timestamps", {family(kAll, 0), family(kCompute, 0)}, 1},
        {"the first of equals", {family(kCompute, 64), family(kCompute, 64)}, 0},
        {"none computes", {family(VK_QUEUE_GRAPHICS_BIT, 64), family(VK_QUEUE_TRANSFER_BIT, 64)}, {}},
        {"none at all", {}, {}},
    };
    for (const auto& [name, families, chosen] : cases) EXPECT_EQ(chooseQueueFamily(families), chosen) << name;
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

TEST(MemoryType, SuitsTheCardAndWhatItIsFor) {
    using enum MemoryKind;
    const VkMemoryPropertyFlags incoherent = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | kCached,
                                amd = kLocal | kVisible | VK_MEMORY_PROPERTY_DEVICE_COHERENT_BIT_AMD;
    const struct {
        const char* name;
        VkPhysicalDeviceMemoryProperties memory;
        uint32_t allowed;
        MemoryKind kind;
        bool unified;
        std::optional<uint32_t> chosen;
    } cases[] = {
        {"a discrete card's local memory", kDiscrete, kEvery, Device, false, 0},
        {"not its window", memory({kLocal | kVisible, kLocal}), kEvery, Device, false, 1},
        {"its window if there is nothing else", kDiscrete, 0b1110, Device, false, 3},
        {"an integrated card's mapped and cached", kIntegrated, kEvery, Device, true, 2},
        {"an integrated card's mapped", kIntegrated, 0b011, Device, true, 1},
        {"an integrated card's local", kIntegrated, 0b001, Device, true, 0},
        {"for the host a cached one", kDiscrete, kEvery, Host, false, 2},
        {"for the host one that is not", kDiscrete, 0b0010, Host, false, 1},
        {"for the host a coherent one", memory({incoherent, kVisible}), kEvery, Host, false, 1},
        {"none is coherent", memory({incoherent, kLocal}), kEvery, Host, false, {}},
        {"none for the device is allowed", kDiscrete, 0b0110, Device, false, {}},
        {"none is allowed", kDiscrete, 0, Host, false, {}},
        {"not a protected one", memory({kLocal | VK_MEMORY_PROPERTY_PROTECTED_BIT, kLocal}), kEvery, Device,
         false, 1},
        {"not one that needs a feature", memory({amd, kLocal | kVisible}), kEvery, Device, true, 1},
    };
    for (const auto& c : cases)
        EXPECT_EQ(chooseMemoryType(c.memory, c.allowed, c.kind, c.unified), c.chosen) << c.name;
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
