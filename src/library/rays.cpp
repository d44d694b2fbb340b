// Closest, certified and any hits.
#include <atomic>
#include <cmath>

#include "library/ray_reader.h"
#include "library/status.h"

namespace glint::library {

namespace {

using Write = std::function<void(uint64_t i, const LocalRay& ray, const reference::Hit& hit)>;
using Take =
    std::function<void(const render::RayNumbers& numbers, const render::FoundHits& found, bool rescaled)>;

void queryDevice(const RayReader& rays, bool any, const Context& context, render::RayQueries& queries,
                 const Take& take) {
    render::RayTask task;
    std::atomic<bool> rescaled = false;
    task.count = rays.count();
    task.query = any ? render::RayTask::Query::Any : render::RayTask::Query::Closest;
    task.coherent = rays.coherent();
    task.leaves = rays.leave();
    task.fill = [&](const render::RayNumbers& numbers, std::span<render::RayInput> inputs) {
        if (rays.rounded(numbers, inputs)) rescaled.store(true, std::memory_order_relaxed);
    };
    task.take = [&](const render::RayNumbers& numbers, const render::FoundHits& found) {
        take(numbers, found, rescaled.load(std::memory_order_relaxed));
    };
    runOnDevice(queries, std::move(task), context);
}

// leaves: the ray starts on an unknown surface.
reference::Hit answer(const reference::Tracer& tracer, const LocalRay& ray, bool any, bool leaves) {
    const reference::Ray given = referenceRay(ray, leaves);
    const reference::Source source(leaves ? reference::kElsewhere : shared::kNone);
    reference::Hit miss;
    if (!any) return tracer.closest(given, source).value_or(miss);
    if (tracer.occluded(given, source)) miss.primitive = 0;  // the query gives no more
    return miss;
}

void queryReference(const RayReader& rays, bool any, const Context& context, const reference::Tracer& tracer,
                    const Write& write) {
    forBlocks(context, rays.count(), [&](uint64_t first, uint64_t end) {
        for (uint64_t i = first; i < end; ++i) {
            const LocalRay ray = rays.local(i);
            write(i, ray, answer(tracer, ray, any, rays.leave()));
        }
    });
}

// Writes `sure`, `t_lower` and `t_upper`.
class CertaintyWriter {
  public:
    CertaintyWriter(const glint_hits& hits, uint64_t count)
        : sure_(hits.sure, Output::Kind::Flag, 1, count, "hits.sure"),
          lower_(hits.t_lower, Output::Kind::Real, 1, count, "hits.t_lower"),
          upper_(hits.t_upper, Output::Kind::Real, 1, count, "hits.t_upper") {}

    bool wantsAny() const { return sure_.wanted() || lower_.wanted() || upper_.wanted(); }
    void write(uint64_t i, const reference::certain::Answer& answer) const {
        sure_.putFlag(i, answer.sure ? 1 : 0);
        lower_.putBelow(i, answer.lower);
        upper_.putAbove(i, answer.upper);
    }

  private:
    Output sure_, lower_, upper_;
};

// Answers all rays; if a hit cannot be certified, the ordinary query does. Throws Cancelled.
void certify(const Snapshot& snapshot, const RayReader& rays, const HitWriter& hits,
             const CertaintyWriter& certainty, const Context& context) {
    const reference::certain::Tracer& tracer = snapshot.certain();
    forBlocks(context, rays.count(), [&](uint64_t first, uint64_t end) {
        for (uint64_t i = first; i < end; ++i) {
            reference::certain::Answer answer = tracer.closest(rays.world(i));
            certainty.write(i, answer);
            const LocalRay local = rays.local(i);
            if (answer.sure) {
                answer.hit.t = std::scalbn(answer.hit.t, local.exponent);
            } else {
                answer.hit = snapshot.part().tracer().closest(referenceRay(local)).value_or(reference::Hit{});
            }
            hits.write(i, local, answer.hit);
        }
    });
}

void ask(const Snapshot& snapshot, const RayReader& rays, bool any, const Context& context, const Take& take,
         const Write& write) {
    if (snapshot.part().queries) {
        queryDevice(rays, any, context, *snapshot.part().queries, take);
    } else {
        queryReference(rays, any, context, snapshot.part().tracer(), write);
    }
}

}  // namespace

}  // namespace glint::library

using namespace glint::library;
using glint::render::FoundHits;
using glint::render::RayNumbers;

glint_status glint_query_closest(const glint_scene* scene, const glint_rays* rays, const glint_hits* hits,
                                 const glint_options* options) {
    return guarded([&] {
        const auto snapshot = snapshotOf(scene);
        const RayReader reader(rays, *snapshot);
        const glint_hits wanted = readStruct(hits, "hits");
        const HitWriter writer(wanted, reader.count(), snapshot->part());
        const CertaintyWriter certainty(wanted, reader.count());
        require(!reader.leave() || !certainty.wantsAny(),
                "glint_query_closest: rays with GLINT_RAYS_LEAVE cannot be certified");
        const glint::Context context = contextOf(*scene->device, options);
        if (certainty.wantsAny()) certify(*snapshot, reader, writer, certainty, context);
        if (certainty.wantsAny() || !writer.wantsAny()) return;
        ask(
            *snapshot, reader, false, context,
            [&](const RayNumbers& numbers, const FoundHits& found, bool rescaled) {
                writer.write(numbers, found, reader, rescaled);
            },
            [&](uint64_t i, const glint::LocalRay& ray, const glint::reference::Hit& hit) {
                writer.write(i, ray, hit);
            });
    });
}

glint_status glint_query_any(const glint_scene* scene, const glint_rays* rays, const glint_out* hit,
                             const glint_options* options) {
    return guarded([&] {
        const auto snapshot = snapshotOf(scene);
        const RayReader reader(rays, *snapshot);
        require(hit != nullptr && hit->data != nullptr, "glint_query_any: hit is NULL");
        const Output out(*hit, Output::Kind::Flag, 1, reader.count(), "hit");
        ask(
            *snapshot, reader, true, contextOf(*scene->device, options),
            [&](const RayNumbers& numbers, const FoundHits& found, bool) {
                out.putAllWhole(numbers, found.size(), [hits = found](size_t i) -> uint8_t {
                    return hits.primitive(i) != glint::shared::kNone ? 1 : 0;
                });
            },
            [&](uint64_t i, const glint::LocalRay&, const glint::reference::Hit& found) {
                out.putFlag(i, found.primitive != glint::shared::kNone ? 1 : 0);
            });
    });
}
