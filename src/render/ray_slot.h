// A piece of a batch's rays on the device (ray_queries.cpp).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "render/path_state.h"
#include "render/pipelines.h"
#include "render/scene_buffers.h"

namespace glint::render {

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
