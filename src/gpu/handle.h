// Ownership of the objects of one VkDevice.
#pragma once

#include <volk.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace glint::gpu {

// Throws Error(Device, "<call> failed: <name of the result> (<meaning>)") for the negative results, which are
// the errors; DeviceLost for that one.
void check(VkResult result, const char* call);

// All items of a Vulkan list: call(&count, items) is called twice, first with null for the items.
template <typename Item, typename Call>
std::vector<Item> enumerate(const char* name, Call call) {
    uint32_t count = 0;
    check(call(&count, nullptr), name);
    std::vector<Item> items(count);
    check(call(&count, items.data()), name);
    items.resize(count);
    return items;
}

// Data that every object of a device needs to destroy itself.
struct DeviceContext {
    VkDevice device = VK_NULL_HANDLE;
    VolkDeviceTable vk{};  // one table a device: two devices may belong to different drivers
    // Set when a submission hangs: waiting for it would hang too, and destroying what it uses is undefined,
    // so everything leaks until the process ends.
    bool abandoned = false;
};

template <typename Object>
class Handle {
  public:
    using Destroy = void(VKAPI_PTR*)(VkDevice, Object, const VkAllocationCallbacks*);

    Handle() = default;
    Handle(const DeviceContext& context, Object object, Destroy destroy)
        : context_(&context), object_(object), destroy_(destroy) {}
    Handle(Handle&& other) noexcept
        : context_(other.context_),
          object_(std::exchange(other.object_, Object{})),
          destroy_(other.destroy_) {}
    Handle& operator=(Handle&& other) noexcept {
        std::swap(context_, other.context_);
        std::swap(object_, other.object_);
        std::swap(destroy_, other.destroy_);
        return *this;
    }
    ~Handle() {
        if (object_ != Object{} && !context_->abandoned) destroy_(context_->device, object_, nullptr);
    }

    Object get() const { return object_; }
    const Object* address() const { return &object_; }
    explicit operator bool() const { return object_ != Object{}; }

  private:
    const DeviceContext* context_ = nullptr;
    Object object_{};
    Destroy destroy_ = nullptr;
};

// Handle from any vkCreate.../vkDestroy... pair (and vkAllocateMemory/vkFreeMemory): they share one shape.
template <typename Object, typename Info>
Handle<Object> create(const DeviceContext& context, const char* call, const Info& info,
                      VkResult(VKAPI_PTR* make)(VkDevice, const Info*, const VkAllocationCallbacks*, Object*),
                      void(VKAPI_PTR* destroy)(VkDevice, Object, const VkAllocationCallbacks*)) {
    Object object{};
    check(make(context.device, &info, nullptr, &object), call);
    return Handle<Object>(context, object, destroy);
}

}  // namespace glint::gpu
