#include "pack/extent.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/vectors.h"
#include "pack/primitives.h"

namespace glint {
namespace {

// The plane's point nearest to `from`. normal: unit.
glm::dvec3 nearestOnPlane(const glm::dvec3& from, const glm::dvec3& point, const glm::dvec3& normal) {
    return from - glm::dot(from - point, normal) * normal;
}

Extent boundsOf(const Scene& scene, uint32_t object, uint32_t begin, uint32_t end, const CornersOf& corners) {
    Extent extent;
    const Object& o = scene.objects[object];
    const shared::PrimitiveKind kind = kindOf(o);
    if (kind == shared::PrimitiveKind::Instance) {
        for (const glm::dvec3& corner : corners(object)) extent.include(corner);
    } else {
        packerOf(kind).extend(o, begin, end, extent);
    }
    return extent;
}

// First and last object of a chunk that continue in other chunks.
struct Piece {
    uint32_t object;
    Extent extent;
};

double medianOf(std::vector<double>& values) {
    const auto upper = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), upper, values.end());
    return values.size() % 2 == 1 ? *upper : 0.5 * (*upper + *std::max_element(values.begin(), upper));
}

glm::dvec3 medianCenter(const std::vector<Extent>& extents) {
    glm::dvec3 middle;
    std::vector<double> values(extents.size());
    for (int axis = 0; axis < 3; ++axis) {
        for (size_t i = 0; i < extents.size(); ++i) values[i] = extents[i].center()[axis];
        middle[axis] = medianOf(values);
    }
    return middle;
}

// How far each reaches from a point, along an axis.
std::vector<double> reachesFrom(const glm::dvec3& point, const std::vector<Extent>& extents) {
    std::vector<double> reaches;
    reaches.reserve(extents.size());
    for (const Extent& e : extents)
        reaches.push_back(std::max(greatestMagnitude(e.lo - point), greatestMagnitude(e.hi - point)));
    return reaches;
}

double lowerMedianOf(std::vector<double> values) {
    const auto lower = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
    std::nth_element(values.begin(), lower, values.end());
    return *lower;
}

}  // namespace

glm::dvec3 planeAnchor(const glm::dvec3& point, const glm::dvec3& normal, const Extent& extent) {
    constexpr double kMuchFarther = 16;
    const glm::dvec3 center = extent.center();
    const glm::dvec3 nearest = nearestOnPlane(center, point, normal);
    const double needed = std::max(extent.halfSize(), glm::distance(nearest, center));
    return glm::distance(point, center) > kMuchFarther * needed ? nearest : point;
}

std::vector<Extent> objectExtents(const Scene& scene, const PrimitiveNumbers& numbers,
                                  const CornersOf& corners, const Context& context) {
    std::vector<Extent> extents(scene.objects.size());
    std::vector<std::vector<Piece>> pieces(numbers.chunks());
    const auto measure = [&](size_t chunk) {
        numbers.visitChunk(chunk, [&](uint32_t object, uint32_t begin, uint32_t end) {
            const Extent extent = boundsOf(scene, object, begin, end, corners);
            if (begin == 0 && end == numbers.facesOf(object))
                extents[object] = extent;
            else
                pieces[chunk].push_back({object, extent});
        });
    };
    parallelFor(context, pieces.size(), measure);
    for (const std::vector<Piece>& chunk : pieces)
        for (const Piece& piece : chunk) extents[piece.object].include(piece.extent);
    return extents;
}

Geometry geometryOf(const Scene& scene, std::vector<Extent> objects) {
    Geometry geometry;
    std::erase_if(objects, [](const Extent& e) { return e.empty(); });
    if (objects.empty()) {
        const Extent seen = withCamera(geometry.extent, scene);
        geometry.middle = seen.center();
        geometry.reach = seen.halfSize();
        return geometry;
    }
    for (const Extent& e : objects) geometry.extent.include(e);
    // Twice: the first median may lie between a planet's centre and what stands on it.
    const std::vector<double> reaches = reachesFrom(medianCenter(objects), objects);
    const double most = lowerMedianOf(reaches);
    std::vector<Extent> nearer;
    for (size_t i = 0; i < objects.size(); ++i)
        if (reaches[i] <= most) nearer.push_back(objects[i]);
    geometry.middle = medianCenter(nearer);
    geometry.reach = lowerMedianOf(reachesFrom(geometry.middle, objects));
    return geometry;
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

glm::dvec3 originOf(const glm::dvec3& middle, double reach, double looksFrom) {
    constexpr double kFar = 4;  // times as far as anything that is looked at: 2 bits
    if (!(reach > 0) || !(greatestMagnitude(middle) > kFar * std::max(reach, looksFrom)))
        return glm::dvec3(0);
    int exponent = 0;
    std::frexp(reach, &exponent);  // reach = m 2^exponent, m in [0.5, 1)
    const double step = std::ldexp(1.0, exponent);
    return glm::round(middle / step) * step;
}

glm::dvec3 originOf(const Geometry& geometry, const glm::dvec3& eye) {
    constexpr double kOutOfSight = 4096;  // reaches of the geometry: beyond, it is smaller than a pixel
    if (geometry.extent.empty()) return originOf(geometry.middle, geometry.reach, 0);
    const glm::dvec3 nearest = glm::clamp(eye, geometry.extent.lo, geometry.extent.hi);
    const bool seesNothing = greatestMagnitude(eye - nearest) > kOutOfSight * geometry.reach;
    return originOf(geometry.middle, geometry.reach,
                    seesNothing ? 0 : greatestMagnitude(geometry.middle - eye));
}

}  // namespace glint
