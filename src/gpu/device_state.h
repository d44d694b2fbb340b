// Private to src/gpu and its tests: the Vulkan objects behind the public types, and the choices made from
// plain data.
#pragma once

#include <volk.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gpu/compute.h"
#include "gpu/device.h"

namespace glint::gpu {

// ---- calls of Vulkan, and ownership of its objects ----

// Throws Error(Device, "<call> failed: <name of the result> (<meaning>)") for the negative results, which are
// the errors; DeviceLost for that one.
void check(VkResult result, const char* call);

// All items of a Vulkan list: get(arguments..., &count, items) is called twice, first with null for the
// items.
template <typename Item, typename Get, typename... Arguments>
std::vector<Item> enumerate(const char* name, Get get, Arguments... arguments) {
    uint32_t count = 0;
    check(get(arguments..., &count, nullptr), name);
    std::vector<Item> items(count);
    check(get(arguments..., &count, items.data()), name);
    items.resize(count);
    return items;
}

// An empty structure with its sType set.
template <typename Info>
Info infoOf(VkStructureType type) {
    Info info{};
    info.sType = type;
    return info;
}

// Data that every object of a device needs to destroy itself.
struct DeviceContext {
    VkDevice device = VK_NULL_HANDLE;
    VolkDeviceTable vk{};  // one table a device: two devices may belong to different drivers
    // Set when a submission hangs: waiting for it would hang too, and destroying its objects is undefined, so
    // everything leaks until the process ends.
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

// ---- an instance, and the messages of its validation layer (instance.cpp) ----

bool contains(const std::vector<VkExtensionProperties>& extensions, const char* name);

// Filled from whichever thread the layer calls back on.
class ValidationLog {
  public:
    void add(std::string message) {
        const std::lock_guard lock(mutex_);
        messages_.push_back(std::move(message));
    }
    std::vector<std::string> messages() const {
        const std::lock_guard lock(mutex_);
        return messages_;
    }

  private:
    mutable std::mutex mutex_;
    std::vector<std::string> messages_;
};

// Each instance enables VK_KHR_surface and VK_EXT_debug_utils where present, so that volk's functions, which
// are the loader's own and loaded with the first instance, serve every instance.
class Instance {
  public:
    // With `log`, the validation layer is loaded and writes there; `log` must outlive the instance. Throws
    // Error(Device) if there is no loader, or if that layer or one of `wantedExtensions` is missing.
    explicit Instance(ValidationLog* log, const std::vector<std::string>& wantedExtensions = {});
    ~Instance();
    Instance(const Instance&) = delete;
    Instance& operator=(const Instance&) = delete;

    VkInstance get() const { return instance_; }
    std::vector<VkPhysicalDevice> physicalDevices() const;  // in the loader's order

