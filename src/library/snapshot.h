// A scene as it was committed: nothing changes it, and any number of threads ask it.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "library/handles.h"
#include "pack/packed_scene.h"
#include "reference/tracer.h"
#include "render/ray_queries.h"
#include "render/renderer.h"
#include "trace/request.h"

namespace glint::library {

class Snapshot {
  public:
    // A packed scene, and who traces it. `queries` is null for the reference.
    struct Part {
        Part(const glint_device& device, PackedScene scene);
        PackedScene packed;
        reference::Tracer tracer;
        std::unique_ptr<render::RayQueries> queries;
    };

    // Packs the scene, and on a device uploads it. Throws Error for a scene that cannot be traced.
    Snapshot(glint_device* device, Scene scene);

    const Scene& scene() const { return scene_; }
    const Part& part() const { return part_; }
    // For counts: each triangle stands in the tree once. Made with the first count if it is another.
    const Part& counting() const;
    const std::vector<std::string>& warnings() const { return warnings_; }
    uint64_t triangles() const;
    bool onDevice() const { return part_.queries != nullptr; }

    // One picture at a time.
    Picture render(const shared::Camera& camera, const Request& request) const;

  private:
    DeviceOwner device_;
    Scene scene_;
    Part part_;
    std::vector<std::string> warnings_;
    mutable std::mutex countingMutex_, pictureMutex_;
    mutable std::unique_ptr<Part> counting_;
    mutable std::unique_ptr<render::Renderer> renderer_;  // made with the first picture
};

}  // namespace glint::library
