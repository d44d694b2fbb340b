// A Vulkan instance with its own function table, and the messages of its validation layer.
#pragma once

#include <volk.h>

#include <mutex>
#include <string>
#include <vector>

namespace glint::gpu {

// The functions of an instance that glint calls. Each instance has its own table: volk's global one would be
// overwritten by the next instance, which may have other extensions.
#define GLINT_INSTANCE_FUNCTIONS(X)             \
    X(vkDestroyInstance)                        \
    X(vkEnumeratePhysicalDevices)               \
    X(vkEnumerateDeviceExtensionProperties)     \
    X(vkGetPhysicalDeviceProperties)            \
    X(vkGetPhysicalDeviceFeatures2)             \
    X(vkGetPhysicalDeviceProperties2)           \
    X(vkGetPhysicalDeviceFormatProperties)      \
    X(vkGetPhysicalDeviceMemoryProperties)      \
    X(vkGetPhysicalDeviceQueueFamilyProperties) \
    X(vkCreateDevice)                           \
    X(vkGetDeviceProcAddr)

// Functions of VK_KHR_surface; null in an instance without that extension.
#define GLINT_SURFACE_FUNCTIONS(X)               \
    X(vkDestroySurfaceKHR)                       \
    X(vkGetPhysicalDeviceSurfaceSupportKHR)      \
    X(vkGetPhysicalDeviceSurfaceCapabilitiesKHR) \
    X(vkGetPhysicalDeviceSurfaceFormatsKHR)      \
    X(vkGetPhysicalDeviceSurfacePresentModesKHR)

struct InstanceTable {
#define GLINT_DECLARE(name) PFN_##name name = nullptr;
    GLINT_INSTANCE_FUNCTIONS(GLINT_DECLARE)
    GLINT_SURFACE_FUNCTIONS(GLINT_DECLARE)
#undef GLINT_DECLARE
};

bool contains(const std::vector<VkExtensionProperties>& extensions, const char* name);

// Filled from whichever thread the layer calls back on.
class ValidationLog {
  public:
    void add(std::string message);
    std::vector<std::string> messages() const;

  private:
    mutable std::mutex mutex_;
    std::vector<std::string> messages_;
};

class Instance {
  public:
    // With `log`, the validation layer is loaded and writes there; `log` must outlive the instance. Throws
    // Error(Device) if there is no loader, none that knows Vulkan 1.1, or if that layer or one of
    // `wantedExtensions` is missing.
    explicit Instance(ValidationLog* log, const std::vector<std::string>& wantedExtensions = {});
    ~Instance();
    Instance(const Instance&) = delete;
    Instance& operator=(const Instance&) = delete;

    VkInstance get() const { return instance_; }
    const InstanceTable& vk() const { return vk_; }
    std::vector<VkPhysicalDevice> physicalDevices() const;  // in the loader's order

  private:
    VkInstance instance_ = VK_NULL_HANDLE;  // null: the loader found no driver
    InstanceTable vk_;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

}  // namespace glint::gpu
