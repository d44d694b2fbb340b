#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "core/parallel.h"
#include "gpu/device_state.h"

namespace glint::gpu {
namespace {

constexpr uint64_t kTexelBytes = 16;  // VK_FORMAT_R32G32B32A32_UINT

// Whole texels, at least one: an empty array still needs a buffer to bind.
uint64_t texels(uint64_t bytes) {
    return std::max(bytes / kTexelBytes + (bytes % kTexelBytes != 0 ? 1 : 0), uint64_t{1});
}

// In texels, like all comparisons below: a size near 2^64 must not wrap when it is rounded up.
uint64_t largestRange(Access access, const DeviceLimits& limits) {
    return access == Access::StorageBuffer ? limits.maxStorageBufferRange / kTexelBytes
                                           : limits.maxTexelBufferElements;
}

std::string needs(const std::string& name, uint64_t bytes) {
    return "array \"" + name + "\" needs " + std::to_string(bytes) + " bytes";
}

void checkSize(const std::string& name, uint64_t bytes, Access access, const DeviceLimits& limits) {
    if (fits(bytes, access, limits)) return;
    const uint64_t range = largestRange(access, limits);
    std::string text = needs(name, bytes) + ", but this device ";
    if (texels(bytes) > range) {
        text += "binds at most " + std::to_string(range * kTexelBytes) + " bytes as a " +
                (access == Access::StorageBuffer ? "storage buffer" : "texel buffer");
    } else {
        text += "allocates at most " + std::to_string(limits.maxAllocationSize) + " bytes at once";
    }
    throw Error(ErrorKind::Device, text);
}

void createBuffer(BufferState& state, const DeviceState& device) {
    auto info = infoOf<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
    info.size = state.bytes;
    info.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    info.usage |= state.access == Access::StorageBuffer ? VK_BUFFER_USAGE_STORAGE_BUFFER_BIT
                                                        : VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT;
    info.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
    state.buffer =
        create(device, "vkCreateBuffer", info, device.vk.vkCreateBuffer, device.vk.vkDestroyBuffer);
}

void allocate(BufferState& state, const DeviceState& device) {
    VkMemoryRequirements requirements{};
    device.vk.vkGetBufferMemoryRequirements(device.device, state.buffer.get(), &requirements);
    const std::optional<uint32_t> type = chooseMemoryType(device.physical.memory, requirements.memoryTypeBits,
                                                          state.kind, device.physical.unified);
    if (!type) {
        throw Error(ErrorKind::Device,
                    std::string("this device has no ") +
                        (state.kind == MemoryKind::Host ? "host-visible" : "device-local") +
                        " memory for it");
    }
    auto info = infoOf<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
    info.allocationSize = requirements.size;
    info.memoryTypeIndex = *type;
    state.memory =
        create(device, "vkAllocateMemory", info, device.vk.vkAllocateMemory, device.vk.vkFreeMemory);
    check(device.vk.vkBindBufferMemory(device.device, state.buffer.get(), state.memory.get(), 0),
          "vkBindBufferMemory");

    if (isMappable(device.physical.memory.memoryTypes[*type].propertyFlags) &&
        (state.kind == MemoryKind::Host || device.physical.unified)) {
        void* host = nullptr;
        check(device.vk.vkMapMemory(device.device, state.memory.get(), 0, VK_WHOLE_SIZE, 0, &host),
              "vkMapMemory");
        state.host = static_cast<std::byte*>(host);
    }
}

void createView(BufferState& state, const DeviceState& device) {
    auto info = infoOf<VkBufferViewCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO);
    info.buffer = state.buffer.get();
    info.format = VK_FORMAT_R32G32B32A32_UINT;
    info.range = VK_WHOLE_SIZE;
    state.view = create(device, "vkCreateBufferView", info, device.vk.vkCreateBufferView,
                        device.vk.vkDestroyBufferView);
}

// Most of the time of a large copy goes into pages that are touched for the first time; several threads
// touch them in parallel.
void copy(const Context& context, std::byte* to, const std::byte* from, size_t bytes) {
    constexpr size_t kPiece = size_t{4} << 20;
    parallelFor(context, (bytes + kPiece - 1) / kPiece, [&](size_t piece) {
        const size_t first = piece * kPiece;
        std::memcpy(to + first, from + first, std::min(kPiece, bytes - first));
    });
}

// Calls use(stage, done, bytes) for one piece after the other of a copy through the staging buffer.
template <typename Use>
void eachStagedPiece(const Device& device, uint64_t bytes, Use use) {
    DeviceState& state = device.state();
    const std::lock_guard lock(state.stagingMutex);
    if (!state.staging) {
        state.staging = std::make_unique<Staging>(
            Staging{Buffer(device, "staging", state.stagingBytes, Access::StorageBuffer, MemoryKind::Host),
                    Submission(device)});
    }
    for (uint64_t done = 0; done < bytes;) {
        const uint64_t piece = std::min(bytes - done, state.staging->buffer.size());
        use(*state.staging, done, piece);
        done += piece;
    }
}

}  // namespace

