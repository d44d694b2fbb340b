#include "render/host_rays.h"

#include <algorithm>

#include "render/path_limits.h"

namespace glint::render {

void writeRays(const PathState& paths, const gpu::Device& device, const SceneFeatures& features,
               const TraceModes& modes, std::span<const RayInput> rays) {
    const RowEntry zero = {{0, 0, 0, 0}};
    std::vector<RowEntry> origin(paths.capacity(), zero), direction = origin, hit = origin, walk = origin;
    for (uint32_t i = 0; i < paths.capacity(); ++i) {
        const RayInput ray = i < rays.size() ? rays[i] : RayInput{.tMin = shared::kInfinity};
        origin[i] = {{ray.origin.x, ray.origin.y, ray.origin.z, 0}};
        origin[i].u[3] = shared::kNone;
        direction[i] = {{ray.direction.x, ray.direction.y, ray.direction.z, ray.tMin}};
        hit[i].f[0] = ray.tMax;
        hit[i].u[3] = shared::kNone;
        walk[i].u[0] = shared::kNone;
    }
    const std::vector<RowEntry> zeros(paths.capacity(), zero);
    paths.writeRow(device, shared::kRowOrigin, origin);
    paths.writeRow(device, shared::kRowDirection, direction);
    paths.writeRow(device, shared::kRowHit, hit);
    paths.writeRow(device, shared::kRowWalk, walk);
    paths.writeRow(device, shared::kRowThroughput, zeros);
    paths.writeRow(device, shared::kRowRadiance, zeros);
    if (features.instances) {
        RowEntry none;
        std::fill_n(none.u, 4, shared::kNone);
        paths.writeRow(device, commonRows(modes), std::vector<RowEntry>(paths.capacity(), none));
    }
    if (features.transmission) {
        const uint32_t further = firstTreeRow(features, modes);
        paths.writeRow(device, further + shared::kTreeRowMedia, zeros);
        paths.writeRow(device, further + shared::kTreeRowBranch, zeros);
    }
}

void readHits(const PathState& paths, const gpu::Device& device, const TraceModes& modes,
              std::span<RayHit> hits) {
    const auto count = static_cast<uint32_t>(hits.size());
    const std::vector<RowEntry> found = paths.readRow(device, shared::kRowHit, count);
    std::vector<RowEntry> walk;
    if (modes.cost) walk = paths.readRow(device, shared::kRowWalk, count);
    for (uint32_t i = 0; i < count; ++i) {
        hits[i].hit = found[i].u[3] != shared::kNone;
        hits[i].t = found[i].f[0];
        hits[i].kindAndIndex = found[i].u[3];
        if (modes.cost) hits[i].data.cost = walk[i].u[2];
    }
}

}  // namespace glint::render