  private:
    VkInstance instance_ = VK_NULL_HANDLE;  // null: the loader found no driver
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

// ---- choices from plain data (physical_device.cpp) ----

// The family to compute on: one that does nothing else, so that the desktop's drawing does not wait behind a
// dispatch, then any; of those, one with timestamps before one without. `presents`: a flag for each family,
// only those that are set come into question; empty: all.
std::optional<uint32_t> chooseQueueFamily(std::span<const VkQueueFamilyProperties> families,
                                          std::span<const VkBool32> presents = {});

// Missing capability of a device, as a phrase; empty if glint runs on the device. `apiVersion` is the
// device's.
std::string refusal(uint32_t apiVersion, bool hasComputeQueue, const DeviceLimits& limits);

// Memory that the host can map, and that needs no flushing.
inline bool isMappable(VkMemoryPropertyFlags flags) {
    constexpr VkMemoryPropertyFlags kMappable =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    return (flags & kMappable) == kMappable;
}

// The memory type among `allowedTypes` (a bit for each). Device: device-local. If the host reaches such
// memory at no cost (`unified`), visible types come first, else last, because they are then a scarce window
// (256 MiB BAR). Host: visible and coherent, cached if there is such a type, because results are read back
// from it.
std::optional<uint32_t> chooseMemoryType(const VkPhysicalDeviceMemoryProperties& memory,
                                         uint32_t allowedTypes, MemoryKind kind, bool unified);

// ---- queries of physical devices (physical_device.cpp) ----

struct PhysicalDevice {
    VkPhysicalDevice handle = VK_NULL_HANDLE;
    DeviceInfo info;
    uint32_t queueFamily = 0;    // valid if info.usable
    uint32_t timestampBits = 0;  // of that family
    bool unified = false;        // CPU or integrated
    VkPhysicalDeviceMemoryProperties memory{};
};

// With a surface, devices that cannot present to it are refused.
std::vector<PhysicalDevice> queryDevices(const Instance& instance, VkSurfaceKHR surface = VK_NULL_HANDLE);

// ---- cases of the arithmetic of a device (probe.cpp) ----

// Three rows of shaders/probe.comp.
struct ProbeCase {
    struct Given {
        float a = 0, b = 0, c = 0, unused = 0;
    };
    struct Found {
        float sum = 0, product = 0, both = 0, unused0 = 0, quotient = 0, root = 0, unused1 = 0, unused2 = 0;
    };
    Given given;
    Found found;
};
static_assert(sizeof(ProbeCase) == 48);

// 2^16, the same on every machine.
std::vector<ProbeCase> probeCases();
Arithmetic judged(std::span<const ProbeCase> cases);

// ---- states of the public types ----

struct BufferState {
    MemoryCharge charge;
    const DeviceState* device = nullptr;
    std::string name;
    VkDeviceSize bytes = 0;
    Access access = Access::StorageBuffer;
    MemoryKind kind = MemoryKind::Device;
    // Destroyed from the last to the first: view, buffer, memory.
    Handle<VkDeviceMemory> memory;
    Handle<VkBuffer> buffer;
    Handle<VkBufferView> view;  // TexelBuffer only
    std::byte* host = nullptr;  // persistent mapping, of Device memory too where `unified`
};

// Throws Error(Device) if `bytes` at `offset` pass the end of the buffer; `what` begins the sentence ("an
// upload").
void checkRange(const char* what, const Buffer& buffer, uint64_t offset, uint64_t bytes);

// Input of a kernel's compilation (ProgramKey) and its result (Program).
struct ProgramKey {
    std::vector<uint32_t> spirv;
    std::vector<Access> bindings;
    std::vector<uint32_t> constants;
    uint32_t pushConstantBytes = 0;
    bool operator==(const ProgramKey&) const = default;
};
struct Program {
    ProgramKey key;
    uint64_t codeBytes = 0;  // of the specialized SPIR-V
    Handle<VkDescriptorSetLayout> setLayout;
    Handle<VkPipelineLayout> layout;
    Handle<VkPipeline> pipeline;
};

struct KernelState {
    const DeviceState* device = nullptr;
    std::string name;
    std::shared_ptr<const Program> program;
    Handle<VkDescriptorPool> pool;  // none if there are no bindings
    VkDescriptorSet set = VK_NULL_HANDLE;
};

// A command buffer, recorded again for each submission, and its fence, signaled before the first submission.
struct Commands {
    DeviceState& device;
    Handle<VkCommandPool> pool;
    VkCommandBuffer buffer = VK_NULL_HANDLE;
    Handle<VkFence> fence;

    explicit Commands(DeviceState& owner);
    void begin();
    // Ends the commands and submits them. `info` has the semaphores.
    void submit(VkSubmitInfo info = infoOf<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO));
    // Waits for the last submission. Throws Error(Device) and abandons the device if it hangs.
    void wait();
};

struct SubmissionState {
    DeviceState& device;
    Commands commands;
    Handle<VkQueryPool> timestamps;  // none without timestamps
    bool recording = false;

    explicit SubmissionState(DeviceState& owner);
};

struct Staging {
    Buffer buffer;
    Submission submission;
};

struct DeviceState : DeviceContext {
    DeviceState() = default;
    ~DeviceState();
    DeviceState(const DeviceState&) = delete;
    DeviceState& operator=(const DeviceState&) = delete;

    // Null without validation. Shared, so that a test can read the messages of the device's destruction.
    std::shared_ptr<ValidationLog> log;
    std::unique_ptr<Instance> instance;
    Context context;
    VkSurfaceKHR surface = VK_NULL_HANDLE;  // null for a device that does not present
    PhysicalDevice physical;
    VkQueue queue = VK_NULL_HANDLE;
    std::mutex queueMutex;  // a queue is externally synchronised (Vulkan 1.1, section 3.6)
    Handle<VkPipelineCache> pipelineCache;

    // The programs used last, newest first. lavapipe's VkPipelineCache keeps nothing (Mesa 22.3.6), so
    // rendering many scenes would compile the same kernels each time, 0.1 to 4 s. Compared whole: a
    // program is never taken for another.
    std::mutex programsMutex;
    std::vector<std::shared_ptr<const Program>> programs;
    static constexpr size_t kKeptPrograms = 64;
    bool keepsPrograms = true;

    std::mutex stagingMutex;
    std::unique_ptr<Staging> staging;  // made at the first transfer that needs it

    // A dispatch is sized to last well under a second, and desktop drivers reset a device after 2 to 10 s, so
    // a minute means that nothing will come. A software device shares the processors with other programs, so
    // that a short batch may take minutes of elapsed time (lavapipe compiled a kernel in 3 s of processor
    // time and in more than a minute at a load of 28).
    uint64_t timeoutSeconds() const { return physical.info.software ? 600 : 60; }
    // Amortises the cost of a submission (tens of microseconds) and stays small beside the scenes that need
    // it.
    uint64_t stagingBytes = uint64_t{32} << 20;
};

}  // namespace glint::gpu
