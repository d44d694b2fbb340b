// Devices: Vulkan's, and the reference.
#include <algorithm>
#include <atomic>
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

// Empty without a Vulkan loader, which the reference does not need.
std::vector<gpu::DeviceInfo> vulkanDevices() {
    try {
        return gpu::listDevices();
    } catch (const Error&) {
        return {};
    }
}

// Memory limit and callbacks of a device's settings.
class SettingsAccount final : public MemoryAccount {
  public:
    explicit SettingsAccount(const glint_settings& settings) : settings_(settings) {}

    void take(uint64_t bytes) override {
        uint64_t held = held_.load(std::memory_order_relaxed);
        do {
            if (settings_.max_bytes > 0 && bytes > settings_.max_bytes - std::min(held, settings_.max_bytes))
                throw Failure(GLINT_ERROR_MEMORY, std::to_string(bytes) +
                                                      " bytes more are too many: " + std::to_string(held) +
                                                      " are held, and the settings' max_bytes is " +
                                                      std::to_string(settings_.max_bytes));
        } while (!held_.compare_exchange_weak(held, held + bytes));
        if (settings_.memory == nullptr || settings_.memory(settings_.user, static_cast<int64_t>(bytes)) != 0)
            return;
        held_ -= bytes;
        throw Failure(GLINT_ERROR_MEMORY, "the settings' memory callback refused " + std::to_string(bytes) +
                                              " bytes; " + std::to_string(held) + " are held");
    }
    void give(uint64_t bytes) noexcept override {
        held_ -= bytes;
        if (settings_.memory != nullptr) settings_.memory(settings_.user, -static_cast<int64_t>(bytes));
    }

  private:
    const glint_settings settings_;
    std::atomic<uint64_t> held_{0};
};

std::unique_ptr<glint_device> open(const std::string& selector, const glint_settings& settings) {
    auto device = std::make_unique<glint_device>();
    device->settings = settings;
    device->context.threads = settings.threads;
    if (settings.memory != nullptr || settings.max_bytes > 0)
        device->context.account = std::make_shared<SettingsAccount>(settings);
    const std::vector<gpu::DeviceInfo> found = vulkanDevices();
    const std::string last = std::to_string(found.size());
    if (selector == kReferenceName || selector == last) {
        device->info = describeReference(static_cast<uint32_t>(found.size()));
        return device;
    }
    gpu::DeviceOptions options;
    options.selector = selector;
    options.context = device->context;
    device->vulkan.emplace(options);
    device->info = describe(device->vulkan->info());
    return device;
}

}  // namespace

void logLine(const glint_device& device, int32_t level, const std::string& text) {
    if (device.settings.log != nullptr) device.settings.log(device.settings.user, level, text.c_str());
}

}  // namespace glint::library

using namespace glint::library;

glint_status glint_device_count(uint32_t* count) {
    return guarded("glint_device_count", [&] {
        require(count != nullptr, "count is NULL");
        *count = static_cast<uint32_t>(vulkanDevices().size()) + 1;
    });
}

glint_status glint_device_describe(uint32_t index, glint_device_info* info) {
    return guarded("glint_device_describe", [&] {
        const auto found = vulkanDevices();
        if (index > found.size())
            refuse("there is no device " + std::to_string(index) + ", the last is " +
                   std::to_string(found.size()));
        writeStruct(info, index == found.size() ? describeReference(index) : describe(found[index]), "info");
    });
}

glint_status glint_device_open(const char* selector, glint_device** device) {
    return glint_device_open_with(selector, nullptr, device);
}

glint_status glint_device_open_with(const char* selector, const glint_settings* settings,
                                    glint_device** device) {
    return guarded([&] {
        require(device != nullptr, "glint_device_open: device is NULL");
        *device = nullptr;
        const glint_settings given =
            settings == nullptr ? glint_settings{} : readStruct(settings, "glint_device_open_with: settings");
        std::unique_ptr<glint_device> opened = open(selector == nullptr ? "" : selector, given);
        logLine(*opened, GLINT_LOG_INFO, "device: " + std::string(opened->info.name));
        *device = opened.release();
    });
}

glint_status glint_device_info_of(const glint_device* device, glint_device_info* info) {
    return guarded("glint_device_info_of", [&] {
        require(device != nullptr, "device is NULL");
        writeStruct(info, device->info, "info");
    });
}

void glint_device_retain(glint_device* device) {
    if (device != nullptr) device->owners.fetch_add(1, std::memory_order_relaxed);
}

void glint_device_release(glint_device* device) {
    if (device != nullptr && device->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete device;
}
