#include <string>

#include "core/error.h"
#include "gpu/device.h"
#include "gpu/handle.h"

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

}  // namespace glint::gpu
