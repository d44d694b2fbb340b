// Objects that are instances: each prototype is packed once, in its own coordinates, with its own tree.
// Internal to the packing.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "bvh/bvh.h"
#include "pack/packed_scene.h"
#include "pack/primitives.h"
#include "scene/scene.h"

namespace glint {

// A prototype that instances share.
struct Prototype {
    PackedScene geometry;    // arrays, statistics and warnings; local to geometry.origin
    std::vector<Box> boxes;  // of the tree's top, together around everything
};

class Instances {
  public:
    // Packs the prototypes of the objects with a transform, see placeObjects. The world's tree keeps one
    // level for each factor of two in its number of entries and 4 more, at least half of all kDepth; the
    // trees of prototypes get the others.
    Instances(const Scene& scene, const PrimitiveNumbers& numbers, const PackOptions& options,
              const Context& context);

    // Part of the packing time that prototypes take.
    static constexpr double kPrototypesPart = 0.5;

    bool any() const { return !prototypes_.empty(); }
    uint32_t depthOfTop() const { return kDepth - depthOfPrototypes_; }

    // The corners of the box around an instance, in the world; none for one that shows nothing.
    std::vector<glm::dvec3> corners(const Scene& scene, uint32_t object) const;

    // Rounds transforms relative to the origin of the packed scene and boxes the instances.
    void place(const Scene& scene, const PrimitiveNumbers& numbers, const glm::dvec3& origin,
               const Context& context);
    const PlacedInstances& placed() const { return placed_; }

    // Writes the instances' new places, see place(), into the rows of a packed scene after append(). False if
    // the set of instances within the range of fp32 has changed.
    bool move(PackedScene& packed) const;

    // Appends the prototypes' arrays to those of the scene, completes its instances, and sets the distance by
    // which boxes grow for them (Environment::instancePad...).
    void append(PackedScene& packed);
    // First node of the instances.
    size_t firstNode(const PackedScene& packed) const { return any() ? ownNodes_ : packed.nodes.size(); }

  private:
    static constexpr uint32_t kDepth = shared::kMaxBvhDepth;
    const Prototype& prototypeOf(uint32_t object) const {
        return prototypes_[prototype_[placed_.slot[object]]];
    }
    void setPads(PackedScene& packed) const;
    PlacedInstance placedAt(const Scene& scene, uint32_t object, uint32_t id, const glm::dvec3& origin) const;

    std::vector<Prototype> prototypes_;
    std::vector<uint32_t> prototype_;  // of each instance
    std::vector<uint32_t> objects_;    // of each instance
    PlacedInstances placed_;
    uint32_t depthOfPrototypes_ = 0;
    size_t ownNodes_ = 0;  // of the scene that was appended to
};

}  // namespace glint
