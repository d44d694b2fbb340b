// The arrays of a packed scene on the device. An array that the scene does not have is not uploaded: in its
// place is one of zeros, which has no texture, no medium and nothing else, for kernels that look up number 0
// of everything where they have no work. With Access::StorageBuffer one buffer holds all arrays but the
// samples. It begins with a table: word `binding` is the number of the first texel of that array.
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

// Texel buffers on llvmpipe, where they load five times faster, and where one storage buffer is too small for
// all arrays; one storage buffer otherwise.
gpu::Access chooseAccess(const gpu::DeviceInfo& device, const ArraySizes& sizes);

class SceneBuffers {
  public:
    SceneBuffers() = default;
    // Makes what further trees `traversal` needs.
    SceneBuffers(const gpu::Device& device, const PackedScene& scene, gpu::Access access,
                 const TraversalChoice& traversal);

    // The arrays of a scene that differs from the one at construction in numbers alone: as many of
    // everything, and the same children of each node.
    void update(const PackedScene& scene);

    // Lights: at most as many as there were at construction.
    void setView(const shared::Camera& camera, const shared::Environment& environment,
                 std::span<const shared::Light> lights) const;
    // True if the array had to grow: bind it again. Does nothing without rows.
    bool setSamples(std::span<const shared::Sample> rows);
    // Buffer to bind at `binding` (2 and up).
    const gpu::Buffer& at(uint32_t binding) const;
    uint64_t bytes() const;

  private:
    void placeTogether(const std::array<uint64_t, GLINT_BINDING_COUNT>& sizes);
    // Into the array of that binding.
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
