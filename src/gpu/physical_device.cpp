// Chooses device, queue family and memory type, and names what a device lacks; queries physical devices.
#include <algorithm>
#include <cctype>
#include <cstdlib>

#include "core/error.h"
#include "core/text_file.h"
#include "gpu/device_state.h"

namespace glint::gpu {
namespace {

constexpr uint32_t kWorkgroupInvocations = 64;  // local size of every kernel
constexpr uint32_t kPushConstantBytes = 128;    // what Vulkan guarantees (table 33, required limits)
// Storage buffers of a kernel that has its arrays together: GLINT_FEW_BINDINGS (shaders/shared/layout.h).
constexpr uint32_t kBindings = 4;

struct DeviceType {
    VkPhysicalDeviceType type;
    const char* name;
};
// By preference.
constexpr DeviceType kTypes[] = {{VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU, "discrete GPU"},
                                 {VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU, "integrated GPU"},
                                 {VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU, "virtual GPU"},
                                 {VK_PHYSICAL_DEVICE_TYPE_OTHER, "other"},
                                 {VK_PHYSICAL_DEVICE_TYPE_CPU, "CPU"}};

auto rank(const DeviceInfo& device) {
    return std::ranges::find_if(kTypes, [&](const DeviceType& type) { return device.type == type.name; });
}

std::string typeText(VkPhysicalDeviceType type) {
    const auto* const found = std::ranges::find(kTypes, type, &DeviceType::type);
    return found != std::end(kTypes) ? found->name : "other";
}

std::string label(const DeviceInfo& device) {
    return std::to_string(device.index) + " \"" + device.name + "\"";
}

using DeviceRefs = std::vector<std::reference_wrapper<const DeviceInfo>>;

std::string labels(const std::vector<DeviceInfo>& devices) {
    std::string text;
    for (const DeviceInfo& device : devices) text += (text.empty() ? "" : ", ") + label(device);
    return text;
}

std::string reasons(const DeviceRefs& devices) {
    std::string text;
    for (const DeviceInfo& device : devices)
        text += (text.empty() ? "" : "; ") + label(device) + " " + device.reason;
    return text;
}

bool isNumber(const std::string& text) {
    return !text.empty() &&
           std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

DeviceRefs matching(const std::vector<DeviceInfo>& devices, const std::string& selector) {
    DeviceRefs matches;
    for (const DeviceInfo& device : devices)
        if (isNumber(selector) ? std::to_string(device.index) == selector
                               : lowerCase(device.name).find(lowerCase(selector)) != std::string::npos)
            matches.push_back(device);
    return matches;
}

// Users' variables replace the loader's own list of drivers.
std::string noDevice() {
    for (const std::string name : {"VK_DRIVER_FILES", "VK_ICD_FILENAMES"})
        if (const char* files = std::getenv(name.c_str()); files != nullptr && *files != '\0')
            return "no Vulkan device found: " + name + " is \"" + files +
                   "\"; unset it, or name a driver's .json file";
    return "no Vulkan device found: install a driver such as mesa-vulkan-drivers";
}

bool has(VkMemoryPropertyFlags flags, VkMemoryPropertyFlags wanted) {
    return (flags & wanted) == wanted;
}

// Higher is better, negative is unfit.
int score(VkMemoryPropertyFlags flags, MemoryKind kind, bool unified) {
    // Types that trap on ordinary access, or that the driver may fail to back with memory.
    if (flags & (VK_MEMORY_PROPERTY_PROTECTED_BIT | VK_MEMORY_PROPERTY_LAZILY_ALLOCATED_BIT |
                 VK_MEMORY_PROPERTY_DEVICE_COHERENT_BIT_AMD)) {
        return -1;
    }
    const bool mappable = isMappable(flags);
    const bool cached = has(flags, VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
    if (kind == MemoryKind::Host) return mappable ? (cached ? 1 : 0) : -1;
    if (!has(flags, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)) return -1;
    return unified == mappable ? (mappable && cached ? 2 : 1) : 0;
}

}  // namespace

const DeviceInfo& chooseDevice(const std::vector<DeviceInfo>& devices, const std::string& selector) {
    if (devices.empty()) throw Error(ErrorKind::Device, noDevice());
    const DeviceRefs matches = matching(devices, selector);
    if (matches.empty()) {
        const std::string what = isNumber(selector) ? "no Vulkan device has index " + selector
                                                    : "no Vulkan device has \"" + selector + "\" in its name";
        throw Error(ErrorKind::Device, what + "; devices: " + labels(devices));
    }
    const DeviceInfo* best = nullptr;
    for (const DeviceInfo& device : matches) {
        if (device.usable && (best == nullptr || rank(device) < rank(*best))) best = &device;
    }
    if (best == nullptr) {
        const std::string what =
            selector.empty() ? "no usable Vulkan device" : "device " + selector + " cannot be used";
        throw Error(ErrorKind::Device, what + ": " + reasons(matches));
    }
    return *best;
}

std::optional<uint32_t> chooseQueueFamily(std::span<const VkQueueFamilyProperties> families,
                                          std::span<const VkBool32> presents) {
    std::optional<uint32_t> best;
    int bestScore = -1;
    for (uint32_t i = 0; i < families.size(); ++i) {
        const VkQueueFamilyProperties& family = families[i];
        if ((family.queueFlags & VK_QUEUE_COMPUTE_BIT) == 0 || family.queueCount == 0) continue;
        if (!presents.empty() && presents[i] == VK_FALSE) continue;
        const bool dedicated = (family.queueFlags & VK_QUEUE_GRAPHICS_BIT) == 0;
        const bool timestamps = family.timestampValidBits > 0;
        const int score = (timestamps ? 2 : 0) + (dedicated ? 1 : 0);
        if (score > bestScore) {
            best = i;
            bestScore = score;
        }
    }
    return best;
}

std::string refusal(uint32_t apiVersion, bool hasComputeQueue, const DeviceLimits& limits) {
    const auto number = [](uint64_t value) { return std::to_string(value); };
    if (apiVersion < VK_API_VERSION_1_1) return "supports Vulkan 1.0 only, glint needs 1.1";
    if (!hasComputeQueue) return "has no compute queue";
    const uint32_t invocations = std::min(limits.maxWorkgroupInvocations, limits.maxWorkgroupSizeX);
    if (invocations < kWorkgroupInvocations) {
        return "runs workgroups of at most " + number(invocations) + " invocations, glint needs " +
               number(kWorkgroupInvocations);
    }
    if (limits.maxPushConstantBytes < kPushConstantBytes) {
        return "has " + number(limits.maxPushConstantBytes) + " bytes of push constants, glint needs " +
               number(kPushConstantBytes);
    }
    if (limits.maxStorageBuffersPerStage < kBindings) {
        return "binds " + number(limits.maxStorageBuffersPerStage) +
               " storage buffers to a kernel, glint needs " + number(kBindings);
    }
    return "";
}

std::optional<uint32_t> chooseMemoryType(const VkPhysicalDeviceMemoryProperties& memory,
                                         uint32_t allowedTypes, MemoryKind kind, bool unified) {
    std::optional<uint32_t> best;
    int bestScore = -1;
    for (uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
        if ((allowedTypes & (1u << i)) == 0) continue;
        const int candidate = score(memory.memoryTypes[i].propertyFlags, kind, unified);
        if (candidate > bestScore) {
            best = i;
            bestScore = candidate;
        }
    }
    return best;
}

// ---- physical devices ----

namespace {

std::string versionText(uint32_t version) {
    return std::to_string(VK_API_VERSION_MAJOR(version)) + "." +
           std::to_string(VK_API_VERSION_MINOR(version)) + "." +
           std::to_string(VK_API_VERSION_PATCH(version));
}

std::vector<VkQueueFamilyProperties> queueFamilies(VkPhysicalDevice device) {
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
    return families;
}

void fillLimits(DeviceLimits& out, const VkPhysicalDeviceLimits& limits) {
    out.maxStorageBufferRange = limits.maxStorageBufferRange;
    out.maxTexelBufferElements = std::min(limits.maxTexelBufferElements, 1u << 27);  // shaders/storage.glsl
    out.maxWorkgroupInvocations = limits.maxComputeWorkGroupInvocations;
    out.maxWorkgroupSizeX = limits.maxComputeWorkGroupSize[0];
    out.maxWorkgroupCountX = limits.maxComputeWorkGroupCount[0];
    out.maxPushConstantBytes = limits.maxPushConstantsSize;
    out.maxStorageBuffersPerStage = limits.maxPerStageDescriptorStorageBuffers;
    out.maxStorageImagesPerStage = limits.maxPerStageDescriptorStorageImages;
    out.timestampPeriod = static_cast<double>(limits.timestampPeriod);
}

// Queries that need Vulkan 1.1: driver, allocation size, subgroups.
void queryVulkan11(PhysicalDevice& device, const std::vector<VkExtensionProperties>& extensions) {
    auto driver =
        infoOf<VkPhysicalDeviceDriverProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES);
    auto subgroup =
        infoOf<VkPhysicalDeviceSubgroupProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES);
    auto allocation = infoOf<VkPhysicalDeviceMaintenance3Properties>(
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES);
    allocation.pNext = &subgroup;
    auto properties = infoOf<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
    properties.pNext = &allocation;
    const bool knowsDriver = contains(extensions, VK_KHR_DRIVER_PROPERTIES_EXTENSION_NAME);
    if (knowsDriver) subgroup.pNext = &driver;
    vkGetPhysicalDeviceProperties2(device.handle, &properties);
    device.info.limits.maxAllocationSize = allocation.maxMemoryAllocationSize;
    device.info.limits.subgroupSize = subgroup.subgroupSize;
    device.info.limits.subgroupShuffle =
        (subgroup.supportedOperations & VK_SUBGROUP_FEATURE_SHUFFLE_BIT) != 0 &&
        (subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) != 0;
    // Only queried: the validation layer's best practices require it before vkCreateDevice.
    auto features = infoOf<VkPhysicalDeviceFeatures2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2);
    vkGetPhysicalDeviceFeatures2(device.handle, &features);
    if (knowsDriver) {
        device.info.driver = driver.driverName;
        if (driver.driverInfo[0] != 0) device.info.driver += std::string(" ") + driver.driverInfo;
        device.info.llvmpipe = driver.driverID == VK_DRIVER_ID_MESA_LLVMPIPE;
    }
}

uint64_t largestDeviceHeap(const VkPhysicalDeviceMemoryProperties& memory) {
    uint64_t largest = 0;
    for (uint32_t i = 0; i < memory.memoryHeapCount; ++i) {
        const VkMemoryHeap& heap = memory.memoryHeaps[i];
        if (heap.flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) largest = std::max<uint64_t>(largest, heap.size);
    }
    return largest;
}

// For each queue family, whether it can show pictures on `surface`; empty without one.
std::vector<VkBool32> presentingFamilies(VkPhysicalDevice device, size_t families, VkSurfaceKHR surface) {
    std::vector<VkBool32> presents;
    if (surface == VK_NULL_HANDLE) return presents;
    presents.resize(families, VK_FALSE);
    for (uint32_t i = 0; i < families; ++i) {
        check(vkGetPhysicalDeviceSurfaceSupportKHR(device, i, surface, &presents[i]),
              "vkGetPhysicalDeviceSurfaceSupportKHR");
    }
    return presents;
}

PhysicalDevice queryDevice(VkPhysicalDevice handle, uint32_t index, VkSurfaceKHR surface) {
    PhysicalDevice device;
    device.handle = handle;
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(handle, &properties);
    DeviceInfo& info = device.info;
    info.index = index;
    info.name = properties.deviceName;
    info.type = typeText(properties.deviceType);
    info.driver = "driver " + versionText(properties.driverVersion);
    info.api = versionText(properties.apiVersion);
    info.software = properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    device.unified = info.software || properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
    fillLimits(info.limits, properties.limits);
    // Vulkan requires this format here (table 60), but drivers that only approach conformance are listed too.
    VkFormatProperties format{};
    vkGetPhysicalDeviceFormatProperties(handle, VK_FORMAT_R32G32B32A32_UINT, &format);
    if ((format.bufferFeatures & VK_FORMAT_FEATURE_STORAGE_TEXEL_BUFFER_BIT) == 0)
        info.limits.maxTexelBufferElements = 0;

    vkGetPhysicalDeviceMemoryProperties(handle, &device.memory);
    info.limits.memory = largestDeviceHeap(device.memory);

    const auto extensions = enumerate<VkExtensionProperties>(
        "vkEnumerateDeviceExtensionProperties", vkEnumerateDeviceExtensionProperties, handle, nullptr);
    if (properties.apiVersion >= VK_API_VERSION_1_1) queryVulkan11(device, extensions);

    const std::vector<VkQueueFamilyProperties> families = queueFamilies(handle);
    std::optional<uint32_t> family = chooseQueueFamily(families);
    const bool computes = family.has_value();
    if (surface != VK_NULL_HANDLE) {
        const bool swapchains = contains(extensions, VK_KHR_SWAPCHAIN_EXTENSION_NAME);
        family = swapchains
                     ? chooseQueueFamily(families, presentingFamilies(handle, families.size(), surface))
                     : std::nullopt;
    }
    if (family) {
        device.queueFamily = *family;
        device.timestampBits = families[*family].timestampValidBits;
    }
    if (device.timestampBits == 0) info.limits.timestampPeriod = 0;
    info.reason = refusal(properties.apiVersion, computes, info.limits);
    if (info.reason.empty() && !family) info.reason = "cannot show images in this window";
    info.usable = info.reason.empty();
    if (info.usable) info.reason = "has all that glint needs";
    return device;
}

}  // namespace

std::vector<PhysicalDevice> queryDevices(const Instance& instance, VkSurfaceKHR surface) {
    std::vector<PhysicalDevice> devices;
    for (VkPhysicalDevice handle : instance.physicalDevices())
        devices.push_back(queryDevice(handle, static_cast<uint32_t>(devices.size()), surface));
    return devices;
}

}  // namespace glint::gpu
