// Blocking copies between host arrays and buffers.
#include <algorithm>
#include <cstring>

#include "core/parallel.h"
#include "gpu/device_state.h"

namespace glint::gpu {
namespace {

// Pages that nobody has touched are most of the time of a large copy; several threads touch them side by
// side.
void copy(const Context& context, std::byte* to, const std::byte* from, size_t bytes) {
    constexpr size_t kPiece = size_t{4} << 20;
    parallelFor(context, (bytes + kPiece - 1) / kPiece, [&](size_t piece) {
        const size_t first = piece * kPiece;
        std::memcpy(to + first, from + first, std::min(kPiece, bytes - first));
    });
}

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
        copy(device.context(), host + offset, data.data(), data.size());
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
        copy(device.context(), data.data(), host + offset, data.size());
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
