// The primitives and the tree of a scene, or of a prototype of its instances; internal to the packing.
#pragma once

#include <atomic>
#include <vector>

#include "pack/packed_scene.h"
#include "pack/primitives.h"

namespace glint {

// Which materials something packed has; may be used by many threads.
class Materials {
  public:
    explicit Materials(size_t count) : used_(count) {}
    bool used(size_t material) const { return used_[material].load(std::memory_order_relaxed); }
    void use(size_t material) {
        // Read first: many threads writing the same byte would pass its cache line around.
        if (!used(material)) used_[material].store(true, std::memory_order_relaxed);
    }

  private:
    std::vector<std::atomic<bool>> used_;
};

// Fills the arrays of nodes and of what is in the tree, the bounds, the statistics and the warnings.
void packGeometry(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame, uint32_t maxLevels,
                  const PackOptions& options, const Context& context, PackedScene& packed,
                  Materials& materials);

struct Extent;

// The planes, anew. extent: with the camera.
void packPlanes(const Scene& scene, const PrimitiveNumbers& numbers, const Extent& extent,
                PackedScene& packed);

// packScene for a placed scene. `instances`: its instances, still to be placed.
PackedScene packPlaced(const Scene& scene, const PrimitiveNumbers& numbers, Instances& instances,
                       const PackOptions& options, const Context& context);

// True if light passes through some material.
bool anyTransmits(const Scene& scene);

}  // namespace glint
