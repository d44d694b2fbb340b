// A piece of a batch's rays, in blocks, on the device (ray_queries.cpp).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "render/path_state.h"
#include "render/pipelines.h"
#include "render/ray_order.h"
#include "render/scene_buffers.h"

namespace glint::render {

constexpr size_t kBlock = kRayBlock;
// llvmpipe gives each of its threads an equal run of the workgroups: blocks are dealt out among so many runs.
constexpr size_t kRuns = 16;

// A block of uninitialised elements: initialising it would cost as much as filling it.
template <class Element>
class Unset {
  public:
    std::span<Element, kBlock> all() {
        return std::span<Element, kBlock>(std::launder(reinterpret_cast<Element*>(bytes_)), kBlock);
    }

  private:
    static_assert(std::is_trivially_destructible_v<Element> && std::is_aggregate_v<Element>);
    alignas(Element) std::byte bytes_[kBlock * sizeof(Element)];
};

// Positions of a piece's blocks.
struct Placement {
    size_t blocks, runs, perRun;
    Placement(size_t count, bool dealt)
        : blocks((count + kBlock - 1) / kBlock),
          runs(dealt ? std::min(kRuns, blocks) : 1),
          perRun((blocks + runs - 1) / runs) {}
    size_t places() const { return runs * perRun; }
    // The block at a place; `blocks` or more if there is none.
    size_t at(size_t place) const { return place % perRun * runs + place / perRun; }
};

// Rows that a ray needs, in the order of the staging buffer.
inline constexpr std::array kSlotRows = {shared::kRowOrigin, shared::kRowDirection, shared::kRowHit,
                                         shared::kPathRows};
inline constexpr size_t kInstanceRow = 3, kHitRow = 2;  // of kSlotRows

// Resources of one piece of rays in flight. On a software device `rows` is written and read in place;
// otherwise `staging` holds copies of the rows that are exchanged.
struct Slot {
    gpu::Buffer counters, rows, staging;
    Pipelines pipelines;
    gpu::Submission submission;
    uint32_t capacity;
    bool busy = false;

    Slot(const gpu::Device& device, Pipelines made, gpu::Access access, const SceneBuffers& scene,
         uint32_t paths, uint32_t rowCount, bool inPlace)
        : pipelines(std::move(made)), submission(device), capacity(paths) {
        const uint64_t row = uint64_t{paths} * sizeof(RowEntry);
        counters = gpu::Buffer(device, "counters", shared::kCounterCount * sizeof(uint32_t),
                               gpu::Access::StorageBuffer, gpu::MemoryKind::Host);
        rows = gpu::Buffer(device, "rays", row * rowCount, access,
                           inPlace ? gpu::MemoryKind::Host : gpu::MemoryKind::Device);
        if (!inPlace)
            staging = gpu::Buffer(device, "rays on their way", row * kSlotRows.size(),
                                  gpu::Access::StorageBuffer, gpu::MemoryKind::Host);
        pipelines.bind(counters, rows, scene);
        // Kernels leave the walk row alone but where a ray runs out of trips, and put it back when that is
        // done.
        RowEntry none;
        std::fill_n(none.u, 4, shared::kNone);
        const std::vector<RowEntry> finished(paths, none);
        gpu::upload(device, rows, std::as_bytes(std::span(finished)), shared::kRowWalk * row);
    }

    // One of kSlotRows, where the host writes and reads it.
    RowEntry* row(size_t which) const {
        return static_cast<RowEntry*>(staging ? staging.mapped() : rows.mapped()) +
               (staging ? which : size_t{kSlotRows[which]}) * capacity;
    }
    uint32_t& unfinished() const {
        return static_cast<uint32_t*>(counters.mapped())[shared::kCounterUnfinished];
    }
};

}  // namespace glint::render
