// Writes rays of the host into the path state, and reads what they hit.
#pragma once

#include <span>

#include "render/path_state.h"
#include "render/pipelines.h"
#include "render/rays.h"

namespace glint::render {

// Writes what generate.comp would have written; paths beyond the last ray have none.
void writeRays(const PathState& paths, const gpu::Device& device, const SceneFeatures& features,
               const TraceModes& modes, std::span<const RayInput> rays);

// Reads the hits that the kernels found for the first rays, without their surfaces: those are in the rows of
// layers.
void readHits(const PathState& paths, const gpu::Device& device, const TraceModes& modes,
              std::span<RayHit> hits);

}  // namespace glint::render
