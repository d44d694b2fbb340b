#include "gpu/device_state.h"

namespace glint::gpu {
namespace {

std::vector<DeviceInfo> infos(const std::vector<PhysicalDevice>& devices) {
    std::vector<DeviceInfo> result;
    for (const PhysicalDevice& device : devices) result.push_back(device.info);
    return result;
}

void openDevice(DeviceState& state) {
    const float priority = 1;
    auto queue = infoOf<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
    queue.queueFamilyIndex = state.physical.queueFamily;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    std::vector<const char*> extensions;
    if (state.surface != VK_NULL_HANDLE) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
    VkPhysicalDeviceFeatures features{};
    // Lanes without work load from an uninitialised index and drop the value. Every Vulkan device has this
    // feature, which makes such a load return some number instead of being undefined.
    features.robustBufferAccess = VK_TRUE;
    auto info = infoOf<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    info.pEnabledFeatures = &features;
    check(vkCreateDevice(state.physical.handle, &info, nullptr, &state.device), "vkCreateDevice");
    volkLoadDeviceTable(&state.vk, state.device);
    state.vk.vkGetDeviceQueue(state.device, state.physical.queueFamily, 0, &state.queue);

    auto cache = infoOf<VkPipelineCacheCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO);
    state.pipelineCache = create(state, "vkCreatePipelineCache", cache, state.vk.vkCreatePipelineCache,
                                 state.vk.vkDestroyPipelineCache);
}

}  // namespace

std::vector<DeviceInfo> listDevices() {
    return infos(queryDevices(Instance(nullptr)));
}

DeviceState::~DeviceState() {
    if (abandoned) {
        // The device lives on, and so must the objects that it refers to. They stay reachable, so that leak
        // checkers do not report them.
        static auto& kept = *new std::vector<std::pair<std::unique_ptr<Instance>, decltype(log)>>;
        kept.emplace_back(std::move(instance), log);
        return;
    }
    if (device != VK_NULL_HANDLE) {
        staging.reset();
        programs.clear();
        pipelineCache = {};
        vk.vkDestroyDevice(device, nullptr);
    }
    if (surface != VK_NULL_HANDLE) vkDestroySurfaceKHR(instance->get(), surface, nullptr);
}

Device::Device(const DeviceOptions& options) : state_(std::make_shared<DeviceState>()) {
    if (options.validation) state_->log = std::make_shared<ValidationLog>();
    state_->keepsPrograms = options.keepPrograms;
    state_->context = options.context;
    state_->instance = std::make_unique<Instance>(state_->log.get(), options.window.instanceExtensions);
    if (options.window.makeSurface && state_->instance->get() != VK_NULL_HANDLE) {
        // Through a pointer on 64-bit machines, a number on 32-bit ones: a C cast means either.
        state_->surface = (VkSurfaceKHR)options.window.makeSurface(state_->instance->get());
    }
    const std::vector<PhysicalDevice> devices = queryDevices(*state_->instance, state_->surface);
    state_->physical = devices[chooseDevice(infos(devices), options.selector).index];
    openDevice(*state_);
}

const Context& Device::context() const {
    return state_->context;
}

const DeviceInfo& Device::info() const {
    return state_->physical.info;
}

std::vector<std::string> Device::validationMessages() const {
    if (!state_->log) return {};
    // Layer 1.4.309 reports from a thread of its own, which is done when the queue is idle.
    const std::lock_guard lock(state_->queueMutex);
    state_->vk.vkQueueWaitIdle(state_->queue);
    return state_->log->messages();
}

}  // namespace glint::gpu
