// A committed scene: immutable, queried by any number of threads.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "library/handles.h"
#include "pack/moving_scene.h"
#include "reference/certain/certain.h"
#include "reference/tracer.h"
#include "render/ray_queries.h"
#include "render/renderer.h"
#include "trace/request.h"

namespace glint::library {

// Parts of an object that may change between commits without a new BVH.
struct ObjectPlacement {
    std::shared_ptr<const Mesh> mesh;  // null for other shapes
    std::optional<Affine> transform;
    bool operator==(const ObjectPlacement&) const = default;
};
std::vector<ObjectPlacement> placementsOf(const Scene& draft);

class Snapshot {
  public:
    // A packed scene and its tracers. `queries` is null for the reference.
    class Part {
      public:
        Part(const glint_device& device, const Context& context, const Scene& scene, bool split);
        // A copy with its own arrays, to be updated.
        Part(const glint_device& device, const Part& other);

        // See MovingScene. No query may be running.
        bool update(const glint_device& device, const Context& context, const Scene& scene,
                    const std::vector<bool>& moved);
        // Made with the first call.
        const reference::Tracer& tracer() const;

      private:
        void prepare(const glint_device& device);
        const Context context_;  // of the device
        MemoryCharge charge_;    // while the scene is packed, of that too
        MovingScene moving_;
        mutable std::mutex tracerMutex_;
        mutable MemoryCharge tracerCharge_;
        mutable std::unique_ptr<reference::Tracer> tracer_;

      public:
        const PackedScene& packed = moving_.packed();
        std::unique_ptr<render::RayQueries> queries;
    };

    // Packs the placed scene and uploads it to a device. Throws Error for a scene that cannot be traced.
    // `tree`: number of the BVH built here.
    Snapshot(glint_device* device, const Context& context, Scene placed,
             std::vector<ObjectPlacement> placements, uint64_t tree);
    // A copy with its own arrays, to be updated.
    Snapshot(const Snapshot& other, glint_device* device);

    // Refits the BVH to `placed`, which differs only in placements and the camera. False if the BVH must be
    // rebuilt; this snapshot is then invalid. No query may be running. `refits`: consecutive refits with this
    // one.
    bool update(const Context& context, Scene placed, std::vector<ObjectPlacement> placements,
                uint32_t refits);

    const glint_device& device() const { return *device_; }
    const Scene& scene() const { return scene_; }
    const Part& part() const { return part_; }
    // For counts: a part whose BVH holds each triangle once. Made with the first call if part() is not such.
    const Part& counting() const;
    // For certified hits. Made with the first call.
    const reference::certain::Tracer& certain() const;
    const std::vector<std::string>& warnings() const { return warnings_; }
    uint64_t triangles() const;
    bool onDevice() const { return part_.queries != nullptr; }
    uint64_t tree() const { return tree_; }
    uint32_t refits() const { return refits_; }

    // Renders one image at a time.
    Picture render(const Request& request) const;

  private:
    DeviceOwner device_;
    Scene scene_;
    std::vector<ObjectPlacement> placements_;
    uint64_t tree_;
    uint32_t refits_ = 0;
    Part part_;
    std::vector<std::string> warnings_;
    mutable std::mutex countingMutex_, certainMutex_, pictureMutex_;
    mutable std::unique_ptr<Part> counting_;
    mutable std::unique_ptr<reference::certain::Tracer> certain_;
    mutable std::unique_ptr<render::Renderer> renderer_;  // made with the first picture
};

// Recycles the previous snapshot once its last query ends: the next update reuses its memory and pipelines.
class Retired {
  public:
    // A shared snapshot that returns here when its last owner releases it.
    static std::shared_ptr<const Snapshot> owned(const std::shared_ptr<Retired>& retired,
                                                 std::unique_ptr<Snapshot> snapshot);
    // The kept snapshot, null if none has this tree. From now on only snapshots of this tree are kept.
    std::unique_ptr<Snapshot> take(uint64_t tree);
    // Keeps no further snapshots.
    void close();

  private:
    void put(std::unique_ptr<Snapshot> snapshot);

    std::mutex mutex_;
    std::unique_ptr<Snapshot> kept_;
    uint64_t tree_ = 0;  // of those to keep; 0: none
};

}  // namespace glint::library
