// A packed scene whose vertices and transforms may change: its arrays and boxes follow, its trees stay.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "pack/instances.h"
#include "pack/packed_scene.h"

namespace glint {

class MovingScene {
  public:
    // Packs a scene that is placed (scene/placement.h), as packScene does.
    explicit MovingScene(const Scene& placed, bool split = true, const Context& context = {});

    const PackedScene& packed() const { return packed_; }

    // The BVH is rebuilt if its expected cost (tests per ray) has grown by more than this factor.
    static constexpr double kMostGrowth = 1.3;

    // `scene`: placed, and equal to the packed one except for the camera, transforms, and positions of
    // meshes. moved: for each object, true if its transform or its positions may have changed. Afterwards the
    // arrays equal those of a new packing of `scene`, except for the order and the BVH, so answers to rays
    // keep their bits. False if the scene must be packed again; the arrays are then invalid. Reasons:
    // - the BVH costs kMostGrowth times as much,
    // - the set of triangles without area changes,
    // - something moves that is neither triangles nor an instance nor a plane; in scenes with other kinds,
    //   the camera moves and their rounding depends on it, or the scene's origin moves,
    // - a mesh changes that instances share, or an object becomes an instance or ceases to be one,
    // - materials have textures or transmit light.
    bool update(const Scene& scene, std::vector<bool> moved, const Context& context = {});

  private:
    struct Face {
        uint32_t object, face;
    };
    // Vertices of an object whose triangles lie in the world.
    struct Vertices {
        std::shared_ptr<const std::vector<uint8_t>> used;  // 1: a corner of some triangle
        std::vector<glm::vec3> rounded;                    // relative to the origin; NaN: out of fp32's range
    };
    bool knows(const Scene& scene, const std::vector<bool>& moved) const;
    void measure(const Scene& scene, const std::vector<bool>& moved, const Context& context);
    void followVertices(const Object& object, size_t number, const Context& context);
    bool followOrigin(const Scene& scene, const PrimitiveNumbers& numbers, std::vector<bool>& moved,
                      const Context& context);
    bool droppedStaySo(const Scene& scene, const std::vector<bool>& moved) const;
    bool moveTriangle(const Scene& scene, const PrimitiveNumbers& numbers, uint32_t index);
    bool moveLeaves(const Scene& scene, const PrimitiveNumbers& numbers, const std::vector<bool>& moved,
                    const Context& context);
    void findDropped(const Scene& scene, const PrimitiveNumbers& numbers);

    PackedScene packed_;
    std::optional<Instances> instances_;
    std::vector<uint8_t> kinds_;                       // of each object
    std::vector<std::shared_ptr<const Mesh>> shared_;  // of each object, the mesh that it is an instance of
    std::vector<Vertices> vertices_;                   // of each object
    std::vector<Extent> extents_;                      // of each object, if known
    std::vector<Face> dropped_;                        // triangles that are not packed
    glm::dvec3 eye_{0};
    double builtCost_ = 0;
};

}  // namespace glint
