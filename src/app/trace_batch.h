// The hits of a batch's rays by a device's kernels.
#pragma once

#include <vector>

#include "pack/packed_scene.h"
#include "render/ray_queries.h"
#include "trace/ray_batch.h"

namespace glint::app {

// The device finds the hits of the rays, rounded to fp32 relative to the scene's origin. The reference
// computes the hit's point, normal and names (HitDetail::Surface). WorldHit::cost stays 0. `coherent`,
// `times`: see RayTask.
std::vector<WorldHit> traceBatch(render::RayQueries& queries, const PackedScene& scene, const RayBatch& batch,
                                 bool coherent = false, BatchTimes* times = nullptr);

}  // namespace glint::app
