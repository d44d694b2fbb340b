#include "pack/extent.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "pack/instances.h"
#include "pack/kind_packer.h"
#include "pack/pack_geometry.h"
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

Extent boundsOfChunk(const Scene& scene, const PrimitiveNumbers& numbers, const Instances* instances,
                     size_t chunk) {
    Extent extent;
    numbers.visitChunk(chunk, [&](uint32_t object, uint32_t begin, uint32_t end) {
        const Object& o = scene.objects[object];
        const shared::PrimitiveKind kind = kindOf(o);
        if (kind == shared::PrimitiveKind::Instance) {
            for (const glm::dvec3& corner : instances->corners(scene, object)) extent.include(corner);
        } else {
            packerOf(kind).extend(o, begin, end, extent);
        }
    });
    return extent;
}

}  // namespace

void Extent::include(const glm::dvec3& p) {
    if (!(largestComponent(p) <= std::numeric_limits<float>::max())) return;
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
}

void Extent::include(const Extent& other) {
    lo = glm::min(lo, other.lo);
    hi = glm::max(hi, other.hi);
}

double Extent::halfSize() const {
    return largestComponent(0.5 * hi - 0.5 * lo);
}

Extent geometryExtent(const Scene& scene, const PrimitiveNumbers& numbers, const Instances* instances,
                      unsigned threads) {
    std::vector<Extent> parts(numbers.chunks());
    const auto measure = [&](size_t i) { parts[i] = boundsOfChunk(scene, numbers, instances, i); };
    parallelFor(parts.size(), measure, threads);
    Extent extent;
    for (const Extent& part : parts) extent.include(part);
    return extent;
}

Extent withCamera(const Extent& geometry, const Scene& scene) {
    Extent extent = geometry;
    const glm::dvec3& eye = scene.camera.eye;
    if (extent.empty()) {
        extent.include(scene.camera.target);
        for (const Object& object : scene.objects) {
            const auto* plane = std::get_if<PlaneShape>(&object.shape);
            if (plane == nullptr) continue;
            if (const auto normal = unitVector(plane->normal))
                extent.include(nearestOnPlane(eye, plane->point, *normal));
        }
    }
    extent.include(eye);
    return extent;
}

glm::dvec3 originOf(const Extent& extent) {
    constexpr double kFar = 64;  // half-extents: 6 bits
    const double size = extent.halfSize();
    const glm::dvec3 center = extent.center();
    if (!(size > 0) || !(largestComponent(center) > kFar * size)) return glm::dvec3(0);
    int exponent = 0;
    std::frexp(size, &exponent);  // size = m 2^exponent, m in [0.5, 1)
    const double step = std::ldexp(1.0, exponent);
    return glm::round(center / step) * step;
}

glm::dvec3 chooseOrigin(const Scene& given, unsigned threads) {
    Scene copy;
    const Scene& scene = placedScene(given, copy);
    const PrimitiveNumbers numbers(scene);
    const Instances instances(scene, numbers, PackOptions{threads});
    return originOf(withCamera(geometryExtent(scene, numbers, &instances, threads), scene));
}

glm::dvec3 planeAnchor(const glm::dvec3& point, const glm::dvec3& normal, const Extent& extent) {
    constexpr double kMuchFarther = 16;
    const glm::dvec3 center = extent.center();
    const glm::dvec3 nearest = nearestOnPlane(center, point, normal);
    const double needed = std::max(extent.halfSize(), glm::distance(nearest, center));
    return glm::distance(point, center) > kMuchFarther * needed ? nearest : point;
}

}  // namespace glint
