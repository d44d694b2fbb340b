// Queries of a caller's rays: the closest hit, any hit, the number of crossings, or the closest primitive,
// without shading. `glint trace` and libglint use them.
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "gpu/compute.h"
#include "pack/packed_scene.h"
#include "render/kernel_choice.h"
#include "render/path_state.h"
#include "render/ray_order.h"
#include "trace/ray_batch.h"

namespace glint::render {

struct FoundHit {
    float t = 0, u = 0, v = 0;  // of triangles as in reference::Hit; u of a quadric: side of its root
    uint32_t primitive = shared::kNone;  // kind and index; kNone: a miss
    uint32_t instance = shared::kNone;   // of the primitive
    // Query::Count alone: number of surfaces crossed. doubtful: rounding decides whether one of them lies
    // before the origin.
    uint32_t crossings = 0;
    bool doubtful = false;
};

// Hits of consecutive rays, read where the device wrote them.
class FoundHits {
  public:
    // instances: null if the scene has none.
    FoundHits(const RowEntry* hits, const RowEntry* instances, size_t count, bool counted)
        : hits_(hits), instances_(instances), count_(count), counted_(counted) {}

    size_t size() const { return count_; }
    uint32_t primitive(size_t i) const { return counted_ ? shared::kNone : hits_[i].u[3]; }
    uint32_t instance(size_t i) const { return instances_ != nullptr ? instances_[i].u[0] : shared::kNone; }
    float t(size_t i) const { return hits_[i].f[0]; }
    float u(size_t i) const { return hits_[i].f[1]; }
    float v(size_t i) const { return hits_[i].f[2]; }
    FoundHit operator[](size_t i) const {
        if (counted_) return {.crossings = hits_[i].u[1], .doubtful = hits_[i].u[2] != 0};
        return {t(i), u(i), v(i), primitive(i), instance(i)};
    }

  private:
    const RowEntry* hits_;
    const RowEntry* instances_;
    size_t count_;
    bool counted_;
};

// `fill` and `take` are called for blocks of at most kRayBlock rays, from several threads at a time.
struct RayTask {
    size_t count = 0;
    ReadRays fill;  // local rays; also called for samples of them
    std::function<void(const RayNumbers& numbers, const FoundHits& hits)> take;
    // Closest: the closest hit. Any: FoundHit::primitive of an arbitrary hit. Count: FoundHit::crossings, of
    // a scene packed without split triangles. Point: the triangle or sphere closest to the ray's origin;
    // FoundHit::t is its squared distance.
    enum class Query { Closest, Any, Count, Point } query = Query::Closest;
    Methods methods = {};
    bool leaves = false;                   // rays start on surfaces (docs/design/numerics.md)
    bool coherent = false;                 // the caller declares neighbours similar
    std::function<bool()> cancelled;       // called between pieces; may be empty
    std::function<void(double)> progress;  // the fraction done; may be empty
    BatchTimes* kernels = nullptr;         // receives the device's time in addition; may be null
};

// The callbacks of RayQueries::list: fill the rays from `first` on, and take the crossings of ray i.
using ListFill = std::function<void(size_t first, std::span<RayInput> rays)>;
using ListTake = std::function<void(size_t i, std::span<const FoundHit> hits)>;

// The answer for a ray does not depend on the other rays. Thread-safe; threads take turns at the device.
class RayQueries {
  public:
    // Keeps references to all three. Traversal::Packet traces all rays in packets, coherent or not. Throws
    // Error(Device) for arrays that do not fit, and as chooseTraversal.
    RayQueries(const gpu::Device& device, const PackedScene& scene, Traversal traversal = Traversal::Auto,
               const KernelCode& kernels = embeddedKernels());

    // Updates the buffers (SceneBuffers::update) after a change of numbers in the constructor's scene. False
    // if that is impossible: construct new queries then. No query may be running.
    bool update();

    // Compiles the kernels of Query::Closest and Query::Any.
    void prepare();

    // False if it was cancelled.
    bool run(const RayTask& task);

    // Lists the crossings of each ray i: counts[i] of them, as counted by Query::Count, in no order. A count
    // of 0 leaves the ray out. Calls `take` for one ray after the other. Throws Error(Device) if one ray
    // crosses more surfaces than fit into a piece, or if the device finds another number of crossings.
    void list(std::span<const uint32_t> counts, const ListFill& fill, const ListTake& take);

  private:
    struct State;
    std::shared_ptr<State> state_;
};

}  // namespace glint::render
