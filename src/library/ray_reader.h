// Reads the caller's rays into local coordinates and writes hits.
#pragma once

#include <array>

#include "library/snapshot.h"
#include "library/views.h"
#include "trace/ray_batch.h"

namespace glint::library {

class RayReader {
  public:
    // Refuses flags but those of `allowed`.
    RayReader(const glint_rays* rays, const Snapshot& snapshot,
              uint32_t allowed = GLINT_RAYS_COHERENT | GLINT_RAYS_LEAVE);

    uint64_t count() const { return count_; }
    bool coherent() const { return (given_.flags & GLINT_RAYS_COHERENT) != 0; }
    // True if the rays start on surfaces.
    bool leave() const { return (given_.flags & GLINT_RAYS_LEAVE) != 0; }
    WorldRay world(uint64_t i) const;
    // Prefetches ray i.
    void prefetch(uint64_t i) const {
        origins_.prefetch(i);
        directions_.prefetch(i);
    }
    LocalRay local(uint64_t i) const { return localRay(world(i), origin_); }
    // Rounds rays for the device. True if some of them are rescaled (LocalRay::exponent).
    bool rounded(const render::RayNumbers& numbers, std::span<render::RayInput> inputs) const;

  private:
    bool roundedNarrow(const render::RayNumbers& numbers, std::span<render::RayInput> inputs) const;

    glint_rays given_;
    NumberView origins_, directions_;
    std::optional<NumberView> tMin_, tMax_;
    uint64_t count_;
    glm::dvec3 origin_;  // of the scene
};

// The hits of a call that cannot certify them; refuses sure, t_lower and t_upper.
glint_hits uncertified(const glint_hits* hits, const std::string& call);

class HitWriter {
  public:
    // part: the part of the snapshot that the hits refer to.
    HitWriter(const glint_hits& hits, uint64_t count, const Snapshot::Part& part);

    // hit: of a local ray, with hit.primitive kNone on a miss.
    void write(uint64_t i, const LocalRay& ray, const reference::Hit& hit) const;
    // Writes hits of a device. `rescaled`: some of the rays are rescaled.
    void write(const render::RayNumbers& numbers, const render::FoundHits& found, const RayReader& rays,
               bool rescaled) const;
    bool wantsAny() const;

  private:
    // tracer: null if neither names nor surfaces are wanted.
    void write(uint64_t i, const LocalRay& ray, const reference::Hit& hit,
               const reference::Tracer* tracer) const;
    void writeMiss(uint64_t i) const;
    void writeOrigin(uint64_t i, const LocalRay& ray, const reference::Surface& surface) const;
    using Rows = std::array<const shared::TriangleSurface*, render::kRayBlock>;
    void writeTriangles(const render::RayNumbers& numbers, const render::FoundHits& found,
                        const Rows& rows) const;
    void writePlaces(const render::RayNumbers& numbers, const render::FoundHits& found,
                     const Rows& rows) const;
    void writeSurfaces(const render::RayNumbers& numbers, const render::FoundHits& found,
                       const Rows& rows) const;

    const Snapshot::Part& part_;
    Output hit_, t_, geometry_, primitive_, material_, uv_, point_, normal_, origin_;
    bool places_ = false;    // geometry, primitive or material
    bool surfaces_ = false;  // point, normal or origin
};

// The ray for the reference. leaves: it starts on a surface.
inline reference::Ray referenceRay(const LocalRay& ray, bool leaves = false) {
    reference::Ray known{ray.origin, ray.direction, ray.tMin, ray.tMax};
    known.ties = leaves;
    return known;
}

// The context of the device with the callbacks of a call's options, which may be null. Progress is reported
// by one thread at a time and never falls.
Context contextOf(const glint_device& device, const glint_options* options);

// Runs the task with the callbacks of the context. Throws Cancelled.
void runOnDevice(render::RayQueries& queries, render::RayTask task, const Context& context);

// Calls `body` for blocks of 0 ... count - 1 on all processors. Throws Cancelled.
void forBlocks(const Context& context, uint64_t count,
               const std::function<void(uint64_t first, uint64_t end)>& body);

}  // namespace glint::library
