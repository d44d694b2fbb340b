#include "pack/features.h"

#include "shared/dispatch.h"

namespace glint {
namespace {

void addLightKind(const shared::Light& light, SceneFeatures& features) {
    switch (light.kind) {
        case shared::kLightDirectional:
            features.directionalLights = true;
            break;
        case shared::kLightSpot:
        case shared::kLightSpotInverseSquare:
            features.spotLights = true;
            break;
        default:
            features.pointLights = true;
    }
}

}  // namespace

SceneFeatures featuresOf(const PackedScene& packed, const std::function<bool(size_t)>& used) {
    SceneFeatures f = packed.features;  // those of packTextures
#define GLINT_USES(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, crossings, loops, \
                   uv)                                                                                    \
    f.kinds = !packed.kinds.empty();
    GLINT_PRIMITIVES(GLINT_USES, 0)
#undef GLINT_USES
    for (const shared::Sphere& s : packed.spheres) f.anchoredSpheres |= s.anchorNormal != glm::vec3(0);
    f.splitTriangles = packed.statistics.splitTriangles > 0;
    f.vertexNormals = !packed.vertexNormals.empty();
    for (const shared::Light& light : packed.lights) addLightKind(light, f);
    for (size_t i = 0; i < packed.materials.size(); ++i) {
        if (!used(i)) continue;
        f.specular |= packed.materials[i].specular != glm::vec3(0);
        f.mirrors |= packed.environment.maxDepth > 0 && packed.materials[i].mirror != glm::vec3(0);
        if (packed.materials[i].medium == 0) continue;
        f.transmission = true;
        f.attenuation |= packed.optics[packed.materials[i].medium - 1].attenuation != glm::vec3(0);
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
