// The arrays of a packed scene on the device. An array that the scene does not have is not uploaded.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "gpu/compute.h"
#include "pack/packed_scene.h"
#include "render/traversal_choice.h"
#include "shared/dispatch.h"

namespace glint::render {

// Bytes of the largest array.
uint64_t largestArray(const PackedScene& scene);

class SceneBuffers {
  public:
    SceneBuffers() = default;
    // Makes what further trees `traversal` needs.
    SceneBuffers(const gpu::Device& device, const PackedScene& scene, gpu::Access access,
                 const TraversalChoice& traversal);

    void setCamera(const gpu::Device& device, const shared::Camera& camera) const;
    void setEnvironment(const gpu::Device& device, const shared::Environment& environment) const;
    // At most as many as there were at construction.
    void setLights(const gpu::Device& device, const std::vector<shared::Light>& lights) const;
    // True if the array had to grow: bind anew. No rows: nothing is done.
    bool setSamples(const gpu::Device& device, std::span<const shared::Sample> rows, gpu::Access access);
    // What to bind at `binding` (2 and up); a stand-in for an absent array, which no shader of the scene's
    // pipelines reads.
    const gpu::Buffer& at(uint32_t binding) const;
    uint64_t bytes() const;

  private:
    std::array<gpu::Buffer, GLINT_BINDING_COUNT> buffers_;
};

}  // namespace glint::render
