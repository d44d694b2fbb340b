// Queries of crossings: their number, all of them, and positions of points.
#include <algorithm>

#include "core/parallel.h"
#include "library/ray_reader.h"
#include "library/status.h"
#include "reference/queries.h"

namespace glint::library {

namespace {

using glm::dvec3;
using reference::Hit;

using ReadRay = std::function<LocalRay(uint64_t)>;
// doubtful: the host has counted again.
using TakeCount = std::function<void(uint64_t i, uint32_t crossings, bool doubtful)>;

std::vector<Hit> crossingsOf(const Snapshot::Part& part, const LocalRay& ray) {
    return reference::crossings(part.tracer(), referenceRay(ray));
}

// Counts the crossings of `count` rays. read: the same rays, rounded for the device. Calls `take` from
// several threads.
void countCrossings(const Snapshot::Part& part, uint64_t count, const ReadRay& ray, render::ReadRays read,
                    const Context& context, const TakeCount& take) {
    const auto onHost = [&](uint64_t i) { return static_cast<uint32_t>(crossingsOf(part, ray(i)).size()); };
    if (!part.queries) {
        forBlocks(context, count, [&](uint64_t first, uint64_t end) {
            for (uint64_t i = first; i < end; ++i) take(i, onHost(i), false);
        });
        return;
    }
    render::RayTask task;
    task.count = count;
    task.query = render::RayTask::Query::Count;
    task.fill = std::move(read);
    task.take = [&](const render::RayNumbers& numbers, const render::FoundHits& found) {
        for (size_t i = 0; i < found.size(); ++i) {
            const render::FoundHit one = found[i];
            take(numbers[i], one.doubtful ? onHost(numbers[i]) : one.crossings, one.doubtful);
        }
    };
    runOnDevice(*part.queries, std::move(task), context);
}

void countCrossings(const Snapshot::Part& part, const RayReader& rays, const Context& context,
                    const TakeCount& take) {
    countCrossings(
        part, rays.count(), [&](uint64_t i) { return rays.local(i); },
        [&](const render::RayNumbers& numbers, std::span<render::RayInput> inputs) {
            rays.rounded(numbers, inputs);
        },
        context, take);
}

// Consecutive rays whose crossings are listed together.
struct Piece {
    uint64_t first;                       // number of the first ray
    std::span<const uint32_t> counts;     // of crossings
    std::span<const uint8_t> doubtful;    // listed by the host
    const std::vector<uint64_t>& places;  // of the first hit of each ray, from 0
};

void listOnDevice(const Snapshot::Part& part, const RayReader& rays, const Piece& piece,
                  std::vector<Hit>& hits) {
    std::vector<uint32_t> wanted(piece.counts.begin(), piece.counts.end());
    for (size_t i = 0; i < wanted.size(); ++i)
        if (piece.doubtful[i]) wanted[i] = 0;
    part.queries->list(
        wanted,
        [&](size_t start, std::span<render::RayInput> inputs) {
            for (size_t i = 0; i < inputs.size(); ++i)
                inputs[i] = render::roundedRay(rays.local(piece.first + start + i));
        },
        [&](size_t i, std::span<const render::FoundHit> found) {
            for (size_t k = 0; k < found.size(); ++k) {
                const render::FoundHit& f = found[k];
                hits[piece.places[i] + k] = {static_cast<double>(f.t),
                                             static_cast<double>(f.u),
                                             static_cast<double>(f.v),
                                             f.primitive,
                                             0,
                                             f.instance};
            }
        });
}

// By t, then by geometry and primitive, so that the order does not depend on the BVH.
void putInOrder(const Snapshot::Part& part, std::span<Hit> hits) {
    const auto names = [&](const Hit& hit) {
        const reference::Surface surface = part.tracer().namesAt(hit);
        return std::pair(surface.object, surface.primitive);
    };
    std::sort(hits.begin(), hits.end(),
              [&](const Hit& a, const Hit& b) { return a.t != b.t ? a.t < b.t : names(a) < names(b); });
}

// Lists the crossings of each ray by t.
void listCrossings(const Snapshot::Part& part, const RayReader& rays, const Piece& piece,
                   const Context& context, std::vector<Hit>& hits) {
    if (part.queries) listOnDevice(part, rays, piece, hits);
    parallelFor(context, piece.counts.size(), [&](size_t i) {
        const auto own = std::span(hits).subspan(piece.places[i], piece.counts[i]);
        if (!own.empty() && (!part.queries || piece.doubtful[i])) {
            const std::vector<Hit> found = crossingsOf(part, rays.local(piece.first + i));
            std::copy_n(found.begin(), std::min(found.size(), own.size()), own.begin());
        }
        putInOrder(part, own);
    });
}

uint64_t roomOf(const glint_hits& hits) {
    uint64_t room = UINT64_MAX;
    for (const glint_out* out : {&hits.hit, &hits.t, &hits.geometry, &hits.primitive, &hits.material,
                                 &hits.uv, &hits.point, &hits.normal, &hits.origin})
        if (out->data != nullptr) room = std::min(room, out->count);
    return room;
}

// Counts before it lists, so that a caller without room learns the number.
void listAll(const Snapshot& snapshot, const RayReader& rays, const Output& offsets, const glint_hits* hits,
             uint64_t* total, const Context& context) {
    const Snapshot::Part& part = snapshot.counting();
    std::vector<uint32_t> counts(rays.count());
    std::vector<uint8_t> doubtful(rays.count());
    countCrossings(part, rays, context, [&](uint64_t i, uint32_t crossings, bool doubt) {
        counts[i] = crossings;
        doubtful[i] = doubt;
    });
    uint64_t sum = 0;
    for (uint64_t i = 0; i < counts.size(); ++i) {
        offsets.putLong(i, sum);
        sum += counts[i];
    }
    offsets.putLong(counts.size(), sum);
    if (total != nullptr) *total = sum;
    if (hits == nullptr) return;
    if (roomOf(*hits) < sum)
        throw Failure(GLINT_ERROR_CAPACITY, "there are " + std::to_string(sum) + " hits, and room for " +
                                                std::to_string(roomOf(*hits)));
    const HitWriter writer(*hits, sum, part);
    uint64_t written = 0;
    for (uint64_t first = 0; first < counts.size();) {
        // Most rays and hits of a piece; a ray with more hits is a piece of its own.
        constexpr uint64_t kRays = 1u << 16, kHits = 1u << 18;
        std::vector<uint64_t> places;
        uint64_t end = first, found = 0;
        while (end < counts.size() && end - first < kRays && (end == first || found + counts[end] <= kHits)) {
            places.push_back(found);
            found += counts[end++];
        }
        const Piece piece{first, std::span(counts).subspan(first, end - first),
                          std::span(doubtful).subspan(first, end - first), places};
        std::vector<Hit> listed(found);
        listCrossings(part, rays, piece, context, listed);
        parallelFor(context, piece.counts.size(), [&](size_t i) {
            const LocalRay ray = rays.local(first + i);
            for (uint32_t k = 0; k < piece.counts[i]; ++k)
                writer.write(written + places[i] + k, ray, listed[places[i] + k]);
        });
        written += found;
        first = end;
        context.checkCancelled();
    }
}

}  // namespace

}  // namespace glint::library

