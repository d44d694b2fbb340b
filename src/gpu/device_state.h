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
#include <vector>

#include "gpu/compute.h"
#include "gpu/device.h"
#include "gpu/handle.h"
#include "gpu/instance.h"

namespace glint::gpu {

// ---- choices from plain data (choose.cpp) ----

// The family to compute on: one that does nothing else, so that the desktop's drawing does not wait behind a
// dispatch, then any; of those, one with timestamps before one without. `presents`: a flag for each family,
// only those that are set come into question; empty: all.
std::optional<uint32_t> chooseQueueFamily(std::span<const VkQueueFamilyProperties> families,
                                          std::span<const VkBool32> presents = {});

// Missing capability of a device, as a phrase; empty if glint runs on the device. `apiVersion` is the
// device's.
std::string refusal(uint32_t apiVersion, bool hasComputeQueue, const DeviceLimits& limits);

// The memory type among `allowedTypes` (a bit for each). Device: device-local; `unified` says that the host
// reaches such memory at no cost, so visible types come first there and last elsewhere, where they are a
// scarce window (256 MiB BAR). Host: visible and coherent, cached if there is such a type, because results
// are read back from it.
std::optional<uint32_t> chooseMemoryType(const VkPhysicalDeviceMemoryProperties& memory,
                                         uint32_t allowedTypes, MemoryKind kind, bool unified);

// ---- what Vulkan says about a physical device (query.cpp) ----

struct PhysicalDevice {
    VkPhysicalDevice handle = VK_NULL_HANDLE;
    DeviceInfo info;
    uint32_t queueFamily = 0;        // valid if info.usable
    uint32_t timestampBits = 0;      // of that family
    bool portabilitySubset = false;  // VK_KHR_portability_subset must then be enabled
    bool unified = false;            // CPU or integrated
    VkPhysicalDeviceMemoryProperties memory{};
};

// With a surface, devices that cannot present to it are refused.
std::vector<PhysicalDevice> queryDevices(const Instance& instance, VkSurfaceKHR surface = VK_NULL_HANDLE);

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

// A command buffer, recorded again for each submission.
struct Commands {
    Handle<VkCommandPool> pool;
    VkCommandBuffer buffer = VK_NULL_HANDLE;

    Commands() = default;
    explicit Commands(const DeviceState& device);
    void begin(const DeviceState& device);
};

struct SubmissionState {
    DeviceState* device = nullptr;
    Commands commands;
    Handle<VkQueryPool> timestamps;  // none without timestamps
    Handle<VkFence> fence;
    bool recording = false;
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
    void closeDevice();

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
    // a minute means that nothing will come.
    uint64_t timeoutNanoseconds = 60'000'000'000;
    // Amortises the cost of a submission (tens of microseconds) and stays small beside the scenes that need
    // it.
    uint64_t stagingBytes = uint64_t{32} << 20;
};

}  // namespace glint::gpu
