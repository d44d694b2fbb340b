#include "gpu/instance.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/error.h"
#include "gpu/handle.h"

namespace glint::gpu {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

void openLoader() {
    static const VkResult opened = volkInitialize();
    if (opened != VK_SUCCESS) {
        throw Error(ErrorKind::Device,
                    "no Vulkan loader (libvulkan.so.1) found: install libvulkan1 and a driver such as "
                    "mesa-vulkan-drivers");
    }
    uint32_t version = VK_API_VERSION_1_0;  // whose loaders lack the function that tells it
    const char* const call = "vkEnumerateInstanceVersion";
    if (vkEnumerateInstanceVersion != nullptr) check(vkEnumerateInstanceVersion(&version), call);
    if (version < VK_API_VERSION_1_1) {
        throw Error(ErrorKind::Device,
                    "the Vulkan loader knows Vulkan 1.0 only, glint needs 1.1: update libvulkan1");
    }
}

std::vector<VkExtensionProperties> instanceExtensions(const char* layer) {
    uint32_t count = 0;
    const char* const call = "vkEnumerateInstanceExtensionProperties";
    check(vkEnumerateInstanceExtensionProperties(layer, &count, nullptr), call);
    std::vector<VkExtensionProperties> extensions(count);
    check(vkEnumerateInstanceExtensionProperties(layer, &count, extensions.data()), call);
    extensions.resize(count);
    return extensions;
}

std::vector<const char*> pointers(const std::vector<std::string>& names) {
    std::vector<const char*> result;
    for (const std::string& name : names) result.push_back(name.c_str());
    return result;
}

void requireAll(const std::vector<std::string>& wanted, const std::vector<VkExtensionProperties>& present) {
    for (const std::string& name : wanted) {
        if (!contains(present, name.c_str()))
            throw Error(ErrorKind::Device, "no Vulkan driver here knows " + name + ", which a window needs");
    }
}

void requireValidationLayer() {
    uint32_t count = 0;
    const char* const call = "vkEnumerateInstanceLayerProperties";
    check(vkEnumerateInstanceLayerProperties(&count, nullptr), call);
    std::vector<VkLayerProperties> layers(count);
    check(vkEnumerateInstanceLayerProperties(&count, layers.data()), call);
    layers.resize(count);
    const bool present = std::any_of(layers.begin(), layers.end(), [](const VkLayerProperties& layer) {
        return std::strcmp(layer.layerName, kValidationLayer) == 0;
    });
    if (!present)
        throw Error(ErrorKind::Device, std::string("the validation layer ") + kValidationLayer +
                                           " is not installed (Debian package vulkan-validationlayers)");
}

VKAPI_ATTR VkBool32 VKAPI_CALL collect(VkDebugUtilsMessageSeverityFlagBitsEXT /*severity*/,
                                       VkDebugUtilsMessageTypeFlagsEXT /*type*/,
                                       const VkDebugUtilsMessengerCallbackDataEXT* data, void* log) {
    std::string message = data->pMessage;
    const std::string name = data->pMessageIdName ? data->pMessageIdName : "";
    // Remarks of layers since 1.4 on their own settings.
    if (name == "VALIDATION-SETTINGS" || name == "WARNING-GPU-Assisted-Validation") return VK_FALSE;
    // These layers also leave the name out of the text.
    if (message.find(name) == std::string::npos) message = name + ": " + message;
    static_cast<ValidationLog*>(log)->add(std::move(message));
    return VK_FALSE;
}

// The type GENERAL stays out: there the loader reports what it thinks of the machine's other drivers.
VkDebugUtilsMessengerCreateInfoEXT messengerInfo(ValidationLog* log) {
    VkDebugUtilsMessengerCreateInfoEXT info{};
    info.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
    info.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    info.messageType =
        VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
    info.pfnUserCallback = collect;
    info.pUserData = log;
    return info;
}

}  // namespace