using namespace glint::library;

glint_status glint_query_count(const glint_scene* scene, const glint_rays* rays, const glint_out* count,
                               const glint_options* options) {
    return guarded([&] {
        const auto snapshot = snapshotOf(scene);
        const RayReader reader(rays, *snapshot, GLINT_RAYS_COHERENT);
        require(count != nullptr && count->data != nullptr, "glint_query_count: count is NULL");
        const Output out(*count, Output::Kind::Index, 1, reader.count(), "count");
        countCrossings(snapshot->counting(), reader, contextOf(*scene->device, options),
                       [&](uint64_t i, uint32_t crossings, bool) { out.putIndex(i, crossings); });
    });
}

glint_status glint_query_all(const glint_scene* scene, const glint_rays* rays, const glint_out* offsets,
                             const glint_hits* hits, uint64_t* total, const glint_options* options) {
    return guarded([&] {
        const auto snapshot = snapshotOf(scene);
        const RayReader reader(rays, *snapshot, GLINT_RAYS_COHERENT);
        const Output places(offsets != nullptr ? *offsets : glint_out{}, Output::Kind::Long, 1,
                            reader.count() + 1, "offsets");
        glint_hits wanted{};
        if (hits != nullptr) wanted = uncertified(hits, "glint_query_all");
        listAll(*snapshot, reader, places, hits != nullptr ? &wanted : nullptr, total,
                contextOf(*scene->device, options));
    });
}

// Parity of the crossings of a ray along z, for which Woop's shear is zero: corners err only by the rounding
// of their distance. Points that this, or rounding to fp32, may move through a surface are on it.
glint_status glint_query_inside(const glint_scene* scene, const glint_view* points, const glint_out* where,
                                const glint_options* options) {
    return guarded([&] {
        const auto snapshot = snapshotOf(scene);
        require(points != nullptr, "glint_query_inside: points is NULL");
        require(where != nullptr && where->data != nullptr, "glint_query_inside: where is NULL");
        const NumberView given(*points, 3, 0, "points");
        const Output out(*where, Output::Kind::Flag, 1, given.count(), "where");
        const Snapshot::Part& part = snapshot->counting();
        const auto ray = [&](uint64_t i) {
            glint::WorldRay up;
            up.origin = given.three(i);
            up.direction = {0, 0, 1};
            return localRay(up, part.packed.origin);
        };
        const auto read = [&](const glint::render::RayNumbers& numbers,
                              std::span<glint::render::RayInput> inputs) {
            for (size_t i = 0; i < inputs.size(); ++i) inputs[i] = glint::render::roundedRay(ray(numbers[i]));
        };
        countCrossings(
            part, given.count(), ray, read, contextOf(*scene->device, options),
            [&](uint64_t i, uint32_t crossings, bool) {
                const glm::dvec3 point = ray(i).origin;
                const bool on = glm::all(glm::lessThan(glm::abs(point), glm::dvec3(1e30))) &&
                                glint::reference::touches(part.tracer(), point);
                out.putFlag(i, on ? GLINT_ON_SURFACE : (crossings % 2 == 1 ? GLINT_INSIDE : GLINT_OUTSIDE));
            });
    });
}
