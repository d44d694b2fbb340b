#include "app/trace_batch.h"

#include <optional>
#include <span>

#include "reference/render.h"

namespace glint::app {

namespace {

WorldHit worldHit(const render::FoundHit& found, const LocalRay& ray, const reference::Tracer* tracer) {
    WorldHit hit;
    if (tracer != nullptr)
        hit = reference::worldHit(*tracer, {ray.origin, ray.direction, ray.tMin, ray.tMax},
                                  {static_cast<double>(found.t), static_cast<double>(found.u),
                                   static_cast<double>(found.v), found.primitive, 0, found.instance});
    hit.hit = true;
    hit.t = ray.worldT(static_cast<double>(found.t));
    hit.packed = found.primitive;
    return hit;
}

}  // namespace

std::vector<WorldHit> traceBatch(render::RayQueries& queries, const PackedScene& scene, const RayBatch& batch,
                                 bool coherent, BatchTimes* times) {
    std::vector<WorldHit> hits(batch.rays.size());
    std::optional<reference::Tracer> tracer;
    if (batch.detail == HitDetail::Surface) tracer.emplace(scene);
    const auto localOf = [&](uint64_t i) { return localRay(batch.rays[i], scene.origin); };
    render::RayTask task;
    task.count = hits.size();
    task.query =
        batch.detail == HitDetail::Any ? render::RayTask::Query::Any : render::RayTask::Query::Closest;
    task.methods = batch.methods;
    task.coherent = coherent;
    task.kernels = times;
    task.fill = [&](const render::RayNumbers& numbers, std::span<render::RayInput> rays) {
        for (size_t i = 0; i < rays.size(); ++i) rays[i] = render::roundedRay(localOf(numbers[i]));
    };
    task.take = [&](const render::RayNumbers& numbers, const render::FoundHits& found) {
        for (size_t i = 0; i < found.size(); ++i) {
            if (found.primitive(i) == shared::kNone) continue;
            WorldHit& hit = hits[numbers[i]];
            if (batch.detail == HitDetail::Any)
                hit.hit = true;
            else
                hit = worldHit(found[i], localOf(numbers[i]), tracer ? &*tracer : nullptr);
        }
    };
    queries.run(task);
    return hits;
}

}  // namespace glint::app
