// DeviceInfo from what Vulkan tells of each physical device.
#include <algorithm>

#include "core/error.h"
#include "gpu/device_state.h"

namespace glint::gpu {
namespace {

std::string versionText(uint32_t version) {
    return std::to_string(VK_API_VERSION_MAJOR(version)) + "." +
           std::to_string(VK_API_VERSION_MINOR(version)) + "." +
           std::to_string(VK_API_VERSION_PATCH(version));
}

std::string typeText(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return "discrete GPU";
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return "integrated GPU";
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
            return "virtual GPU";
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return "CPU";
        default:
            return "other";
    }
}

std::vector<VkQueueFamilyProperties> queueFamilies(const InstanceTable& vk, VkPhysicalDevice device) {
    return enumerate<VkQueueFamilyProperties>(
        "vkGetPhysicalDeviceQueueFamilyProperties", [&](uint32_t* count, VkQueueFamilyProperties* out) {
            vk.vkGetPhysicalDeviceQueueFamilyProperties(device, count, out);
            return VK_SUCCESS;
        });
}

std::vector<VkExtensionProperties> deviceExtensions(const InstanceTable& vk, VkPhysicalDevice device) {
    return enumerate<VkExtensionProperties>(
        "vkEnumerateDeviceExtensionProperties", [&](uint32_t* count, VkExtensionProperties* out) {
            return vk.vkEnumerateDeviceExtensionProperties(device, nullptr, count, out);
        });
}

void fillLimits(DeviceLimits& out, const VkPhysicalDeviceLimits& limits) {
    out.maxStorageBufferRange = limits.maxStorageBufferRange;
    out.maxTexelBufferElements = limits.maxTexelBufferElements;
    out.maxWorkgroupInvocations = limits.maxComputeWorkGroupInvocations;
    out.maxWorkgroupSizeX = limits.maxComputeWorkGroupSize[0];
    out.maxWorkgroupCountX = limits.maxComputeWorkGroupCount[0];
    out.maxPushConstantBytes = limits.maxPushConstantsSize;
    out.maxStorageBuffersPerStage = limits.maxPerStageDescriptorStorageBuffers;
    out.maxStorageImagesPerStage = limits.maxPerStageDescriptorStorageImages;
    out.timestampPeriod = static_cast<double>(limits.timestampPeriod);
}

// Queries that need Vulkan 1.1: driver, allocation size, subgroups.
void queryVulkan11(const InstanceTable& vk, PhysicalDevice& device,
                   const std::vector<VkExtensionProperties>& extensions) {
    VkPhysicalDeviceDriverProperties driver{};
    driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
    VkPhysicalDeviceSubgroupProperties subgroup{};
    subgroup.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES;
    VkPhysicalDeviceMaintenance3Properties allocation{};
    allocation.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES;
    allocation.pNext = &subgroup;
    VkPhysicalDeviceProperties2 properties{};
    properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
    properties.pNext = &allocation;
    const bool knowsDriver = contains(extensions, VK_KHR_DRIVER_PROPERTIES_EXTENSION_NAME);
    if (knowsDriver) subgroup.pNext = &driver;
    vk.vkGetPhysicalDeviceProperties2(device.handle, &properties);
    device.info.limits.maxAllocationSize = allocation.maxMemoryAllocationSize;
    device.info.limits.subgroupSize = subgroup.subgroupSize;
    device.info.limits.subgroupShuffle =
        (subgroup.supportedOperations & VK_SUBGROUP_FEATURE_SHUFFLE_BIT) != 0 &&
        (subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) != 0;
    // Only queried: the validation layer's best practices ask for it before vkCreateDevice.
    VkPhysicalDeviceFeatures2 features{};
    features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
    vk.vkGetPhysicalDeviceFeatures2(device.handle, &features);
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
std::vector<VkBool32> presentingFamilies(const InstanceTable& vk, VkPhysicalDevice device, size_t families,
                                         VkSurfaceKHR surface) {
    std::vector<VkBool32> presents;
    if (surface == VK_NULL_HANDLE) return presents;
    presents.resize(families, VK_FALSE);
    for (uint32_t i = 0; i < families; ++i) {
        check(vk.vkGetPhysicalDeviceSurfaceSupportKHR(device, i, surface, &presents[i]),
              "vkGetPhysicalDeviceSurfaceSupportKHR");
    }
    return presents;
}

PhysicalDevice queryDevice(const Instance& instance, VkPhysicalDevice handle, uint32_t index,
                           VkSurfaceKHR surface) {
    const InstanceTable& vk = instance.vk();
    PhysicalDevice device;
    device.handle = handle;
    VkPhysicalDeviceProperties properties{};
    vk.vkGetPhysicalDeviceProperties(handle, &properties);
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
    vk.vkGetPhysicalDeviceFormatProperties(handle, VK_FORMAT_R32G32B32A32_UINT, &format);
    if ((format.bufferFeatures & VK_FORMAT_FEATURE_STORAGE_TEXEL_BUFFER_BIT) == 0) {
        info.limits.maxTexelBufferElements = 0;
    }
    vk.vkGetPhysicalDeviceMemoryProperties(handle, &device.memory);
    info.limits.memory = largestDeviceHeap(device.memory);

    const std::vector<VkExtensionProperties> extensions = deviceExtensions(vk, handle);
    device.portabilitySubset = contains(extensions, "VK_KHR_portability_subset");
    if (properties.apiVersion >= VK_API_VERSION_1_1) queryVulkan11(vk, device, extensions);

    const std::vector<VkQueueFamilyProperties> families = queueFamilies(vk, handle);
    std::optional<uint32_t> family = chooseQueueFamily(families);
    const bool computes = family.has_value();
    if (surface != VK_NULL_HANDLE) {
        const bool swapchains = contains(extensions, VK_KHR_SWAPCHAIN_EXTENSION_NAME);
        family = swapchains
                     ? chooseQueueFamily(families, presentingFamilies(vk, handle, families.size(), surface))
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
        devices.push_back(queryDevice(instance, handle, static_cast<uint32_t>(devices.size()), surface));
    return devices;
}

}  // namespace glint::gpu
