// Blocking copies between host arrays and buffers.
#include <algorithm>
#include <cstring>

#include "gpu/device_state.h"

namespace glint::gpu {
namespace {

Staging& staging(const Device& device) {
    DeviceState& state = device.state();
    if (!state.staging) {
        state.staging = std::make_unique<Staging>(
            Staging{Buffer(device, "staging", state.stagingBytes, Access::StorageBuffer, MemoryKind::Host),
                    Submission(device)});
    }
    return *state.staging;
}

}  // namespace

void upload(const Device& device, const Buffer& destination, std::span<const std::byte> data,
            uint64_t offset) {
    checkRange("an upload", destination, offset, data.size());
    if (data.empty()) return;
    if (std::byte* host = destination.state().host) {
        std::memcpy(host + offset, data.data(), data.size());
        return;
    }
    const std::lock_guard lock(device.state().stagingMutex);
    Staging& stage = staging(device);
    for (uint64_t done = 0; done < data.size();) {
        const uint64_t piece = std::min<uint64_t>(data.size() - done, stage.buffer.size());
        std::memcpy(stage.buffer.mapped(), data.data() + done, piece);
        stage.submission.copy(stage.buffer, 0, destination, offset + done, piece);
        stage.submission.submit();
        done += piece;
    }
}

void download(const Device& device, const Buffer& source, std::span<std::byte> data, uint64_t offset) {
    checkRange("a download", source, offset, data.size());
    if (data.empty()) return;
    if (const std::byte* host = source.state().host) {
        std::memcpy(data.data(), host + offset, data.size());
        return;
    }
    const std::lock_guard lock(device.state().stagingMutex);
    Staging& stage = staging(device);
    for (uint64_t done = 0; done < data.size();) {
        const uint64_t piece = std::min<uint64_t>(data.size() - done, stage.buffer.size());
        stage.submission.copy(source, offset + done, stage.buffer, 0, piece);
        stage.submission.submit();
        std::memcpy(data.data() + done, stage.buffer.mapped(), piece);
        done += piece;
    }
}

}  // namespace glint::gpu
