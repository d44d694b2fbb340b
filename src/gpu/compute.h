// Buffers, kernels and submissions on an open device.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/enum_names.h"
#include "gpu/device.h"

namespace glint::gpu {

// A buffer's type in shaders: a storage buffer of uvec4, or a storage texel buffer of format rgba32ui. On
// lavapipe an imageLoad from the latter costs a fifth of a storage buffer load.
enum class Access { StorageBuffer, TexelBuffer };
constexpr auto entriesOf(Access) {
    return std::to_array<EnumEntry<Access>>(
        {{Access::StorageBuffer, "storage"}, {Access::TexelBuffer, "texel"}});
}

enum class MemoryKind {
    Device,  // fastest for the device; filled by upload(), read by download()
    Host     // visible to both and coherent; mapped() is valid
};

struct BufferState;

// Copies are the same buffer. `name` is what messages call it. Sizes are rounded up to 16 bytes, never zero.
class Buffer {
  public:
    Buffer() = default;
    // Throws Error(Device), naming the array, its size and the limit, if `bytes` passes what `access` or the
    // device allows, or if memory runs out.
    Buffer(const Device& device, const std::string& name, uint64_t bytes, Access access, MemoryKind memory);

    explicit operator bool() const { return state_ != nullptr; }
    uint64_t size() const;
    void* mapped() const;  // MemoryKind::Host only, else nullptr
    BufferState& state() const { return *state_; }

  private:
    std::shared_ptr<BufferState> state_;
};

// True if a buffer of `bytes` can be bound with `access` on `limits`.
bool fits(uint64_t bytes, Access access, const DeviceLimits& limits);

// Blocking copies, in pieces through a staging buffer of bounded size where the memory is not visible to the
// host.
void upload(const Device& device, const Buffer& destination, std::span<const std::byte> data,
            uint64_t offset = 0);
void download(const Device& device, const Buffer& source, std::span<std::byte> data, uint64_t offset = 0);

// The bytes of one value: of push constants, or of an array with one element.
template <typename Value>
std::span<const std::byte> bytesOf(const Value& value) {
    return std::as_bytes(std::span(&value, 1));
}

struct KernelOptions {
    std::string name = {};                 // for messages
    std::span<const uint32_t> spirv = {};  // entry point "main"
    std::vector<Access> bindings = {};     // set 0, binding i
    std::vector<uint32_t> constants = {};  // specialization constant i has value constants[i] (bool: 0 or 1)
    uint32_t pushConstantBytes = 0;        // multiple of 4, at most limits.maxPushConstantBytes
};

struct KernelState;

// A compute pipeline and its descriptor set. Copies are the same kernel.
class Kernel {
  public:
    Kernel() = default;
    Kernel(const Device& device, const KernelOptions& options);

    // Binds buffers[i], with the access in KernelOptions, to binding i. Call before the first dispatch, and
    // not during a submission.
    void bind(std::span<const Buffer* const> buffers);
    explicit operator bool() const { return state_ != nullptr; }
    uint64_t codeBytes() const;  // of SPIR-V, as the driver was given it
    KernelState& state() const { return *state_; }

  private:
    std::shared_ptr<KernelState> state_;
};

struct SubmissionState;

// Records dispatches, submits them as one batch, waits. A memory barrier between any two dispatches makes the
// writes of one visible to the next, and the host can read Host buffers afterwards. Reusable after submit().
// Copies are the same submission.
class Submission {
  public:
    explicit Submission(const Device& device);

    // `pushConstants` must have the size in KernelOptions.
    void dispatch(const Kernel& kernel, uint32_t groupsX, std::span<const std::byte> pushConstants);
    void copy(const Buffer& source, uint64_t sourceOffset, const Buffer& destination,
              uint64_t destinationOffset, uint64_t bytes);

    struct Times {
        double wall = 0;    // seconds from submit to fence
        double device = 0;  // seconds between timestamps around the batch; 0 without timestamps
    };
    // Throws Error(Device) on a lost device or any Vulkan failure, naming the call and the result.
    Times submit();

  private:
    std::shared_ptr<SubmissionState> state_;
};

}  // namespace glint::gpu
