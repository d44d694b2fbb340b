// Queries that a ray has one answer to.
#include <atomic>

#include "core/parallel.h"
#include "library/ray_reader.h"
#include "library/status.h"

namespace glint::library {

namespace {

using Write = std::function<void(uint64_t i, const LocalRay& ray, const reference::Hit& hit)>;

void askDevice(const RayReader& rays, bool any, const Callbacks& callbacks, render::RayQueries& queries,
               const Write& write) {
    render::RayTask task;
    task.count = rays.count();
    task.ask = any ? render::RayTask::Ask::Any : render::RayTask::Ask::Nearest;
    task.coherent = rays.coherent();
    task.cancelled = callbacks.cancelled;
    task.progress = callbacks.progress;
    task.fill = [&](size_t first, std::span<render::RayInput> inputs) {
        for (size_t i = 0; i < inputs.size(); ++i) inputs[i] = render::roundedRay(rays.local(first + i));
    };
    task.take = [&](size_t first, std::span<const render::FoundHit> hits) {
        for (size_t i = 0; i < hits.size(); ++i) {
            reference::Hit hit;
            hit.t = static_cast<double>(hits[i].t);
            hit.u = static_cast<double>(hits[i].u);
            hit.v = static_cast<double>(hits[i].v);
            hit.primitive = hits[i].primitive;
            hit.instance = hits[i].instance;
            write(first + i, rays.local(first + i), hit);
        }
    };
    if (!queries.run(task)) reportCancelled();
}

reference::Hit answer(const reference::Tracer& tracer, const LocalRay& ray, bool any) {
    reference::Hit miss;
    if (!any) return tracer.closest(referenceRay(ray)).value_or(miss);
    if (tracer.occluded(referenceRay(ray))) miss.primitive = 0;  // no more is known
    return miss;
}

void askReference(const RayReader& rays, bool any, const Callbacks& callbacks,
                  const reference::Tracer& tracer, const Write& write) {
    constexpr size_t kTurn = 1024;
    const size_t turns = (rays.count() + kTurn - 1) / kTurn;
    std::atomic<bool> stopped = false;
    std::mutex mutex;
    size_t done = 0;
    parallelFor(turns, [&](size_t turn) {
        if (stopped || (callbacks.cancelled && callbacks.cancelled())) {
            stopped = true;
            return;
        }
        const uint64_t end = std::min<uint64_t>((turn + 1) * kTurn, rays.count());
        for (uint64_t i = turn * kTurn; i < end; ++i) {
            const LocalRay ray = rays.local(i);
            write(i, ray, answer(tracer, ray, any));
        }
        if (!callbacks.progress) return;
        const std::lock_guard lock(mutex);
        callbacks.progress(static_cast<double>(++done) / static_cast<double>(turns));
    });
    if (stopped) reportCancelled();
}

void ask(const Snapshot& snapshot, const RayReader& rays, bool any, const Callbacks& callbacks,
         const Write& write) {
    if (snapshot.part().queries) {
        askDevice(rays, any, callbacks, *snapshot.part().queries, write);
    } else {
        askReference(rays, any, callbacks, snapshot.part().tracer(), write);
    }
}

}  // namespace

}  // namespace glint::library

using namespace glint::library;

glint_status glint_query_closest(const glint_scene* scene, const glint_rays* rays, const glint_hits* hits,
                                 const glint_options* options) {
    return guarded(termsOf(scene), [&] {
        const auto snapshot = snapshotOf(scene);
        const RayReader reader(rays, *snapshot);
        const HitWriter writer(readStruct(hits, "hits"), reader.count(), snapshot->part());
        if (!writer.wantsAny()) return;
        ask(*snapshot, reader, false, Callbacks(options),
            [&](uint64_t i, const glint::LocalRay& ray, const glint::reference::Hit& hit) {
                writer.write(i, ray, hit);
            });
    });
}

glint_status glint_query_any(const glint_scene* scene, const glint_rays* rays, const glint_out* hit,
                             const glint_options* options) {
    return guarded(termsOf(scene), [&] {
        const auto snapshot = snapshotOf(scene);
        const RayReader reader(rays, *snapshot);
        require(hit != nullptr && hit->data != nullptr, "glint_query_any: hit is NULL");
        const Output out(*hit, Output::Kind::Flag, 1, reader.count(), "hit");
        ask(*snapshot, reader, true, Callbacks(options),
            [&](uint64_t i, const glint::LocalRay&, const glint::reference::Hit& found) {
                out.putFlag(i, found.primitive != glint::shared::kNone ? 1 : 0);
            });
    });
}
