#include "pack/region.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "pack/instances.h"
#include "pack/pack_geometry.h"
#include "pack/quadrics.h"
#include "pack/unit_vector.h"
#include "scene/placement.h"

namespace glint {
namespace {

double largestComponent(const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

glm::dvec3 nearestOnPlane(const glm::dvec3& from, const glm::dvec3& point, const glm::dvec3& normal) {
    return from - glm::dot(from - point, normal) * normal;
}

Region boundsOfChunk(const Scene& scene, const PrimitiveNumbers& numbers, const Instances* instances,
                     size_t chunk) {
    Region region;
    numbers.visitChunk(chunk, [&](uint32_t object, uint32_t begin, uint32_t end) {
        const Object& o = scene.objects[object];
        if (kindOf(o) == shared::kKindInstance) {
            for (const glm::dvec3& corner : instances->corners(scene, object)) region.include(corner);
            return;
        }
        if (const auto* sphere = std::get_if<SphereShape>(&o.shape)) {
            region.include(sphere->center - sphere->radius);
            region.include(sphere->center + sphere->radius);
        }
        if (const auto* disc = std::get_if<DiscShape>(&o.shape)) {
            const glm::dvec3 extent = discExtent(disc->normal, disc->radius);
            region.include(disc->center - extent);
            region.include(disc->center + extent);
        }
        if (const auto* polygon = std::get_if<PolygonShape>(&o.shape))
            for (const glm::dvec3& vertex : polygon->vertices) region.include(vertex);
        if (isQuadric(o.shape)) {
            const Extent extent = quadricExtent(o);
            region.include(extent.lo);
            region.include(extent.hi);
        }
        const TriangleSource source(o);
        if (!source.any()) return;
        for (uint32_t face = begin; face < end; ++face)
            for (const glm::dvec3& vertex : source.vertices(face)) region.include(vertex);
    });
    return region;
}

}  // namespace

void Region::include(const glm::dvec3& p) {
    if (!(largestComponent(p) <= std::numeric_limits<float>::max())) return;
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
}

void Region::include(const Region& r) {
    lo = glm::min(lo, r.lo);
    hi = glm::max(hi, r.hi);
}

double Region::halfExtent() const {
    return largestComponent(0.5 * hi - 0.5 * lo);
}

Region geometryRegion(const Scene& scene, const PrimitiveNumbers& numbers, const Instances* instances,
                      unsigned threads) {
    std::vector<Region> parts(numbers.chunks());
    const auto measure = [&](size_t i) { parts[i] = boundsOfChunk(scene, numbers, instances, i); };
    parallelFor(parts.size(), measure, threads);
    Region region;
    for (const Region& part : parts) region.include(part);
    return region;
}

Region sceneRegion(const Scene& scene, const PrimitiveNumbers& numbers, const Instances* instances,
                   unsigned threads) {
    Region region = geometryRegion(scene, numbers, instances, threads);

    const glm::dvec3& eye = scene.camera.eye;
    if (region.empty()) {
        region.include(scene.camera.target);
        for (const Object& object : scene.objects) {
            const auto* plane = std::get_if<PlaneShape>(&object.shape);
            if (plane == nullptr) continue;
            if (const auto normal = unitVector(plane->normal))
                region.include(nearestOnPlane(eye, plane->point, *normal));
        }
    }
    region.include(eye);
    return region;
}

glm::dvec3 originOf(const Region& region) {
    constexpr double kFar = 64;  // half-extents: 6 bits
    const double extent = region.halfExtent();
    const glm::dvec3 center = region.center();
    if (!(extent > 0) || !(largestComponent(center) > kFar * extent)) return glm::dvec3(0);
    int exponent = 0;
    std::frexp(extent, &exponent);  // extent = m 2^exponent, m in [0.5, 1)
    const double step = std::ldexp(1.0, exponent);
    return glm::round(center / step) * step;
}

glm::dvec3 chooseOrigin(const Scene& given, unsigned threads) {
    Scene copy;
    const Scene& scene = placedScene(given, copy);
    const PrimitiveNumbers numbers(scene);
    const Instances instances(scene, numbers, PackOptions{threads});
    return originOf(sceneRegion(scene, numbers, &instances, threads));
}

glm::dvec3 planeAnchor(const glm::dvec3& point, const glm::dvec3& normal, const Region& region) {
    constexpr double kMuchFarther = 16;
    const glm::dvec3 center = region.center();
    const glm::dvec3 nearest = nearestOnPlane(center, point, normal);
    const double needed = std::max(region.halfExtent(), glm::distance(nearest, center));
    return glm::distance(point, center) > kMuchFarther * needed ? nearest : point;
}

}  // namespace glint
