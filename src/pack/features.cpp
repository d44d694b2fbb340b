#include "pack/pack_geometry.h"

#include <algorithm>
#include <atomic>

#include "core/device_layout.h"
#include "core/parallel.h"
#include "pack/primitives.h"

namespace glint {
namespace {

// Measured: no ray of 10^5 hit a triangle behind it if the longest side was at most 16 times the height above
// it, none of 1.2 x 10^6 up to 40 times, one of 10^5 up to 64 times
// (SliverTest.TrianglesBehindARayAreNotMet).
bool isSliver(const shared::Triangle& t) {
    constexpr float kLongest = 16;
    const glm::vec3 a = t.v1 - t.v0, b = t.v2 - t.v0, c = t.v2 - t.v1;
    const glm::vec3 n = glm::cross(a, b);
    const float longest = std::max(glm::dot(a, a), std::max(glm::dot(b, b), glm::dot(c, c)));
    return longest > kLongest * glm::length(n);
}

}  // namespace

bool haveSlivers(const std::vector<shared::Triangle>& triangles, const Context& context) {
    constexpr size_t kRun = 16384;
    std::atomic<bool> found = false;
    parallelFor(context, (triangles.size() + kRun - 1) / kRun, [&](size_t run) {
        const size_t end = std::min(triangles.size(), (run + 1) * kRun);
        for (size_t i = run * kRun; i < end && !found.load(std::memory_order_relaxed); ++i)
            if (isSliver(triangles[i])) found.store(true, std::memory_order_relaxed);
    });
    return found;
}

SceneFeatures featuresOf(const PackedScene& packed, const Materials& materials, const Context& context) {
    SceneFeatures f = packed.features;  // those of packTextures
#define GLINT_USES(number, Kind, KINDS, kinds, one, many) f.kinds = !packed.kinds.empty();
    GLINT_PRIMITIVES(GLINT_USES, GLINT_USES)
#undef GLINT_USES
    for (const shared::Sphere& s : packed.spheres) f.anchoredSpheres |= s.anchorNormal != glm::vec3(0);
    f.splitTriangles = packed.statistics.splitTriangles > 0;
    f.slivers = haveSlivers(packed.triangles, context);
    f.vertexNormals = !packed.vertexNormals.empty();
    for (const shared::Light& light : packed.lights) {
        const uint32_t kind = light.kind & shared::kLightKindMask;
        f.pointLights |= kind == shared::kLightPoint;
        f.directionalLights |= kind == shared::kLightDirectional;
        f.spotLights |= kind == shared::kLightSpot;
    }
    for (size_t i = 0; i < packed.materials.size(); ++i) {
        if (!materials.used(i)) continue;
        f.specular |= packed.materials[i].specular != glm::vec3(0);
        f.mirrors |= packed.environment.maxDepth > 0 && packed.materials[i].mirror != glm::vec3(0);
        if (packed.materials[i].medium == 0) continue;
        f.transmission = true;
        const shared::Optics& optics = packed.optics[packed.materials[i].medium - 1];
        f.attenuation |= optics.attenuation != glm::vec3(0);
        f.texturedGlass |= optics.transmissionTexture != 0;
    }
    for (const shared::Plane& plane : packed.planes) {
        const shared::Material& material = packed.materials[plane.material];
        f.openPlanes |= material.alphaCutoff > 0 || material.medium != 0;
    }
    return f;
}

SceneFeatures allFeatures() {
    SceneFeatures f;
#define GLINT_SET(ID, NAME, field) f.field = true;
    GLINT_FEATURES(GLINT_SET)
#undef GLINT_SET
    return f;
}

}  // namespace glint
