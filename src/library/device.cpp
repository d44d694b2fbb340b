// Devices: Vulkan's, and the reference as one more.
#include <algorithm>
#include <cstdio>

#include "library/handles.h"
#include "library/status.h"

namespace glint::library {

namespace {

constexpr const char* kReferenceName = "cpu";

template <size_t Size>
void copyText(char (&to)[Size], const std::string& text) {
    std::snprintf(to, Size, "%s", text.c_str());
}

glint_device_info describe(const gpu::DeviceInfo& device) {
    glint_device_info info{};
    info.index = device.index;
    info.usable = device.usable;
    info.software = device.software;
    copyText(info.name, device.name);
    copyText(info.reason, device.reason);
    return info;
}

glint_device_info describeReference(uint32_t index) {
    glint_device_info info{};
    info.index = index;
    info.usable = 1;
    info.reference = 1;
    copyText(info.name, kReferenceName);
    copyText(info.reason, "the reference in double precision, on the processor");
    return info;
}

// None without a Vulkan loader: the reference needs none.
std::vector<gpu::DeviceInfo> vulkanDevices() {
    try {
        return gpu::listDevices();
    } catch (const Error&) {
        return {};
    }
}

std::unique_ptr<glint_device> open(const std::string& selector) {
    auto device = std::make_unique<glint_device>();
    const std::vector<gpu::DeviceInfo> found = vulkanDevices();
    const std::string last = std::to_string(found.size());
    if (selector == kReferenceName || selector == last) {
        device->info = describeReference(static_cast<uint32_t>(found.size()));
        return device;
    }
    gpu::DeviceOptions options;
    options.selector = selector;
    device->vulkan.emplace(options);
    device->info = describe(device->vulkan->info());
    return device;
}

}  // namespace

}  // namespace glint::library

using namespace glint::library;

glint_status glint_device_count(uint32_t* count) {
    return guarded([&] {
        require(count != nullptr, "glint_device_count: count is NULL");
        *count = static_cast<uint32_t>(vulkanDevices().size()) + 1;
    });
}

glint_status glint_device_describe(uint32_t index, glint_device_info* info) {
    return guarded([&] {
        const auto found = vulkanDevices();
        if (index > found.size())
            refuse("glint_device_describe: there is no device " + std::to_string(index) + ", the last is " +
                   std::to_string(found.size()));
        writeStruct(info, index == found.size() ? describeReference(index) : describe(found[index]),
                    "glint_device_describe: info");
    });
}

glint_status glint_device_open(const char* selector, glint_device** device) {
    return guarded([&] {
        require(device != nullptr, "glint_device_open: device is NULL");
        *device = nullptr;
        *device = open(selector == nullptr ? "" : selector).release();
    });
}

glint_status glint_device_info_of(const glint_device* device, glint_device_info* info) {
    return guarded([&] {
        require(device != nullptr, "glint_device_info_of: device is NULL");
        writeStruct(info, device->info, "glint_device_info_of: info");
    });
}

void glint_device_retain(glint_device* device) {
    if (device != nullptr) device->owners.fetch_add(1, std::memory_order_relaxed);
}

void glint_device_release(glint_device* device) {
    if (device != nullptr && device->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete device;
}
