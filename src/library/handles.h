// Objects behind the opaque handles.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/context.h"
#include "glint/glint.h"
#include "gpu/device.h"
#include "scene/scene.h"

namespace glint::library {

class Snapshot;
class Retired;

// Owns a device.
class DeviceOwner {
  public:
    explicit DeviceOwner(glint_device* device) : device_(device) { glint_device_retain(device); }
    ~DeviceOwner() { glint_device_release(device_); }
    DeviceOwner(const DeviceOwner&) = delete;
    DeviceOwner& operator=(const DeviceOwner&) = delete;
    glint_device& operator*() const { return *device_; }
    glint_device* operator->() const { return device_; }
    glint_device* get() const { return device_; }

  private:
    glint_device* device_;
};

}  // namespace glint::library

struct glint_device {
    // Released last, after the buffers.
    glint_settings settings{};
    glint::Context context;  // threads and memory account of the settings

    std::atomic<uint32_t> owners{1};
    std::optional<glint::gpu::Device> vulkan;  // empty: the reference
    glint_device_info info{};
};

struct glint_scene {
    explicit glint_scene(glint_device* usedDevice);
    ~glint_scene();

    std::atomic<uint32_t> owners{1};
    const glint::library::DeviceOwner device;  // released after all below

    // The scene that changes edit.
    glint::Scene draft;
    std::vector<glint::Affine> added;         // for each object, its transform as it was added
    bool framed = true;                       // there is no camera yet: commit finds one
    bool grown = false;                       // something was added since it was committed
    uint64_t trees = 0;                       // built so far
    std::vector<glint::MemoryCharge> loaded;  // of meshes from files and texts

    // The committed scene that queries read.
    mutable std::mutex mutex;
    std::shared_ptr<const glint::library::Snapshot> committed;
    const std::shared_ptr<glint::library::Retired> retired;
};

namespace glint::library {

// The committed state; throws Failure before the first commit.
std::shared_ptr<const Snapshot> snapshotOf(const glint_scene* scene);

// Makes the draft visible to queries.
void commit(glint_scene& scene, const Context& context);

// Bytes of the arrays of all meshes.
uint64_t meshBytes(const Scene& scene);

// Calls the log of the device's settings, if there is one.
void logLine(const glint_device& device, int32_t level, const std::string& text);

}  // namespace glint::library
