#include <algorithm>
#include <cmath>
#include <limits>

#include "bvh/packed_scene.h"

namespace glint {
namespace {

double greatest(const glm::vec3& v) {
    return std::max({v.x, v.y, v.z});
}

bool fallsOff(const shared::Light& light) {
    return light.kind == shared::kLightPointInverseSquare || light.kind == shared::kLightSpotInverseSquare;
}

double distanceToBox(const glm::dvec3& p, const glm::vec3& lo, const glm::vec3& hi) {
    const glm::dvec3 outside = glm::max(glm::max(glm::dvec3(lo) - p, p - glm::dvec3(hi)), glm::dvec3(0));
    return glm::length(outside);
}

// No surface is nearer to the point: the least distance to a leaf's box or a plane.
double clearance(const PackedScene& scene, const glm::dvec3& point) {
    double least = std::numeric_limits<double>::infinity();
    for (const shared::Node& node : scene.nodes) {
        if (node.child0 & shared::kLeafFlag && node.child0 != shared::kNone)
            least = std::min(least, distanceToBox(point, node.lo0, node.hi0));
        if (node.child1 & shared::kLeafFlag && node.child1 != shared::kNone)
            least = std::min(least, distanceToBox(point, node.lo1, node.hi1));
    }
    for (const shared::Plane& plane : scene.planes) {
        const glm::dvec3 offset = point - glm::dvec3(plane.point);
        least = std::min(least, std::abs(glm::dot(glm::dvec3(plane.normal), offset)));
    }
    return least;
}

double lightBound(const PackedScene& scene) {
    double sum = 0;
    for (const shared::Light& light : scene.lights) {
        const double d = fallsOff(light) ? clearance(scene, glm::dvec3(light.position)) : 1;
        sum += greatest(light.intensity) / (d * d);
    }
    return sum;
}

}  // namespace

float radianceBound(const PackedScene& scene, uint32_t maxDepth) {
    const double lights = lightBound(scene);
    const double background = greatest(scene.environment.background);
    const double ambient = greatest(scene.environment.ambient);
    double bound = background;
    for (uint32_t depth = 0; depth <= maxDepth; ++depth) {
        double next = background;
        for (const shared::Material& m : scene.materials) {
            const double reflected = greatest(m.diffuse) + greatest(m.specular);
            const double local = greatest(m.ambient) * ambient + (reflected > 0 ? reflected * lights : 0);
            // R + (1 - R) t <= 1, whatever R.
            const double branches = greatest(m.mirror) + (m.medium != 0 ? 1 : 0);
            next = std::max(next, local + (depth > 0 ? branches * bound : 0));
        }
        if (next == bound && depth > 0) break;
        bound = next;
    }
    return bound < static_cast<double>(shared::kInfinity) ? static_cast<float>(bound) : shared::kInfinity;
}

}  // namespace glint
