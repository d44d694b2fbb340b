// Vulkan devices: what there is, why each is chosen or refused, and the one that is opened. Knows no scene.
// The Vulkan loader is opened at run time, so a program that links this module starts on a machine without
// Vulkan.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/context.h"
#include "core/error.h"

namespace glint::gpu {

struct DeviceLimits {
    uint64_t maxStorageBufferRange = 0;   // bytes
    uint64_t maxTexelBufferElements = 0;  // texels of 16 bytes
    uint64_t maxAllocationSize = 0;       // bytes, one allocation
    uint64_t memory = 0;                  // bytes of the largest device-local heap
    uint32_t maxWorkgroupInvocations = 0;
    uint32_t maxWorkgroupSizeX = 0;
    uint32_t maxWorkgroupCountX = 0;
    uint32_t maxPushConstantBytes = 0;
    uint32_t maxStorageBuffersPerStage = 0;
    uint32_t maxStorageImagesPerStage = 0;
    uint32_t subgroupSize = 0;
    bool subgroupShuffle = false;  // compute shaders can shuffle, by index and by exclusive or
    double timestampPeriod = 0;    // nanoseconds a tick; 0: no timestamps on the compute queue
};

struct DeviceInfo {
    uint32_t index = 0;     // in the loader's order
    std::string name;       // "llvmpipe (LLVM 15.0.6, 256 bits)"
    std::string type;       // "discrete GPU", "integrated GPU", "virtual GPU", "CPU", "other"
    std::string driver;     // "llvmpipe Mesa 22.3.6 (LLVM 15.0.6)"
    std::string api;        // "1.3.230"
    bool software = false;  // type CPU
    bool llvmpipe = false;  // Mesa's lavapipe, by driver id
    bool usable = false;
    std::string reason;  // why it is usable or refused, one phrase
    DeviceLimits limits;
};

// Extensions and surface of a library that opens windows. Handles are Vulkan's, without its header:
// VkInstance, VkSurfaceKHR.
struct WindowSystem {
    std::vector<std::string> instanceExtensions;
    // Makes the window's surface, which the device then owns. With it, only devices and queues that can
    // present there are usable.
    std::function<uint64_t(void* instance)> makeSurface;
};

struct DeviceOptions {
    std::string selector = {};  // empty: the best; a number: the index; else part of the name, any case
    bool validation = false;   // validation layer with synchronization validation; its messages are collected
    WindowSystem window = {};  // for a device that presents, see swapchain.h
    bool keepPrograms = true;  // a kernel like one that was compiled before is not compiled again
    Context context = {};      // its threads and memory serve all work with the device
};

// The device was reset, or its driver crashed: all that was made from it is void, a new Device may work.
class DeviceLost : public Error {
  public:
    explicit DeviceLost(const std::string& message) : Error(ErrorKind::Device, message) {}
};

// Every device, in the loader's order. Throws Error(Device) if there is no Vulkan loader (naming the Debian
// packages that bring one); an empty list if the loader finds no device.
std::vector<DeviceInfo> listDevices();

// The device that `selector` means. Empty: discrete before integrated before virtual before CPU, then the
// lowest index. Throws Error(Device) with a reason for every device if none is usable, or if the selector
// matches none or only refused ones.
const DeviceInfo& chooseDevice(const std::vector<DeviceInfo>& devices, const std::string& selector);

// Properties that a device showed in 2^16 cases. Most cases lie where the next bit decides: quotients and
// roots next to the middle between two floats, results at and below the least normal float 2^-126, sums that
// leave a tie.
struct Arithmetic {
    // Promised by Vulkan: sums and products of normal floats are correctly rounded, to even, and not fused
    // where SPIR-V forbids it.
    bool sound = false;
    bool denormals = false;  // sums and products below 2^-126 keep their bits
    bool quotients = false;  // correctly rounded; denormal ones too, unless `denormals` is false
    bool roots = false;      // the same of square roots

    // Pictures have the same bits as on any other device of which this is true. Quotients and roots need not
    // be the device's own (shaders/arithmetic.glsl).
    bool sharesBits() const { return sound && denormals; }
    // One phrase about that, for people.
    std::string text() const;
};

struct DeviceState;  // Vulkan handles, see device_state.h

// An open device with one compute queue. Copies are the same device. Everything made from it must be
// destroyed before the last copy.
class Device {
  public:
    explicit Device(const DeviceOptions& options = {});

    const DeviceInfo& info() const;
    const Context& context() const;
    // Computes 2^16 cases at the first call for a device of this name and driver: milliseconds. Throws
    // Error(Device) as any kernel may.
    const Arithmetic& arithmetic() const;
    // Errors and warnings of the validation layer so far; none without DeviceOptions::validation.
    std::vector<std::string> validationMessages() const;
    DeviceState& state() const { return *state_; }

  private:
    std::shared_ptr<DeviceState> state_;
};

}  // namespace glint::gpu
