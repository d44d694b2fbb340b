#include "reference/trace_rays.h"

#include <algorithm>

#include "core/parallel.h"

namespace glint::reference {

namespace {

constexpr size_t kRaysPerTurn = 256;  // that a thread takes at a time

}  // namespace

WorldHit worldHit(const Tracer& tracer, const Ray& ray, const Hit& hit) {
    const Surface surface = tracer.surfaceAt(ray, hit);
    WorldHit found;
    found.hit = true;
    found.t = hit.t;
    found.packed = hit.primitive;
    found.u = hit.u;
    found.v = hit.v;
    found.point = tracer.model().origin + surface.position;
    found.normal = surface.geometricNormal;
    found.object = surface.object;
    found.face = surface.primitive;
    found.material = surface.material;
    return found;
}

WorldHit trace(const Tracer& tracer, const Ray& ray, HitDetail detail) {
    WorldHit found;
    uint64_t cost = 0;
    if (detail == HitDetail::Any) {
        found.hit = tracer.occluded(ray, {}, &cost);
    } else if (const std::optional<Hit> hit = tracer.closest(ray, {}, &cost)) {
        found.hit = true;
        found.t = hit->t;
        found.packed = hit->primitive;
        if (detail == HitDetail::Surface) found = worldHit(tracer, ray, *hit);
    }
    found.cost = cost;
    return found;
}

std::vector<WorldHit> trace(const PackedScene& scene, const RayBatch& batch, const Context& context) {
    return trace(Tracer(scene, {.methods = batch.methods}), batch, context);
}

std::vector<WorldHit> trace(const Tracer& tracer, const RayBatch& batch, const Context& context) {
    const glm::dvec3 origin = tracer.model().origin;
    std::vector<WorldHit> hits(batch.rays.size());
    const auto one = [&](size_t i) {
        const LocalRay local = localRay(batch.rays[i], origin);
        hits[i] = trace(tracer, {local.origin, local.direction, local.tMin, local.tMax}, batch.detail);
        if (hits[i].hit) hits[i].t = local.worldT(hits[i].t);
    };
    parallelFor(context, (hits.size() + kRaysPerTurn - 1) / kRaysPerTurn, [&](size_t turn) {
        const size_t end = std::min((turn + 1) * kRaysPerTurn, hits.size());
        for (size_t i = turn * kRaysPerTurn; i < end; ++i) one(i);
    });
    return hits;
}

}  // namespace glint::reference
