// A Vulkan layer that lets calls fail. The environment variable GLINT_FAULT names a call and which of them is
// the first to fail, counted from 1 for each device: "vkQueueSubmit 5". Those after it fail too, as on a
// device that is gone. What a call fails with is below; "vkWaitForFences" times out at once.
#include <vulkan/vk_layer.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>

namespace {

// One loader and one driver at a time: what is below this layer has one address for all.
PFN_vkGetInstanceProcAddr nextInstanceProc = nullptr;
PFN_vkGetDeviceProcAddr nextDeviceProc = nullptr;
std::atomic<int> calls{0};

// True if this call of that name is to fail. Counts the calls of the name that is asked for.
bool fails(const char* call) {
    const char* wanted = std::getenv("GLINT_FAULT");
    if (wanted == nullptr) return false;
    std::istringstream text(wanted);
    std::string name;
    int first = 0;
    return text >> name >> first && name == call && ++calls >= first;
}

template <typename Function>
Function next(VkDevice device, const char* name) {
    return reinterpret_cast<Function>(nextDeviceProc(device, name));
}

VkDevice theDevice = VK_NULL_HANDLE;  // of calls that are given a queue

// The chain of the loader: the entry of this layer, whose link leads to the next.
template <typename Link, typename Info>
Link* linkOf(const Info* info, VkStructureType type) {
    auto* entry = static_cast<Link*>(const_cast<void*>(info->pNext));
    while (entry != nullptr && (entry->sType != type || entry->function != VK_LAYER_LINK_INFO))
        entry = static_cast<Link*>(const_cast<void*>(entry->pNext));
    return entry;
}

VKAPI_ATTR VkResult VKAPI_CALL createInstance(const VkInstanceCreateInfo* info,
                                              const VkAllocationCallbacks* allocator, VkInstance* instance) {
    auto* link = linkOf<VkLayerInstanceCreateInfo>(info, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
    if (link == nullptr) return VK_ERROR_INITIALIZATION_FAILED;
    nextInstanceProc = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    const auto create =
        reinterpret_cast<PFN_vkCreateInstance>(nextInstanceProc(VK_NULL_HANDLE, "vkCreateInstance"));
    return create(info, allocator, instance);
}

VKAPI_ATTR VkResult VKAPI_CALL createDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                            const VkAllocationCallbacks* allocator, VkDevice* device) {
    calls = 0;
    if (fails("vkCreateDevice")) return VK_ERROR_INITIALIZATION_FAILED;
    auto* link = linkOf<VkLayerDeviceCreateInfo>(info, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
    if (link == nullptr) return VK_ERROR_INITIALIZATION_FAILED;
    const PFN_vkGetInstanceProcAddr instanceProc = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    nextDeviceProc = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    const auto create = reinterpret_cast<PFN_vkCreateDevice>(instanceProc(VK_NULL_HANDLE, "vkCreateDevice"));
    const VkResult result = create(physical, info, allocator, device);
    if (result == VK_SUCCESS) theDevice = *device;
    return result;
}

VKAPI_ATTR VkResult VKAPI_CALL queueSubmit(VkQueue queue, uint32_t count, const VkSubmitInfo* submits,
                                           VkFence fence) {
    if (fails("vkQueueSubmit")) return VK_ERROR_DEVICE_LOST;
    return next<PFN_vkQueueSubmit>(theDevice, "vkQueueSubmit")(queue, count, submits, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL waitForFences(VkDevice device, uint32_t count, const VkFence* fences,
                                             VkBool32 all, uint64_t nanoseconds) {
    const auto wait = next<PFN_vkWaitForFences>(device, "vkWaitForFences");
    if (!fails("vkWaitForFences")) return wait(device, count, fences, all, nanoseconds);
    // The work is done, but nobody is told: what stays behind does not touch memory that a test frees.
    wait(device, count, fences, all, nanoseconds);
    return VK_TIMEOUT;
}

VKAPI_ATTR VkResult VKAPI_CALL allocateMemory(VkDevice device, const VkMemoryAllocateInfo* info,
                                              const VkAllocationCallbacks* allocator,
                                              VkDeviceMemory* memory) {
    if (fails("vkAllocateMemory")) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    return next<PFN_vkAllocateMemory>(device, "vkAllocateMemory")(device, info, allocator, memory);
}

VKAPI_ATTR VkResult VKAPI_CALL createBuffer(VkDevice device, const VkBufferCreateInfo* info,
                                            const VkAllocationCallbacks* allocator, VkBuffer* buffer) {
    if (fails("vkCreateBuffer")) return VK_ERROR_OUT_OF_HOST_MEMORY;
    return next<PFN_vkCreateBuffer>(device, "vkCreateBuffer")(device, info, allocator, buffer);
}

VKAPI_ATTR VkResult VKAPI_CALL createComputePipelines(VkDevice device, VkPipelineCache cache, uint32_t count,
                                                      const VkComputePipelineCreateInfo* infos,
                                                      const VkAllocationCallbacks* allocator,
                                                      VkPipeline* pipelines) {
    if (fails("vkCreateComputePipelines")) return VK_ERROR_INVALID_SHADER_NV;
    return next<PFN_vkCreateComputePipelines>(device, "vkCreateComputePipelines")(device, cache, count, infos,
                                                                                  allocator, pipelines);
}

PFN_vkVoidFunction ownProc(const char* name);

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL deviceProc(VkDevice device, const char* name) {
    if (const PFN_vkVoidFunction own = ownProc(name)) return own;
    return nextDeviceProc(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instanceProc(VkInstance instance, const char* name) {
    if (std::strcmp(name, "vkGetInstanceProcAddr") == 0)
        return reinterpret_cast<PFN_vkVoidFunction>(instanceProc);
    if (const PFN_vkVoidFunction own = ownProc(name)) return own;
    return nextInstanceProc == nullptr ? nullptr : nextInstanceProc(instance, name);
}

PFN_vkVoidFunction ownProc(const char* name) {
    const struct {
        const char* name;
        PFN_vkVoidFunction function;
    } own[] = {
        {"vkGetDeviceProcAddr", reinterpret_cast<PFN_vkVoidFunction>(deviceProc)},
        {"vkCreateInstance", reinterpret_cast<PFN_vkVoidFunction>(createInstance)},
        {"vkCreateDevice", reinterpret_cast<PFN_vkVoidFunction>(createDevice)},
        {"vkQueueSubmit", reinterpret_cast<PFN_vkVoidFunction>(queueSubmit)},
        {"vkWaitForFences", reinterpret_cast<PFN_vkVoidFunction>(waitForFences)},
        {"vkAllocateMemory", reinterpret_cast<PFN_vkVoidFunction>(allocateMemory)},
        {"vkCreateBuffer", reinterpret_cast<PFN_vkVoidFunction>(createBuffer)},
        {"vkCreateComputePipelines", reinterpret_cast<PFN_vkVoidFunction>(createComputePipelines)},
    };
    for (const auto& entry : own)
        if (std::strcmp(name, entry.name) == 0) return entry.function;
    return nullptr;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) VkResult vkNegotiateLoaderLayerInterfaceVersion(
    VkNegotiateLayerInterface* version) {
    version->loaderLayerInterfaceVersion = 2;
    version->pfnGetInstanceProcAddr = instanceProc;
    version->pfnGetDeviceProcAddr = deviceProc;
    version->pfnGetPhysicalDeviceProcAddr = nullptr;
    return VK_SUCCESS;
}
