#include <algorithm>

#include "render/renderer.h"

namespace glint::render {

namespace {

// Bounds what the host holds besides the caller's arrays: 150 MiB.
constexpr size_t kChunkRays = size_t{1} << 20;

WorldHit worldHit(const RayHit& found, const LocalRay& ray, HitDetail detail) {
    WorldHit hit;
    if (detail == HitDetail::Surface && found.hit) hit = hitOf(found.data);
    hit.hit = found.hit;
    hit.cost = found.data.cost;
    if (!found.hit || detail == HitDetail::Any) return hit;
    hit.t = ray.worldT(static_cast<double>(found.t));
    hit.packed = found.kindAndIndex;
    return hit;
}

}  // namespace

std::vector<WorldHit> Renderer::trace(const RayBatch& batch, BatchTimes* times) {
    std::vector<WorldHit> hits(batch.rays.size());
    std::vector<LocalRay> local;
    std::vector<RayInput> inputs;
    for (size_t first = 0; first < hits.size(); first += kChunkRays) {
        const size_t count = std::min(kChunkRays, hits.size() - first);
        local.resize(count);
        inputs.resize(count);
        for (size_t i = 0; i < count; ++i) {
            local[i] = localRay(batch.rays[first + i], scene().origin);
            inputs[i] = roundedRay(local[i]);
        }
        const std::vector<RayHit> found =
            traceLocal(inputs, {batch.detail, batch.cost, batch.methods, times});
        for (size_t i = 0; i < count; ++i) hits[first + i] = worldHit(found[i], local[i], batch.detail);
    }
    return hits;
}

std::vector<RayHit> Renderer::trace(const std::vector<RayInput>& rays, bool any, const Methods& methods) {
    return traceLocal(rays, {any ? HitDetail::Any : HitDetail::Surface, false, methods, nullptr});
}

PixelData Renderer::pixel(const shared::Camera& camera, Request request, int x, int y) {
    request.region = {x, y, x + 1, y + 1};
    request.samples = PackedSamples::fixed({{0.5, 0.5}});
    request.data = true;
    return render(camera, request).data[0];
}

}  // namespace glint::render
