// The arrays of a packed scene on the device. Zeros stand in for an array that the scene lacks, because lanes
// without work load element 0 of every array. With Access::StorageBuffer one buffer holds all arrays except
// the samples. It begins with a table: word `binding` is the number of the first texel of that array.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/device_layout.h"
#include "gpu/compute.h"
#include "pack/packed_scene.h"
#include "render/kernel_choice.h"

namespace glint::render {

struct ArraySizes {
    uint64_t largest = 0, sum = 0;  // bytes
};
ArraySizes arraySizes(const PackedScene& scene);

// Texel buffers on llvmpipe, where they load five times faster, and if all arrays exceed one storage buffer;
// otherwise one storage buffer.
gpu::Access chooseAccess(const gpu::DeviceInfo& device, const ArraySizes& sizes);

class SceneBuffers {
  public:
    SceneBuffers() = default;
    // Also builds the 8-wide BVH if `traversal` has packets.
    SceneBuffers(const gpu::Device& device, const PackedScene& scene, gpu::Access access,
                 const TraversalChoice& traversal);

    // Uploads the arrays of a scene with the counts and the topology of the one at construction.
    void update(const PackedScene& scene);

    // lights: at most as many as at construction.
    void setView(const shared::Camera& camera, const shared::Environment& environment,
                 std::span<const shared::Light> lights) const;
    // True if the array had to grow: bind again. Does nothing without rows.
    bool setSamples(std::span<const shared::Sample> rows);
    // Buffer to bind at `binding` (2 and up).
    const gpu::Buffer& at(uint32_t binding) const;
    uint64_t bytes() const;

  private:
    void placeTogether(const std::array<uint64_t, GLINT_BINDING_COUNT>& sizes);
    // Writes the array of that binding.
    void write(uint32_t binding, std::span<const std::byte> data) const;

    const gpu::Device* device_ = nullptr;
    gpu::Access access_ = gpu::Access::TexelBuffer;
    std::vector<uint32_t> packetSlots_;                // see packetTree
    std::vector<shared::PacketCorner> packetCorners_;  // as on the device, from the first update() on
    // By binding. With a storage buffer: the samples, and all other arrays at kTogether.
    std::array<gpu::Buffer, GLINT_BINDING_COUNT> buffers_;
    gpu::Buffer zeros_;
    std::array<uint32_t, GLINT_BINDING_COUNT> first_{};  // texels of the storage buffer
};

}  // namespace glint::render
