#include "library/ray_reader.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <mutex>

#include "core/call_terms.h"
#include "core/parallel.h"
#include "library/status.h"

namespace glint::library {

namespace {

// So many rays before it is needed the processor is told to load what is in no order.
constexpr size_t kAhead = 32;

std::optional<NumberView> bounds(const glint_view& view, uint64_t count, const char* what) {
    if (view.data == nullptr) return std::nullopt;
    return NumberView(view, 1, std::max<uint64_t>(count, 1), what);
}

uint64_t countOf(const glint_rays& rays) {
    if (rays.origins.count == 0 || rays.directions.count == 0) return 0;
    return std::max(rays.origins.count, rays.directions.count);
}

}  // namespace

RayReader::RayReader(const glint_rays* rays, const Snapshot& snapshot)
    : given_(readStruct(rays, "rays")),
      origins_(given_.origins, 3, countOf(given_), "rays.origins"),
      directions_(given_.directions, 3, countOf(given_), "rays.directions"),
      tMin_(bounds(given_.t_min, countOf(given_), "rays.t_min")),
      tMax_(bounds(given_.t_max, countOf(given_), "rays.t_max")),
      count_(countOf(given_)),
      origin_(snapshot.part().packed.origin),
      coherent_((given_.flags & GLINT_RAYS_COHERENT) != 0) {
    if ((given_.flags & ~uint32_t{GLINT_RAYS_COHERENT}) != 0) refuse("rays.flags has bits that mean nothing");
}

WorldRay RayReader::world(uint64_t i) const {
    WorldRay ray;
    ray.origin = origins_.three(i);
    ray.direction = directions_.three(i);
    if (tMin_) ray.tMin = tMin_->one(i);
    if (tMax_) ray.tMax = tMax_->one(i);
    return ray;
}

bool RayReader::rounded(const render::RayNumbers& numbers, std::span<render::RayInput> inputs) const {
    const bool narrow = !origins_.wide() && !directions_.wide() && !tMin_ && !tMax_;
    bool rescaled = false;
    for (size_t i = 0; i < inputs.size(); ++i) {
        if (numbers.order != nullptr && i + kAhead < inputs.size()) {
            origins_.foresee(numbers[i + kAhead]);
            directions_.foresee(numbers[i + kAhead]);
        }
        if (narrow) {
            // What follows, for numbers that no rounding but that of the origin changes.
            const glm::vec3 direction = directions_.narrowThree(numbers[i]);
            const glm::vec3 size = glm::abs(direction);
            const float greatest = std::max(std::max(size.x, size.y), size.z);
            if (isHarmless(static_cast<double>(greatest))) {
                const glm::dvec3 origin(origins_.narrowThree(numbers[i]));
                inputs[i] = {glm::vec3(origin - origin_), direction, 0, shared::kInfinity};
                continue;
            }
        }
        const LocalRay ray = local(numbers[i]);
        rescaled = rescaled || ray.exponent != 0;
        inputs[i] = render::roundedRay(ray);
    }
    return rescaled;
}

HitWriter::HitWriter(const glint_hits& hits, uint64_t count, const Snapshot::Part& part)
    : part_(part),
      hit_(hits.hit, Output::Kind::Flag, 1, count, "hits.hit"),
      t_(hits.t, Output::Kind::Real, 1, count, "hits.t"),
      geometry_(hits.geometry, Output::Kind::Index, 1, count, "hits.geometry"),
      primitive_(hits.primitive, Output::Kind::Index, 1, count, "hits.primitive"),
      material_(hits.material, Output::Kind::Index, 1, count, "hits.material"),
      uv_(hits.uv, Output::Kind::Real, 2, count, "hits.uv"),
      point_(hits.point, Output::Kind::Real, 3, count, "hits.point"),
      normal_(hits.normal, Output::Kind::Real, 3, count, "hits.normal"),
      places_(geometry_.wanted() || primitive_.wanted() || material_.wanted()),
      surfaces_(point_.wanted() || normal_.wanted()) {}

bool HitWriter::wantsAny() const {
    return places_ || surfaces_ || hit_.wanted() || t_.wanted() || uv_.wanted();
}

void HitWriter::writeMiss(uint64_t i) const {
    t_.put(i, std::numeric_limits<double>::infinity());
    geometry_.putIndex(i, GLINT_NONE);
    primitive_.putIndex(i, GLINT_NONE);
    material_.putIndex(i, GLINT_NONE);
    uv_.put(i, 0, 0);
    point_.put(i, glm::dvec3(0));
    normal_.put(i, glm::dvec3(0));
}

void HitWriter::write(uint64_t i, const LocalRay& ray, const reference::Hit& hit) const {
    const bool asked = hit.primitive != shared::kNone && (places_ || surfaces_);
    write(i, ray, hit, asked ? &part_.tracer() : nullptr);
}

void HitWriter::write(uint64_t i, const LocalRay& ray, const reference::Hit& hit,
                      const reference::Tracer* tracer) const {
    const bool found = hit.primitive != shared::kNone;
    hit_.putFlag(i, found ? 1 : 0);
    if (!found) {
        writeMiss(i);
        return;
    }
    t_.put(i, ray.worldT(hit.t));
    const bool triangle = hit.primitive >> shared::kPrimitiveKindShift == shared::kKindTriangle;
    uv_.put(i, triangle ? hit.u : 0, triangle ? hit.v : 0);
    if (tracer == nullptr) return;
    const PackedScene& packed = part_.packed;
    const reference::Surface surface = tracer->surfaceAt(referenceRay(ray), hit);
    geometry_.putIndex(i, surface.object);
    primitive_.putIndex(i, surface.primitive);
    material_.putIndex(i, surface.material);
    point_.put(i, packed.origin + surface.position);
    normal_.put(i, surface.geometricNormal);
}

// What Tracer::surfaceAt would say of triangles, by the same operations; array by array, as that is what
// costs least. Points and normals are of triangles without instances alone. triangles: kNone for a miss.
void HitWriter::writeTriangles(const render::RayNumbers& numbers, std::span<const render::FoundHit> found,
                               std::span<const uint32_t> triangles) const {
    const PackedScene& packed = part_.packed;
    const auto put = [&](const Output& out, const auto& of) {
        out.putAllWhole(numbers, found.size(), [&](size_t k) {
            return triangles[k] == shared::kNone
                       ? GLINT_NONE
                       : of(packed.triangleSurfaces[triangles[k]], found[k].instance);
        });
    };
    put(geometry_, [&](const shared::TriangleSurface& own, uint32_t instance) {
        return instance == shared::kNone ? own.object : packed.instances[instance].object;
    });
    put(primitive_, [](const shared::TriangleSurface& own, uint32_t) { return own.primitive; });
    put(material_, [&](const shared::TriangleSurface& own, uint32_t instance) {
        const uint32_t other =
            instance == shared::kNone ? shared::kNone : packed.instances[instance].material;
        return other == shared::kNone ? own.material : other;
    });
    uv_.putAll(numbers, found.size(), [&](size_t k) {
        return triangles[k] == shared::kNone ? glm::dvec2(0) : glm::dvec2(found[k].u, found[k].v);
    });
    const auto cornersOf = [&](size_t k) {
        const shared::Triangle& t = packed.triangles[triangles[k]];
        return std::array{glm::dvec3(t.v0), glm::dvec3(t.v1), glm::dvec3(t.v2)};
    };
    normal_.putAll(numbers, found.size(), [&](size_t k) {
        if (triangles[k] == shared::kNone) return glm::dvec3(0);
        const auto [v0, v1, v2] = cornersOf(k);
        return glm::normalize(glm::cross(v1 - v0, v2 - v0));
    });
    point_.putAll(numbers, found.size(), [&](size_t k) {
        if (triangles[k] == shared::kNone) return glm::dvec3(0);
        const auto [v0, v1, v2] = cornersOf(k);
        const double u = static_cast<double>(found[k].u), v = static_cast<double>(found[k].v);
        return packed.origin + ((1 - u - v) * v0 + u * v1 + v * v2);
    });
}

void HitWriter::write(const render::RayNumbers& numbers, std::span<const render::FoundHit> found,
                      const RayReader& rays, bool rescaled) const {
    std::array<uint32_t, render::RayTask::kBlock> triangles;
    bool others = false;
    for (size_t k = 0; k < found.size(); ++k) {
        const uint32_t primitive = found[k].primitive;
        const bool triangle = primitive >> shared::kPrimitiveKindShift == shared::kKindTriangle &&
                              (found[k].instance == shared::kNone || !surfaces_);
        triangles[k] = triangle ? primitive & shared::kPrimitiveIndexMask : shared::kNone;
        others = others || (!triangle && primitive != shared::kNone);
    }
    hit_.putAllWhole(numbers, found.size(),
                     [&](size_t k) -> uint8_t { return triangles[k] != shared::kNone ? 1 : 0; });
    t_.putAll(numbers, found.size(), [&](size_t k) {
        if (triangles[k] == shared::kNone) return std::numeric_limits<double>::infinity();
        const double t = static_cast<double>(found[k].t);
        return rescaled ? rays.local(numbers[k]).worldT(t) : t;
    });
    writeTriangles(numbers, found, std::span(triangles).first(found.size()));
    if (!others) return;
    const reference::Tracer* const tracer = places_ || surfaces_ ? &part_.tracer() : nullptr;
    for (size_t k = 0; k < found.size(); ++k) {
        const render::FoundHit& hit = found[k];
        if (hit.primitive == shared::kNone || triangles[k] != shared::kNone) continue;
        write(numbers[k], rays.local(numbers[k]),
              {static_cast<double>(hit.t), static_cast<double>(hit.u), static_cast<double>(hit.v),
               hit.primitive, 0, hit.instance},
              tracer);
    }
}

Callbacks::Callbacks(const glint_options* options) {
    if (options == nullptr) return;
    const glint_options given = readStruct(options, "options");
    if (given.cancelled != nullptr) cancelled = [given] { return given.cancelled(given.user) != 0; };
    if (given.progress != nullptr)
        progress = [given](double fraction) { given.progress(given.user, fraction); };
}

void forBlocks(uint64_t count, const Callbacks& callbacks,
               const std::function<void(uint64_t first, uint64_t end)>& body) {
    constexpr uint64_t kTurn = 1024;
    const uint64_t turns = (count + kTurn - 1) / kTurn;
    std::atomic<bool> stopped = false;
    std::mutex mutex;
    uint64_t done = 0;
    parallelFor(turns, [&](size_t turn) {
        if (stopped || (callbacks.cancelled && callbacks.cancelled())) {
            stopped = true;
            return;
        }
        body(turn * kTurn, std::min((turn + 1) * kTurn, count));
        if (!callbacks.progress) return;
        const std::lock_guard lock(mutex);
        callbacks.progress(static_cast<double>(++done) / static_cast<double>(turns));
    });
    if (stopped) throw Cancelled();
}

}  // namespace glint::library
