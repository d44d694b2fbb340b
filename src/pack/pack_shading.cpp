#include "pack/pack_shading.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pack/unit_vector.h"

namespace glint {
namespace {

shared::Material roundMaterial(const Material& material) {
    shared::Material out;
    out.ambient = glm::vec3(material.ambient);
    out.diffuse = glm::vec3(material.diffuse);
    out.specular = glm::vec3(material.specular);
    out.shininess = static_cast<float>(material.shininess);
    out.mirror = glm::vec3(material.mirror);
    return out;
}

shared::Optics roundOptics(const Material& material) {
    // exp(-120) is no normal float: nothing gets through.
    constexpr double kOpaque = 120;
    shared::Optics out;
    out.transmission = glm::vec3(material.transmission);
    out.ior = static_cast<float>(material.ior);
    out.attenuation = glm::vec3(material.attenuation);
    out.rank = shared::kRankOfZero + static_cast<uint32_t>(material.priority);
    for (int i = 0; i < 3; ++i) {
        const double part = material.transmission[i];
        out.density[i] = static_cast<float>(part > 0 ? std::min(-std::log(part), kOpaque) : kOpaque);
    }
    return out;
}

// 1 - cos, without its cancellation for small angles.
float oneMinusCosine(double degrees) {
    const double half = std::sin(degrees * (std::numbers::pi / 360));
    return static_cast<float>(2 * half * half);
}

}  // namespace

shared::Light packLight(const Light& light, const glm::dvec3& origin) {
    shared::Light out;
    if (const auto* point = std::get_if<PointLight>(&light)) {
        out.position = glm::vec3(point->position - origin);
        out.kind =
            point->falloff == Falloff::InverseSquare ? shared::kLightPointInverseSquare : shared::kLightPoint;
        out.intensity = glm::vec3(point->intensity);
    } else if (const auto* spot = std::get_if<SpotLight>(&light)) {
        out.position = glm::vec3(spot->position - origin);
        out.kind =
            spot->falloff == Falloff::InverseSquare ? shared::kLightSpotInverseSquare : shared::kLightSpot;
        out.intensity = glm::vec3(spot->intensity);
        out.axis = glm::vec3(unitVector(spot->direction).value());
        out.inner = oneMinusCosine(spot->angle);
        out.outer = oneMinusCosine(spot->angle + spot->penumbra);
    } else {
        const auto& directional = std::get<DirectionalLight>(light);
        out.position = glm::vec3(unitVector(-directional.direction).value());
        out.kind = shared::kLightDirectional;
        out.intensity = glm::vec3(directional.intensity);
    }
    return out;
}

void packShading(const Scene& scene, PackedScene& packed) {
    for (const Material& material : scene.materials) {
        packed.materials.push_back(roundMaterial(material));
        if (material.transmission == Color(0)) continue;
        packed.optics.push_back(roundOptics(material));
        packed.materials.back().medium = static_cast<uint32_t>(packed.optics.size());
    }
    for (const Light& light : scene.lights) packed.lights.push_back(packLight(light, packed.origin));
    shared::Environment& environment = packed.environment;
    environment.background = glm::vec3(scene.background);
    environment.ambient = glm::vec3(scene.ambient);
    environment.root = packed.nodes.empty() ? shared::kNone : 0;
    environment.planeCount = static_cast<uint32_t>(packed.planes.size());
    environment.lightCount = static_cast<uint32_t>(packed.lights.size());
    environment.maxDepth = static_cast<uint32_t>(scene.maxDepth);
}

}  // namespace glint
