// Decisions from plain data: which device, queue family and memory type, and the words for what a device
// lacks.
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <functional>

#include "core/error.h"
#include "gpu/device_state.h"

namespace glint::gpu {
namespace {

constexpr uint32_t kWorkgroupInvocations = 64;  // local size of every kernel
constexpr uint32_t kPushConstantBytes = 128;    // what Vulkan guarantees (table 33, required limits)
constexpr uint32_t kBindings =
    4;  // storage buffers of a kernel that has its arrays together (render/kernels.h)

int rank(const DeviceInfo& device) {
    constexpr const char* kOrder[] = {"discrete GPU", "integrated GPU", "virtual GPU", "other", "CPU"};
    return static_cast<int>(std::find(std::begin(kOrder), std::end(kOrder), device.type) -
                            std::begin(kOrder));
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
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
                               : lower(device.name).find(lower(selector)) != std::string::npos)
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
    if (apiVersion < VK_API_VERSION_1_1) return "knows Vulkan 1.0 only, glint needs 1.1";
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

}  // namespace glint::gpu