bool fits(uint64_t bytes, Access access, const DeviceLimits& limits) {
    return texels(bytes) <= std::min(largestRange(access, limits), limits.maxAllocationSize / kTexelBytes);
}

void checkRange(const char* what, const Buffer& buffer, uint64_t offset, uint64_t bytes) {
    if (offset <= buffer.size() && bytes <= buffer.size() - offset) return;
    throw Error(ErrorKind::Device, std::string(what) + " of " + std::to_string(bytes) + " bytes at offset " +
                                       std::to_string(offset) + " passes the end of array \"" +
                                       buffer.state().name + "\" (" + std::to_string(buffer.size()) +
                                       " bytes)");
}

Buffer::Buffer(const Device& device, const std::string& name, uint64_t bytes, Access access,
               MemoryKind memory)
    : state_(std::make_shared<BufferState>()) {
    checkSize(name, bytes, access, device.info().limits);
    const DeviceState& owner = device.state();
    state_->device = &owner;
    state_->name = name;
    state_->bytes = texels(bytes) * kTexelBytes;
    state_->access = access;
    state_->kind = memory;
    state_->charge = device.context().charge(state_->bytes);
    try {
        createBuffer(*state_, owner);
        allocate(*state_, owner);
        if (access == Access::TexelBuffer) createView(*state_, owner);
    } catch (const Error& error) {
        throw Error(error.kind(), needs(name, state_->bytes) + ", but " + error.what());
    }
}

uint64_t Buffer::size() const {
    return state_->bytes;
}
void* Buffer::mapped() const {
    return state_->kind == MemoryKind::Host ? state_->host : nullptr;
}

void upload(const Device& device, const Buffer& destination, std::span<const std::byte> data,
            uint64_t offset) {
    checkRange("an upload", destination, offset, data.size());
    if (data.empty()) return;
    if (std::byte* host = destination.state().host) {
        copy(device.context(), host + offset, data.data(), data.size());
        return;
    }
    eachStagedPiece(device, data.size(), [&](Staging& stage, uint64_t done, uint64_t bytes) {
        std::memcpy(stage.buffer.mapped(), data.data() + done, bytes);
        stage.submission.copy(stage.buffer, 0, destination, offset + done, bytes);
        stage.submission.submit();
    });
}

void download(const Device& device, const Buffer& source, std::span<std::byte> data, uint64_t offset) {
    checkRange("a download", source, offset, data.size());
    if (data.empty()) return;
    if (const std::byte* host = source.state().host) {
        copy(device.context(), data.data(), host + offset, data.size());
        return;
    }
    eachStagedPiece(device, data.size(), [&](Staging& stage, uint64_t done, uint64_t bytes) {
        stage.submission.copy(source, offset + done, stage.buffer, 0, bytes);
        stage.submission.submit();
        std::memcpy(data.data() + done, stage.buffer.mapped(), bytes);
    });
}

}  // namespace glint::gpu
