#include "library/ray_reader.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>

#include "core/parallel.h"
#include "library/status.h"

namespace glint::library {

namespace {

// Prefetch distance for unordered rays.
constexpr size_t kAhead = 32;

// Words of one store.
using Four = float __attribute__((vector_size(16)));

// The surface of a miss, or of a hit on another kind.
const shared::TriangleSurface kNothing = {.normal = glm::vec3(0),
                                          .object = GLINT_NONE,
                                          .primitive = GLINT_NONE,
                                          .material = GLINT_NONE,
                                          .vertexNormals = shared::kNone,
                                          .attributes = 0};

std::optional<NumberView> bounds(const glint_view& view, uint64_t count, const char* what) {
    if (view.data == nullptr) return std::nullopt;
    return NumberView(view, 1, count, what);
}

uint64_t countOf(const glint_rays& rays) {
    if (rays.origins.count == 0 || rays.directions.count == 0) return 0;
    return std::max(rays.origins.count, rays.directions.count);
}

}  // namespace

RayReader::RayReader(const glint_rays* rays, const Snapshot& snapshot, uint32_t allowed)
    : given_(readStruct(rays, "rays")),
      origins_(given_.origins, 3, countOf(given_), "rays.origins"),
      directions_(given_.directions, 3, countOf(given_), "rays.directions"),
      tMin_(bounds(given_.t_min, countOf(given_), "rays.t_min")),
      tMax_(bounds(given_.t_max, countOf(given_), "rays.t_max")),
      count_(countOf(given_)),
      origin_(snapshot.part().packed.origin) {
    if ((given_.flags & ~allowed) != 0)
        refuse("rays.flags: this call has no use for bits " + std::to_string(given_.flags & ~allowed));
}

glint_hits uncertified(const glint_hits* hits, const std::string& call) {
    const glint_hits wanted = readStruct(hits, "hits");
    if (wanted.sure.data != nullptr || wanted.t_lower.data != nullptr || wanted.t_upper.data != nullptr)
        refuse(call + ": hits.sure, t_lower and t_upper are of the closest hits of rays alone");
    return wanted;
}

WorldRay RayReader::world(uint64_t i) const {
    WorldRay ray;
    ray.origin = origins_.three(i);
    ray.direction = directions_.three(i);
    if (tMin_) ray.tMin = tMin_->one(i);
    if (tMax_) ray.tMax = tMax_->one(i);
    return ray;
}

// For fp32 rays that change only by the rounding of the origin, as most do, without branches. False if there
// are others; `inputs` is then invalid.
bool RayReader::roundedNarrow(const render::RayNumbers& given, std::span<render::RayInput> inputs) const {
    const render::RayNumbers numbers = given;  // for the caller's numbers, not for the stored ones
    const NumberView origins = origins_, directions = directions_;
    const glm::dvec3 from = origin_;
    bool harmless = true;
    const auto put = [&](size_t i, uint64_t number) {
        const glm::vec3 along = directions.narrowThree(number);
        const glm::dvec3 start = glm::dvec3(origins.narrowThree(number)) - from;
        const float greatest = std::max(std::max(std::abs(along.x), std::abs(along.y)), std::abs(along.z));
        harmless &= isHarmless(static_cast<double>(greatest));
        // Stored from two registers: stores of single words stall the wider loads that follow.
        static_assert(offsetof(render::RayInput, direction) == 12 && offsetof(render::RayInput, tMax) == 28);
        const Four first = {static_cast<float>(start.x), static_cast<float>(start.y),
                            static_cast<float>(start.z), along.x};
        const Four second = {along.y, along.z, 0, shared::kInfinity};
        std::byte* const input = reinterpret_cast<std::byte*>(&inputs[i]);
        std::memcpy(input, &first, sizeof(first));
        std::memcpy(input + sizeof(first), &second, sizeof(second));
    };
    const size_t count = inputs.size(), run = numbers.run;
    if (run > 1) {  // what follows each other the processor foresees by itself
        for (size_t i = 0; i < count; i += run) {
            const uint64_t number = numbers[i];
            for (size_t k = 0; k < std::min(run, count - i); ++k) put(i + k, number + k);
        }
        return harmless;
    }
    for (size_t i = 0; i < count; ++i) {
        if (numbers.order != nullptr && i + kAhead < count) {
            origins.prefetch(numbers[i + kAhead]);
            directions.prefetch(numbers[i + kAhead]);
        }
        put(i, numbers[i]);
    }
    return harmless;
}

bool RayReader::rounded(const render::RayNumbers& numbers, std::span<render::RayInput> inputs) const {
    const bool narrow = !origins_.wide() && !directions_.wide() && !tMin_ && !tMax_;
    if (narrow && roundedNarrow(numbers, inputs)) return false;
    bool rescaled = false;
    for (size_t i = 0; i < inputs.size(); ++i) {
        if (numbers.order != nullptr && i + kAhead < inputs.size()) prefetch(numbers[i + kAhead]);
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
      origin_(hits.origin, Output::Kind::Real, 3, count, "hits.origin"),
      places_(geometry_.wanted() || primitive_.wanted() || material_.wanted()),
      surfaces_(point_.wanted() || normal_.wanted() || origin_.wanted()) {}

bool HitWriter::wantsAny() const {
    return places_ || surfaces_ || hit_.wanted() || t_.wanted() || uv_.wanted();
}

void HitWriter::writeMiss(uint64_t i) const {
    t_.put(i, std::numeric_limits<double>::infinity());
    geometry_.putIndex(i, GLINT_NONE);
    primitive_.putIndex(i, GLINT_NONE);
    material_.putIndex(i, GLINT_NONE);
    uv_.put(i, glm::dvec2(0));
    for (const Output* out : {&point_, &normal_, &origin_}) out->put(i, glm::dvec3(0));
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
    uv_.put(i, triangle ? glm::dvec2(hit.u, hit.v) : glm::dvec2(0));
    if (tracer == nullptr) return;
    const PackedScene& packed = part_.packed;
    const reference::Surface surface =
        surfaces_ ? tracer->surfaceAt(referenceRay(ray), hit) : tracer->namesAt(hit);
    geometry_.putIndex(i, surface.object);
    primitive_.putIndex(i, surface.primitive);
    material_.putIndex(i, surface.material);
    point_.put(i, packed.origin + surface.position);
    normal_.put(i, surface.geometricNormal);
    if (origin_.wanted()) writeOrigin(i, ray, surface);
}

// The point, moved to the side that the ray came from, out of its error box (docs/design/numerics.md, rule
// 1). The box also covers the rounding of the stored numbers and of a ray's origin in fp32.
void HitWriter::writeOrigin(uint64_t i, const LocalRay& ray, const reference::Surface& surface) const {
    const glm::dvec3& n = surface.geometricNormal;
    const glm::dvec3 world = part_.packed.origin + surface.position;
    const glm::dvec3 error = surface.error + 0x1p-24 * glm::abs(surface.position) +
                             (origin_.wide() ? 0x1p-53 : 0x1p-24) * glm::abs(world);
    const double side = glm::dot(ray.direction, n) > 0 ? -1 : 1;
    origin_.put(i, world + side * (1 + 0x1p-20) * glm::dot(glm::abs(n), error) * n);
}

// Tracer::surfaceAt for triangles, array by array for speed.
void HitWriter::writeTriangles(const render::RayNumbers& numbers, const render::FoundHits& found,
                               const Rows& rows) const {
    const auto hits = found;
    const auto* const own = rows.data();
    if (places_) writePlaces(numbers, found, rows);
    uv_.putAll(numbers, hits.size(), [=](size_t k) {
        const glm::vec2 uv(hits.u(k), hits.v(k));
        return own[k] == &kNothing ? glm::vec2(0) : uv;
    });
    if (surfaces_) writeSurfaces(numbers, found, rows);
}

void HitWriter::writePlaces(const render::RayNumbers& numbers, const render::FoundHits& found,
                            const Rows& rows) const {
    const size_t count = found.size();
    const auto* const own = rows.data();
    primitive_.putAllWhole(numbers, count, [=](size_t k) { return own[k]->primitive; });
    if (part_.packed.instances.empty()) {
        geometry_.putAllWhole(numbers, count, [=](size_t k) { return own[k]->object; });
        material_.putAllWhole(numbers, count, [=](size_t k) { return own[k]->material; });
        return;
    }
    // An instance is a geometry of its own, and may have a material of its own.
    const shared::Instance* const instances = part_.packed.instances.data();
    geometry_.putAllWhole(numbers, count, [&](size_t k) {
        const uint32_t instance = own[k] == &kNothing ? shared::kNone : found.instance(k);
        return instance == shared::kNone ? own[k]->object : instances[instance].object;
    });
    material_.putAllWhole(numbers, count, [&](size_t k) {
        const uint32_t instance = own[k] == &kNothing ? shared::kNone : found.instance(k);
        const uint32_t other = instance == shared::kNone ? shared::kNone : instances[instance].material;
        return other == shared::kNone ? own[k]->material : other;
    });
}

// Surfaces of triangles without instances.
void HitWriter::writeSurfaces(const render::RayNumbers& numbers, const render::FoundHits& found,
                              const Rows& rows) const {
    const PackedScene& packed = part_.packed;
    const size_t count = found.size();
    const auto* const own = rows.data();
    const auto cornersOf = [&](size_t k) {
        const shared::Triangle& t =
            packed.triangles[static_cast<size_t>(own[k] - packed.triangleSurfaces.data())];
        return std::array{glm::dvec3(t.v0), glm::dvec3(t.v1), glm::dvec3(t.v2)};
    };
    if (normal_.wide()) {
        const shared::TriangleSurface* last = &kNothing;  // neighbours often hit the same
        glm::dvec3 normal(0);
        normal_.putAll(numbers, count, [&](size_t k) {
            if (own[k] == last) return normal;
            last = own[k];
            if (last == &kNothing) return normal = glm::dvec3(0);
            const auto [v0, v1, v2] = cornersOf(k);
            return normal = glm::normalize(glm::cross(v1 - v0, v2 - v0));
        });
    } else {
        normal_.putAll(numbers, count, [=](size_t k) { return own[k]->normal; });
    }
    point_.putAll(numbers, count, [&](size_t k) {
        if (own[k] == &kNothing) return glm::dvec3(0);
        const auto [v0, v1, v2] = cornersOf(k);
        const double u = static_cast<double>(found.u(k)), v = static_cast<double>(found.v(k));
        return packed.origin + ((1 - u - v) * v0 + u * v1 + v * v2);
    });
}

void HitWriter::write(const render::RayNumbers& numbers, const render::FoundHits& found,
                      const RayReader& rays, bool rescaled) const {
    const auto hits = found;
    Rows rows;
    const auto** const own = rows.data();
    const shared::TriangleSurface* const surfaces = part_.packed.triangleSurfaces.data();
    bool others = false;
    for (size_t k = 0; k < hits.size(); ++k) {
        const uint32_t primitive = hits.primitive(k);
        const bool triangle = primitive >> shared::kPrimitiveKindShift == shared::kKindTriangle &&
                              !origin_.wanted() && (!surfaces_ || hits.instance(k) == shared::kNone);
        own[k] = triangle ? surfaces + (primitive & shared::kPrimitiveIndexMask) : &kNothing;
        if (places_ || surfaces_) __builtin_prefetch(own[k]);
        others |= !triangle && primitive != shared::kNone;
    }
    hit_.putAllWhole(numbers, hits.size(), [=](size_t k) -> uint8_t { return own[k] != &kNothing ? 1 : 0; });
    if (rescaled) {
        t_.putAll(numbers, hits.size(), [&](size_t k) {
            return own[k] == &kNothing ? std::numeric_limits<double>::infinity()
                                       : rays.local(numbers[k]).worldT(static_cast<double>(hits.t(k)));
        });
    } else {
        t_.putAll(numbers, hits.size(), [=](size_t k) {
            const float t = hits.t(k);
            return own[k] == &kNothing ? std::numeric_limits<float>::infinity() : t;
        });
    }
    writeTriangles(numbers, found, rows);
    origin_.putAll(numbers, hits.size(), [](size_t) { return glm::dvec3(0); });  // of misses
    if (!others) return;
    const reference::Tracer* const tracer = places_ || surfaces_ ? &part_.tracer() : nullptr;
    const bool needsRay = surfaces_ || rescaled;
    for (size_t k = 0; k < hits.size(); ++k) {
        if (needsRay && numbers.order != nullptr && k + kAhead < hits.size())
            rays.prefetch(numbers[k + kAhead]);
        const render::FoundHit hit = hits[k];
        if (hit.primitive == shared::kNone || own[k] != &kNothing) continue;
        write(numbers[k], needsRay ? rays.local(numbers[k]) : LocalRay{},
              {static_cast<double>(hit.t), static_cast<double>(hit.u), static_cast<double>(hit.v),
               hit.primitive, 0, hit.instance},
              tracer);
    }
}

Context contextOf(const glint_device& device, const glint_options* options) {
    Context context = device.context;
    if (options == nullptr) return context;
    const glint_options given = readStruct(options, "options");
    if (given.cancelled != nullptr) context.cancelled = [given] { return given.cancelled(given.user) != 0; };
    if (given.progress == nullptr) return context;
    struct Told {
        std::mutex mutex;
        double most = -1;
    };
    context.progress = [given, told = std::make_shared<Told>()](double fraction) {
        const std::lock_guard lock(told->mutex);
        if (!(fraction > told->most)) return;
        told->most = fraction;
        given.progress(given.user, fraction);
    };
    return context;
}

void runOnDevice(render::RayQueries& queries, render::RayTask task, const Context& context) {
    task.cancelled = context.cancelled;
    task.progress = context.progress;
    if (!queries.run(task)) throw Cancelled();
}

void forBlocks(const Context& context, uint64_t count,
               const std::function<void(uint64_t first, uint64_t end)>& body) {
    constexpr uint64_t kTurn = 1024;
    const uint64_t turns = (count + kTurn - 1) / kTurn;
    std::atomic<uint64_t> done = 0;
    parallelFor(context, turns, [&](size_t turn) {
        body(turn * kTurn, std::min((turn + 1) * kTurn, count));
        context.report(static_cast<double>(++done) / static_cast<double>(turns));
    });
}

}  // namespace glint::library
