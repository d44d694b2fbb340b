// Rays and hits of all kinds of primitives: the prepared ray, slips, and the surface at a hit.
#include "reference/intersect.h"

#include <optional>
#include <stdexcept>

#include "core/vectors.h"
#include "reference/instance.h"
#include "reference/material.h"
#include "reference/rounding.h"

namespace glint::reference {
namespace {

using glm::dvec3;

// Calls visit with primitive `index` of a kind that can be hit.
template <class Visit>
auto visitHit(const Model& scene, uint32_t primitive, const Visit& visit) {
    using Result = decltype(visit(scene.planes[0]));
    return visitPrimitive(scene, kindOfPrimitive(primitive), primitive & shared::kLeafFirstMask,
                          [&](const auto& one) -> Result {
                              if constexpr (requires { one.toWorldX; })
                                  throw std::logic_error("an instance by itself cannot be hit");
                              else
                                  return visit(one);
                          });
}

uint32_t indexOf(uint32_t primitive) {
    return primitive & shared::kPrimitiveIndexMask;
}

// Interpolates vertex normals, as unit vectors in the world, to the shading normal.
void smoothTriangle(const Model& scene, const Hit& hit, const InstanceFrame* frame, Surface& surface) {
    const uint32_t index = scene.triangleSurfaces[indexOf(hit.primitive)].vertexNormals;
    if (index == shared::kNone) return;
    const rows::VertexNormals& normals = scene.vertexNormals[index];
    const auto inWorld = [&](const dvec3& normal) { return frame ? frame->normalInWorld(normal) : normal; };
    const dvec3 sum =
        (1 - hit.u - hit.v) * inWorld(normals.n0) + hit.u * inWorld(normals.n1) + hit.v * inWorld(normals.n2);
    const double length = glm::length(sum);
    if (length == 0) return;
    const double side = glm::dot(sum, surface.geometricNormal) < 0 ? -1 : 1;
    surface.shadingNormal = side / length * sum;
}

}  // namespace

// Squares of coordinates stay finite. From farther away, rays cannot resolve a scene in the range of fp32.
constexpr double kFarthestOrigin = 1e150;

PreparedRay::PreparedRay(const Ray& ray) : Ray(ray), inverse(1.0 / direction) {
    tMin = std::max(ray.tMin, 0.0);
    for (int i = 1; i < 3; ++i)
        if (std::abs(direction[i]) > std::abs(direction[kz])) kz = i;
    // Below 1e-290 the reciprocal of the direction would overflow; no t that a double holds leads anywhere
    // from there.
    valid = isFinite(origin) && isFinite(direction) && greatestMagnitude(origin) < kFarthestOrigin &&
            std::abs(direction[kz]) > 1e-290 && !std::isnan(ray.tMin) && !std::isnan(ray.tMax);
    kx = (kz + 1) % 3;
    ky = (kx + 1) % 3;
    shearX = direction[kx] / direction[kz];
    shearY = direction[ky] / direction[kz];
}

double heightError(const PreparedRay& ray, const dvec3& n, const dvec3& anchor, double t) {
    const dvec3 reach = glm::abs(anchor - ray.origin) + glm::abs(t * ray.direction);
    return kFloatUnit * glm::dot(glm::abs(n), 2.0 * glm::abs(anchor) + ray.slips * 6 * reach);
}

double slipOfFlat(const PreparedRay& ray, const dvec3& n, const dvec3& anchor, double t) {
    if (!ray.leaves && !ray.ties) return 0;
    const double height = heightError(ray, n, anchor, t) + ray.slips * ray.slip;
    return height / std::abs(glm::dot(n, ray.direction));
}

RoundRule::RoundRule(const PreparedRay& ray, const dvec3& g, const dvec3& magnitudes, const dvec3& anchor,
                     double t, double sums)
    : gradient(g),
      spread(magnitudes),
      error(heightError(ray, spread, anchor, t) + kFloatUnit * ray.slips * 12 * sums) {}

double RoundRule::slip(const PreparedRay& ray) const {
    const double speed = std::abs(glm::dot(gradient, ray.direction));
    const double least = 0x1p-11 * greatestMagnitude(spread) * greatestMagnitude(ray.direction);
    return error / std::max({speed, least, std::numeric_limits<double>::min()});
}

Surface Tracer::surfaceAt(const Ray& worldRay, const Hit& worldHit) const {
    Surface surface = namesAt(worldHit);
    Hit hit = worldHit;
    if (hit.isTriangle() && isMirrored(scene_, hit.instance)) std::swap(hit.u, hit.v);
    std::optional<InstanceFrame> frame;
    if (hit.instance != shared::kNone) frame.emplace(scene_.instances[hit.instance]);
    const Ray ray = frame ? frame->enterInstance(worldRay) : worldRay;
    const dvec3 point = ray.origin + hit.t * ray.direction;
    visitHit(scene_, hit.primitive, [&](const auto& primitive) {
        surfaceOf(primitive, {scene_, methods(), ray, hit, point}, surface);
    });
    if (frame) {
        surface.error = frame->errorInWorld(surface.position, surface.error);
        surface.position = frame->pointInWorld(surface.position);
        surface.geometricNormal = frame->normalInWorld(surface.geometricNormal);
        surface.bend *= frame->stretch();
        surface.scale = frame->scaleInWorld(surface.scale);
    }
    surface.scale = std::max(greatestMagnitude(surface.position), surface.scale);
    surface.shadingNormal = surface.geometricNormal;
    if (hit.isTriangle()) {
        smoothTriangle(scene_, hit, frame ? &*frame : nullptr, surface);
        triangleAttributes(scene_, hit, surface);
    } else {
        fillObjectUv(scene_, worldRay, hit, surface);
    }
    surface.uvScale = glm::max(surface.uvScale, glm::abs(surface.uv));
    return surface;
}

Surface Tracer::namesAt(const Hit& hit) const {
    Surface surface;
    const auto take = [&](const auto& named) {
        surface.object = named.object;
        surface.primitive = named.primitive;
        surface.material = named.material;
    };
    visitHit(scene_, hit.primitive, [&](const auto& primitive) {
        if constexpr (requires { primitive.material; })
            take(primitive);
        else
            take(scene_.triangleSurfaces[indexOf(hit.primitive)]);
    });
    if (hit.instance == shared::kNone) return surface;
    const rows::Instance& instance = scene_.instances[hit.instance];
    surface.object = instance.object;
    if (instance.material != shared::kNone) surface.material = instance.material;
    return surface;
}

}  // namespace glint::reference
