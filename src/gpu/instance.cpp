#include <algorithm>
#include <cstring>
#include <utility>

#include "core/error.h"
#include "gpu/device_state.h"

namespace glint::gpu {
namespace {

struct ResultText {
    VkResult result;
    const char* name;
    const char* meaning;
};

#define GLINT_RESULT(name, meaning) \
    { name, #name, meaning }
constexpr ResultText kResults[] = {
    GLINT_RESULT(VK_ERROR_OUT_OF_HOST_MEMORY, "out of host memory"),
    GLINT_RESULT(VK_ERROR_OUT_OF_DEVICE_MEMORY, "out of device memory"),
    GLINT_RESULT(VK_ERROR_INITIALIZATION_FAILED, "the driver could not start"),
    GLINT_RESULT(VK_ERROR_DEVICE_LOST, "the device was reset, or its driver crashed"),
    GLINT_RESULT(VK_ERROR_MEMORY_MAP_FAILED, "the memory could not be mapped"),
    GLINT_RESULT(VK_ERROR_LAYER_NOT_PRESENT, "a layer is missing"),
    GLINT_RESULT(VK_ERROR_EXTENSION_NOT_PRESENT, "an extension is missing"),
    GLINT_RESULT(VK_ERROR_FEATURE_NOT_PRESENT, "a feature is missing"),
    GLINT_RESULT(VK_ERROR_INCOMPATIBLE_DRIVER, "no driver of this Vulkan version"),
    GLINT_RESULT(VK_ERROR_TOO_MANY_OBJECTS, "too many objects"),
    GLINT_RESULT(VK_ERROR_FORMAT_NOT_SUPPORTED, "the format is not supported"),
    GLINT_RESULT(VK_ERROR_FRAGMENTED_POOL, "the descriptor pool is fragmented"),
    GLINT_RESULT(VK_ERROR_UNKNOWN, "the driver gives no reason"),
    GLINT_RESULT(VK_ERROR_OUT_OF_POOL_MEMORY, "the descriptor pool is exhausted"),
    GLINT_RESULT(VK_ERROR_SURFACE_LOST_KHR, "the window's surface is gone"),
    GLINT_RESULT(VK_ERROR_OUT_OF_DATE_KHR, "the window has changed"),
    GLINT_RESULT(VK_ERROR_INVALID_SHADER_NV, "the shader does not compile"),
};
#undef GLINT_RESULT

const char* const kValidationLayer = "VK_LAYER_KHRONOS_validation";

void openLoader() {
    static const VkResult opened = volkInitialize();
    if (opened != VK_SUCCESS) {
        throw Error(ErrorKind::Device,
                    "no Vulkan loader (libvulkan.so.1) found: install libvulkan1 and a driver such as "
                    "mesa-vulkan-drivers");
    }
}

void requireValidationLayer() {
    const auto layers = enumerate<VkLayerProperties>("vkEnumerateInstanceLayerProperties",
                                                     vkEnumerateInstanceLayerProperties);
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

// The type GENERAL is left out: with it the loader reports on the machine's other drivers.
VkDebugUtilsMessengerCreateInfoEXT messengerInfo(ValidationLog* log) {
    auto info =
        infoOf<VkDebugUtilsMessengerCreateInfoEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
    info.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    info.messageType =
        VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
    info.pfnUserCallback = collect;
    info.pUserData = log;
    return info;
}

}  // namespace

void check(VkResult result, const char* call) {
    if (result >= 0) return;
    std::string text = "VkResult " + std::to_string(static_cast<int>(result));
    for (const ResultText& known : kResults) {
        if (known.result == result) text = std::string(known.name) + " (" + known.meaning + ")";
    }
    text = std::string(call) + " failed: " + text;
    if (result == VK_ERROR_DEVICE_LOST) throw DeviceLost(text);
    throw Error(ErrorKind::Device, text);
}

bool contains(const std::vector<VkExtensionProperties>& extensions, const char* name) {
    return std::any_of(extensions.begin(), extensions.end(), [&](const VkExtensionProperties& extension) {
        return std::strcmp(extension.extensionName, name) == 0;
    });
}

Instance::Instance(ValidationLog* log, const std::vector<std::string>& wantedExtensions) {
    openLoader();
    auto info = infoOf<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
    const auto present = enumerate<VkExtensionProperties>("vkEnumerateInstanceExtensionProperties",
                                                          vkEnumerateInstanceExtensionProperties, nullptr);
    std::vector<const char*> extensions;
    for (const char* name : {VK_KHR_SURFACE_EXTENSION_NAME, VK_EXT_DEBUG_UTILS_EXTENSION_NAME})
        if (contains(present, name)) extensions.push_back(name);
    for (const std::string& name : wantedExtensions) {
        if (!contains(present, name.c_str()))
            throw Error(ErrorKind::Device,
                        "no Vulkan driver here supports " + name + ", which a window needs");
        if (name != VK_KHR_SURFACE_EXTENSION_NAME) extensions.push_back(name.c_str());
    }

    VkDebugUtilsMessengerCreateInfoEXT messenger = messengerInfo(log);
    const VkValidationFeatureEnableEXT enabled[] = {
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    auto features = infoOf<VkValidationFeaturesEXT>(VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT);
    features.pNext = &messenger;  // for what goes wrong while the instance itself is made or destroyed
    features.enabledValidationFeatureCount = 1;
    features.pEnabledValidationFeatures = enabled;
    if (log != nullptr) {
        requireValidationLayer();
        if (!contains(present, VK_EXT_DEBUG_UTILS_EXTENSION_NAME))
            throw Error(ErrorKind::Device,
                        "the Vulkan loader lacks VK_EXT_debug_utils for validation messages");
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = &kValidationLayer;
        extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
        info.pNext = &features;
    }

    auto application = infoOf<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
    application.pApplicationName = "glint";
    application.apiVersion = VK_API_VERSION_1_1;
    info.pApplicationInfo = &application;
    info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    const VkResult result = vkCreateInstance(&info, nullptr, &instance_);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER) {  // the loader's word for "no driver at all"
        instance_ = VK_NULL_HANDLE;
        return;
    }
    check(result, "vkCreateInstance");

    static std::once_flag loaded;
    std::call_once(loaded, volkLoadInstanceOnly, instance_);
    if (log != nullptr) {
        const VkResult made = vkCreateDebugUtilsMessengerEXT(instance_, &messenger, nullptr, &messenger_);
        if (made < 0) vkDestroyInstance(instance_, nullptr);
        check(made, "vkCreateDebugUtilsMessengerEXT");
    }
}

Instance::~Instance() {
    if (messenger_ != VK_NULL_HANDLE) vkDestroyDebugUtilsMessengerEXT(instance_, messenger_, nullptr);
    if (instance_ != VK_NULL_HANDLE) vkDestroyInstance(instance_, nullptr);
}

std::vector<VkPhysicalDevice> Instance::physicalDevices() const {
    if (instance_ == VK_NULL_HANDLE) return {};
    return enumerate<VkPhysicalDevice>(
        "vkEnumeratePhysicalDevices", [&](uint32_t* count, VkPhysicalDevice* out) {
            const VkResult result = vkEnumeratePhysicalDevices(instance_, count, out);
            // Some drivers fail here, not at vkCreateInstance, when their hardware is absent.
            return result == VK_ERROR_INITIALIZATION_FAILED ? VK_SUCCESS : result;
        });
}

}  // namespace glint::gpu
