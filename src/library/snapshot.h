// A scene as it was committed: nothing changes it, and any number of threads ask it.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/call_terms.h"
#include "library/handles.h"
#include "pack/moving_scene.h"
#include "reference/certain/certain.h"
#include "reference/tracer.h"
#include "render/ray_queries.h"
#include "render/renderer.h"
#include "trace/request.h"

namespace glint::library {

// Parts of an object that may change between commits without a new BVH.
struct Whereabouts {
    std::shared_ptr<const Mesh> mesh;  // null for other shapes
    std::optional<Affine> transform;
    bool operator==(const Whereabouts&) const = default;
};
std::vector<Whereabouts> whereaboutsOf(const Scene& draft);

class Snapshot {
  public:
    // A packed scene, and who traces it. `queries` is null for the reference.
    class Part {
      public:
        Part(const glint_device& device, const Scene& scene, bool split);
        // With arrays of its own. Of `other`, what never changes is read alone.
        Part(const glint_device& device, const Part& other);

        // See MovingScene. Nobody may be asking.
        bool update(const glint_device& device, const Scene& scene, const std::vector<bool>& moved);
        // Made when first asked for; on the reference before that.
        const reference::Tracer& tracer() const;

      private:
        void prepare(const glint_device& device);
        MemoryCharge charge_;  // while the scene is packed, of that too
        MovingScene moving_;
        mutable std::mutex tracerMutex_;
        mutable MemoryCharge tracerCharge_;
        mutable std::unique_ptr<reference::Tracer> tracer_;

      public:
        const PackedScene& packed = moving_.packed();
        std::unique_ptr<render::RayQueries> queries;
    };

    // Packs the scene, which is placed, and on a device uploads it. Throws Error for a scene that cannot be
    // traced. `tree`: a number for the trees built here.
    Snapshot(glint_device* device, Scene placed, std::vector<Whereabouts> whereabouts, uint64_t tree);
    // The same with arrays of its own, to be updated.
    Snapshot(const Snapshot& other, glint_device* device);

    // Makes it the scene placed, which differs from its own in whereabouts and in the camera alone. False if
    // only a new one is as good: then this one is of no use any more. Nobody may be asking. `refits`: in a
    // row, this one included.
    bool update(Scene placed, std::vector<Whereabouts> whereabouts, uint32_t refits);

    const Scene& scene() const { return scene_; }
    const Part& part() const { return part_; }
    // For counts: each triangle stands in the tree once. Made with the first count if it is another.
    const Part& counting() const;
    // For what is certain of nearest hits. Made when first asked for.
    const reference::certain::Tracer& certain() const;
    const std::vector<std::string>& warnings() const { return warnings_; }
    uint64_t triangles() const;
    bool onDevice() const { return part_.queries != nullptr; }
    uint64_t tree() const { return tree_; }
    uint32_t refits() const { return refits_; }

    // One picture at a time.
    Picture render(const shared::Camera& camera, const Request& request) const;

  private:
    DeviceOwner device_;
    Scene scene_;
    std::vector<Whereabouts> whereabouts_;
    uint64_t tree_;
    uint32_t refits_ = 0;
    Part part_;
    std::vector<std::string> warnings_;
    mutable std::mutex countingMutex_, certainMutex_, pictureMutex_;
    mutable std::unique_ptr<Part> counting_;
    mutable std::unique_ptr<reference::certain::Tracer> certain_;
    mutable std::unique_ptr<render::Renderer> renderer_;  // made with the first picture
};

// The version that queries saw before the one that they see now, once the last of them is done: the next
// update fills its arrays again, whose memory and pipelines are there.
class Retired {
  public:
    // An owner of the snapshot that hands it over here when the last of them lets go.
    static std::shared_ptr<const Snapshot> owned(const std::shared_ptr<Retired>& retired,
                                                 std::unique_ptr<Snapshot> snapshot);
    // Null if there is none with these trees. From now on no others are kept.
    std::unique_ptr<Snapshot> take(uint64_t tree);
    // Keeps none any more.
    void close();

  private:
    void put(std::unique_ptr<Snapshot> snapshot);

    std::mutex mutex_;
    std::unique_ptr<Snapshot> kept_;
    uint64_t tree_ = 0;  // of those to keep; 0: none
};

}  // namespace glint::library
