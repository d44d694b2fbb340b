// The closest point of all surfaces. A device finds the primitive, the host the point of it in double.
#include "library/ray_reader.h"
#include "library/status.h"
#include "reference/queries.h"

namespace glint::library {

namespace {

void requireKinds(const PackedScene& packed) {
    using Kinds = shared::PrimitiveKind;
#define GLINT_REQUIRE(number, Kind, KINDS, kinds, one, many)                                     \
    if (Kinds::Kind != Kinds::Triangle && Kinds::Kind != Kinds::Sphere && !packed.kinds.empty()) \
        refuse("closest points are of triangles and spheres alone: the scene has a " #one);
    GLINT_PRIMITIVES(GLINT_REQUIRE, GLINT_NO_KIND)
#undef GLINT_REQUIRE
}

// Writes the closest points as hits of rays from `points`, whose directions are unit.
void answerPoints(const Snapshot::Part& part, const NumberView& points, const HitWriter& hits,
                  const Context& context) {
    const reference::Model& model = part.tracer().model();
    const auto local = [&](uint64_t i) { return points.three(i) - part.packed.origin; };
    // Points whose squares overflow in fp32 have no closest point.
    const auto isNear = [](const glm::dvec3& point) {
        return glm::all(glm::lessThan(glm::abs(point), glm::dvec3(1e18)));
    };
    const auto write = [&](uint64_t i, const reference::ClosestPoint& closest) {
        LocalRay ray{local(i), glm::dvec3(0, 0, 1)};
        if (closest.hit.t > 0) ray.direction = (closest.point - ray.origin) / closest.hit.t;
        hits.write(i, ray, closest.hit);
    };
    if (!part.queries) {
        forBlocks(context, points.count(), [&](uint64_t first, uint64_t end) {
            for (uint64_t i = first; i < end; ++i)
                write(i, isNear(local(i)) ? reference::closestPoint(model, local(i))
                                          : reference::ClosestPoint{});
        });
        return;
    }
    render::RayTask task;
    task.count = points.count();
    task.query = render::RayTask::Query::Point;
    task.fill = [&](const render::RayNumbers& numbers, std::span<render::RayInput> inputs) {
        for (size_t i = 0; i < inputs.size(); ++i) {
            const glm::dvec3 point = local(numbers[i]);
            inputs[i] = {glm::vec3(point), glm::vec3(0, 0, 1), isNear(point) ? 0 : shared::kInfinity,
                         shared::kInfinity};
        }
    };
    task.take = [&](const render::RayNumbers& numbers, const render::FoundHits& found) {
        for (size_t i = 0; i < found.size(); ++i)
            write(numbers[i], found.primitive(i) == shared::kNone
                                  ? reference::ClosestPoint{}
                                  : reference::closestPointOn(model, found.primitive(i), found.instance(i),
                                                              local(numbers[i])));
    };
    runOnDevice(*part.queries, std::move(task), context);
}

}  // namespace

}  // namespace glint::library

using namespace glint::library;

glint_status glint_query_closest_point(const glint_scene* scene, const glint_view* points,
                                       const glint_hits* hits, const glint_options* options) {
    return guarded([&] {
        const auto snapshot = snapshotOf(scene);
        require(points != nullptr, "glint_query_closest_point: points is NULL");
        const NumberView given(*points, 3, 0, "points");
        const HitWriter writer(uncertified(hits, "glint_query_closest_point"), given.count(),
                               snapshot->part());
        requireKinds(snapshot->part().packed);
        answerPoints(snapshot->part(), given, writer, contextOf(*scene->device, options));
    });
}
