#include "pack/request_environment.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace glint {
namespace {

double greatest(const glm::vec3& v) {
    return std::max({v.x, v.y, v.z});
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

double lightBound(const PackedScene& scene, const std::vector<shared::Light>& all) {
    double sum = 0;
    for (const shared::Light& light : all) {
        if (greatest(light.intensity) == 0) continue;  // 0 / 0 where it touches a box
        const bool fades = (light.kind & shared::kLightFades) != 0;
        const double d = fades ? clearance(scene, glm::dvec3(light.position)) : 1;
        sum += greatest(light.intensity) / (d * d);
    }
    return sum;
}

// The greatest factor that a texture (1 + its index, 0 for none) has anywhere.
double brightest(const PackedScene& scene, uint32_t number) {
    if (number == 0) return 1;
    const shared::Texture& texture = scene.textures[number - 1];
    if (texture.flags & shared::kTextureChecker)
        return std::max(greatest(texture.colorA), greatest(texture.colorB));
    double most = 0;
    const size_t count = static_cast<size_t>(texture.width) * texture.height;
    for (size_t i = 0; i < count; ++i)
        most = std::max<double>(most, greatest(scene.texels[texture.firstTexel + i].color));
    return most;
}

double brightestVertex(const PackedScene& scene) {
    double most = 1;
    for (const shared::TriangleSurface& surface : scene.triangleSurfaces) {
        if ((surface.attributes & shared::kAttributeColors) == 0) continue;
        const size_t row = (surface.attributes & shared::kAttributeFirstMask) +
                           ((surface.attributes & shared::kAttributeUvs) != 0 ? 2 : 0);
        for (size_t i = 0; i < 3; ++i)
            most = std::max<double>(most, greatest(scene.vertexAttributes[row + i].value));
    }
    return most;
}

// The greatest sums that a material reflects of lights, of ambient light, and into branches.
struct Reflection {
    double ofLights, ofAmbient, branches;
};

Reflection reflectionOf(const PackedScene& scene, const shared::Material& m, double vertex) {
    Reflection r;
    r.ofLights = greatest(m.diffuse) * vertex * brightest(scene, m.diffuseTexture) +
                 greatest(m.specular) * brightest(scene, m.specularTexture);
    r.ofAmbient = greatest(m.ambient) * vertex * brightest(scene, m.ambientTexture);
    // R + (1 - R) t <= max(1, t) for every R.
    const double passed =
        m.medium == 0 ? 0 : std::max(1.0, brightest(scene, scene.optics[m.medium - 1].transmissionTexture));
    r.branches = greatest(m.mirror) * brightest(scene, m.mirrorTexture) + passed;
    return r;
}

}  // namespace

float radianceBound(const PackedScene& scene, const shared::Environment& environment,
                    const std::vector<shared::Light>& all) {
    const double lights = lightBound(scene, all);
    const double background = greatest(environment.background) * brightest(scene, environment.map);
    const double ambient = greatest(environment.ambient);
    std::vector<Reflection> reflections;
    const double vertex = brightestVertex(scene);
    for (const shared::Material& m : scene.materials) reflections.push_back(reflectionOf(scene, m, vertex));
    double bound = background;
    for (uint32_t depth = 0; depth <= environment.maxDepth; ++depth) {
        double next = background;
        for (const Reflection& r : reflections) {
            const double local = r.ofAmbient * ambient + (r.ofLights > 0 ? r.ofLights * lights : 0);
            next = std::max(next, local + (depth > 0 && r.branches > 0 ? r.branches * bound : 0));
        }
        if (next == bound && depth > 0) break;
        bound = next;
    }
    return bound < static_cast<double>(shared::kInfinity) ? static_cast<float>(bound) : shared::kInfinity;
}

uint32_t depthOf(const PackedScene& scene, const Tracing& tracing) {
    return tracing.limits.depth.value_or(scene.environment.maxDepth);
}

shared::Environment environmentOf(const PackedScene& scene, const Tracing& tracing) {
    shared::Environment environment = scene.environment;
    environment.maxDepth = depthOf(scene, tracing);
    environment.minContribution = static_cast<float>(tracing.limits.minContribution);
    if (tracing.lighting) {
        environment.lightCount = static_cast<uint32_t>(tracing.lighting->lights.size());
        environment.background = tracing.lighting->background;
    }
    return environment;
}

shared::Environment cameraEnvironment(const PackedScene& scene, const Request& request) {
    shared::Environment environment = environmentOf(scene, request);
    const glm::vec3 eye = cameraOf(scene, request).eye;
    if (eye != scene.eye) setEye(scene, eye, environment);
    return environment;
}

float radianceBoundOf(const PackedScene& scene, const Tracing& tracing) {
    const bool deeper = depthOf(scene, tracing) > scene.environment.maxDepth;
    if (!tracing.lighting && !deeper) return scene.environment.radianceBound;
    const shared::Environment environment = environmentOf(scene, tracing);
    return radianceBound(scene, environment, lightsOf(scene, tracing));
}

}  // namespace glint