bool contains(const std::vector<VkExtensionProperties>& extensions, const char* name) {
    return std::any_of(extensions.begin(), extensions.end(), [&](const VkExtensionProperties& extension) {
        return std::strcmp(extension.extensionName, name) == 0;
    });
}

void ValidationLog::add(std::string message) {
    const std::lock_guard lock(mutex_);
    messages_.push_back(std::move(message));
}

std::vector<std::string> ValidationLog::messages() const {
    const std::lock_guard lock(mutex_);
    return messages_;
}

Instance::Instance(ValidationLog* log, const std::vector<std::string>& wantedExtensions) {
    openLoader();
    std::vector<const char*> extensions = pointers(wantedExtensions);
    std::vector<const char*> layers;
    VkInstanceCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    const std::vector<VkExtensionProperties> present = instanceExtensions(nullptr);
    requireAll(wantedExtensions, present);
    if (contains(present, VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME)) {
        extensions.push_back(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);
        info.flags |= VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR;
    }

    VkDebugUtilsMessengerCreateInfoEXT messenger = messengerInfo(log);
    const VkValidationFeatureEnableEXT enabled[] = {
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    VkValidationFeaturesEXT features{};
    features.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT;
    features.pNext = &messenger;  // for what goes wrong while the instance itself is made or destroyed
    features.enabledValidationFeatureCount = 1;
    features.pEnabledValidationFeatures = enabled;
    if (log != nullptr) {
        requireValidationLayer();
        layers.push_back(kValidationLayer);
        extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
        extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
        info.pNext = &features;
    }

    VkApplicationInfo application{};
    application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
    application.pApplicationName = "glint";
    application.apiVersion = VK_API_VERSION_1_1;
    info.pApplicationInfo = &application;
    info.enabledLayerCount = static_cast<uint32_t>(layers.size());
    info.ppEnabledLayerNames = layers.data();
    info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    const VkResult result = vkCreateInstance(&info, nullptr, &instance_);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER) {  // the loader's word for "no driver at all"
        instance_ = VK_NULL_HANDLE;
        return;
    }
    check(result, "vkCreateInstance");

#define GLINT_LOAD(name) vk_.name = reinterpret_cast<PFN_##name>(vkGetInstanceProcAddr(instance_, #name));
    GLINT_INSTANCE_FUNCTIONS(GLINT_LOAD)
    GLINT_SURFACE_FUNCTIONS(GLINT_LOAD)
#undef GLINT_LOAD
    if (log != nullptr) {
        const auto createMessenger = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
        if (createMessenger == nullptr ||
            createMessenger(instance_, &messenger, nullptr, &messenger_) != VK_SUCCESS) {
            vk_.vkDestroyInstance(instance_, nullptr);
            throw Error(ErrorKind::Device, "the validation layer cannot be listened to");
        }
    }
}

Instance::~Instance() {
    if (messenger_ != VK_NULL_HANDLE) {
        const auto destroyMessenger = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
        destroyMessenger(instance_, messenger_, nullptr);
    }
    if (instance_ != VK_NULL_HANDLE) vk_.vkDestroyInstance(instance_, nullptr);
}

std::vector<VkPhysicalDevice> Instance::physicalDevices() const {
    if (instance_ == VK_NULL_HANDLE) return {};
    uint32_t count = 0;
    const char* const call = "vkEnumeratePhysicalDevices";
    VkResult result = vk_.vkEnumeratePhysicalDevices(instance_, &count, nullptr);
    // Some drivers say so here, not at vkCreateInstance, when their hardware is absent.
    if (result == VK_ERROR_INITIALIZATION_FAILED) return {};
    check(result, call);
    std::vector<VkPhysicalDevice> devices(count);
    check(vk_.vkEnumeratePhysicalDevices(instance_, &count, devices.data()), call);
    devices.resize(count);
    return devices;
}

}  // namespace glint::gpu
