#include "library/ray_reader.h"

#include <algorithm>

#include "library/status.h"

namespace glint::library {

namespace {

// So many rays before it is needed the processor is told to load what is in no order.
constexpr size_t kAhead = 16;

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

void HitWriter::foresee(uint64_t i) const {
    for (const Output* out : {&hit_, &t_, &geometry_, &primitive_, &material_, &uv_, &point_, &normal_})
        out->foresee(i);
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
    const bool found = hit.primitive != shared::kNone;
    hit_.putFlag(i, found ? 1 : 0);
    if (!found) {
        writeMiss(i);
        return;
    }
    t_.put(i, ray.worldT(hit.t));
    const bool triangle = hit.primitive >> shared::kPrimitiveKindShift == shared::kKindTriangle;
    uv_.put(i, triangle ? hit.u : 0, triangle ? hit.v : 0);
    if (!places_ && !surfaces_) return;
    const PackedScene& packed = part_.packed;
    const reference::Surface surface = part_.tracer().surfaceAt(referenceRay(ray), hit);
    geometry_.putIndex(i, surface.object);
    primitive_.putIndex(i, surface.primitive);
    material_.putIndex(i, surface.material);
    point_.put(i, packed.origin + surface.position);
    normal_.put(i, surface.geometricNormal);
}

// What Tracer::surfaceAt would say of a triangle without instances, by the same operations.
void HitWriter::writeTriangle(uint64_t i, const render::FoundHit& hit) const {
    const PackedScene& packed = part_.packed;
    const uint32_t index = hit.primitive & shared::kPrimitiveIndexMask;
    uv_.put(i, static_cast<double>(hit.u), static_cast<double>(hit.v));
    if (places_) {
        const shared::TriangleSurface& details = packed.triangleSurfaces[index];
        geometry_.putIndex(i, details.object);
        primitive_.putIndex(i, details.primitive);
        material_.putIndex(i, details.material);
    }
    if (!surfaces_) return;
    const shared::Triangle& triangle = packed.triangles[index];
    const glm::dvec3 v0(triangle.v0), v1(triangle.v1), v2(triangle.v2);
    if (normal_.wanted()) normal_.put(i, glm::normalize(glm::cross(v1 - v0, v2 - v0)));
    if (!point_.wanted()) return;
    const double u = static_cast<double>(hit.u), v = static_cast<double>(hit.v);
    point_.put(i, packed.origin + ((1 - u - v) * v0 + u * v1 + v * v2));
}

void HitWriter::write(const render::RayNumbers& numbers, std::span<const render::FoundHit> found,
                      const RayReader& rays, bool rescaled) const {
    for (size_t k = 0; k < found.size(); ++k) {
        const uint64_t i = numbers[k];
        if (numbers.order != nullptr && k + kAhead < found.size()) foresee(numbers[k + kAhead]);
        const render::FoundHit& hit = found[k];
        const bool triangle = hit.primitive >> shared::kPrimitiveKindShift == shared::kKindTriangle;
        const double t = static_cast<double>(hit.t);
        if (hit.primitive == shared::kNone) {
            hit_.putFlag(i, 0);
            writeMiss(i);
        } else if (triangle && hit.instance == shared::kNone) {
            hit_.putFlag(i, 1);
            if (t_.wanted()) t_.put(i, rescaled ? rays.local(i).worldT(t) : t);
            writeTriangle(i, hit);
        } else {
            write(
                i, rays.local(i),
                {t, static_cast<double>(hit.u), static_cast<double>(hit.v), hit.primitive, 0, hit.instance});
        }
    }
}

Callbacks::Callbacks(const glint_options* options) {
    if (options == nullptr) return;
    const glint_options given = readStruct(options, "options");
    if (given.cancelled != nullptr) cancelled = [given] { return given.cancelled(given.user) != 0; };
    if (given.progress != nullptr)
        progress = [given](double fraction) { given.progress(given.user, fraction); };
}

void reportCancelled() {
    throw Failure(GLINT_ERROR_CANCELLED, "cancelled by the caller");
}

}  // namespace glint::library
