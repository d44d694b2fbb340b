#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/vectors.h"
#include "pack/build_tree.h"
#include "pack/dielectric_rank.h"
#include "pack/extent.h"
#include "pack/instances.h"
#include "pack/pack_geometry.h"
#include "pack/pack_textures.h"
#include "pack/packed_scene.h"
#include "pack/primitives.h"
#include "pack/request_environment.h"
#include "scene/placement.h"

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

uint32_t fading(Falloff falloff) {
    return falloff == Falloff::InverseSquare ? shared::kLightFades : 0;
}

shared::Light rounded(const PointLight& light, const glm::dvec3& origin) {
    return {.position = glm::vec3(light.position - origin),
            .kind = shared::kLightPoint | fading(light.falloff),
            .intensity = glm::vec3(light.intensity)};
}

shared::Light rounded(const DirectionalLight& light, const glm::dvec3&) {
    return {.position = glm::vec3(unitVector(-light.direction).value()),
            .kind = shared::kLightDirectional,
            .intensity = glm::vec3(light.intensity)};
}

shared::Light rounded(const SpotLight& light, const glm::dvec3& origin) {
    return {.position = glm::vec3(light.position - origin),
            .kind = shared::kLightSpot | fading(light.falloff),
            .intensity = glm::vec3(light.intensity),
            .inner = oneMinusCosine(light.angle),
            .axis = glm::vec3(unitVector(light.direction).value()),
            .outer = oneMinusCosine(light.angle + light.penumbra)};
}

}  // namespace

std::vector<shared::Light> packLights(std::span<const Light> lights, const glm::dvec3& origin) {
    std::vector<shared::Light> rows;
    for (const Light& light : lights)
        rows.push_back(std::visit([&](const auto& one) { return rounded(one, origin); }, light));
    return rows;
}

void packPlanes(const Scene& scene, const PrimitiveNumbers& numbers, PackedScene& packed) {
    const Extent extent = withCamera(packed.geometry.extent, scene);
    packed.planes.clear();
    for (uint32_t i = 0; i < scene.objects.size(); ++i) {
        const auto* plane = std::get_if<PlaneShape>(&scene.objects[i].shape);
        if (plane == nullptr) continue;
        const glm::dvec3 normal = unitVector(plane->normal).value();
        shared::Plane out;
        out.point = glm::vec3(planeAnchor(plane->point, normal, extent) - packed.origin);
        out.normal = glm::vec3(normal);
        out.id = numbers.firstId(i);
        out.object = i;
        out.material = scene.objects[i].material;
        packed.planes.push_back(out);
    }
    checkLimit("planes", packed.planes.size(), shared::kMaxPlanes);
}

void setEye(const PackedScene& scene, const glm::vec3& eye, shared::Environment& environment) {
    if (!scene.features.transmission) return;
    const glm::uvec4 media = mediaAt(scene, glm::dvec3(eye));
    environment.eyeMedium0 = media.x;
    environment.eyeMedium1 = media.y;
    environment.eyeMedium2 = media.z;
    environment.eyeMedium3 = media.w;
}

namespace {

// Rounds materials, optics, lights and the numbers that all rays share, once the tree and the planes are
// packed.
void packShading(const Scene& scene, PackedScene& packed) {
    for (const Material& material : scene.materials) {
        packed.materials.push_back(roundMaterial(material));
        if (material.transmission == Color(0)) continue;
        packed.optics.push_back(roundOptics(material));
        packed.materials.back().medium = static_cast<uint32_t>(packed.optics.size());
    }
    packed.lights = packLights(scene.lights, packed.origin);
    shared::Environment& environment = packed.environment;
    environment.background = glm::vec3(scene.background);
    environment.ambient = glm::vec3(scene.ambient);
    environment.root = packed.nodes.empty() ? shared::kNone : 0;
    environment.planeCount = static_cast<uint32_t>(packed.planes.size());
    environment.lightCount = static_cast<uint32_t>(packed.lights.size());
    environment.maxDepth = static_cast<uint32_t>(scene.maxDepth);
}

}  // namespace

bool anyTransmits(const Scene& scene) {
    const auto transmits = [](const Material& m) { return m.transmission != Color(0); };
    return std::any_of(scene.materials.begin(), scene.materials.end(), transmits);
}

PackedScene packPlaced(const Scene& scene, const PrimitiveNumbers& numbers, Instances& instances,
                       const PackOptions& options, const Context& whole) {
    const Context context = whole.part(instances.any() ? Instances::kPrototypesPart : 0, 1);
    const auto corners = [&](uint32_t object) { return instances.corners(scene, object); };
    PackedScene packed;
    packed.geometry = geometryOf(scene, objectExtents(scene, numbers, corners, context));
    packed.origin = originOf(packed.geometry, scene.camera.eye);
    packed.eye = packCamera(scene.camera, 1, 1, packed.origin).eye;
    packPlanes(scene, numbers, packed);
    instances.place(scene, numbers, packed.origin, context);

    Materials materials(scene.materials.size());
    packGeometry(scene, numbers, {packed.origin, scene.camera.eye, &instances.placed()},
                 instances.depthOfTop(), options, context, packed, materials);
    packShading(scene, packed);
    instances.append(packed);
    for (const shared::Plane& plane : packed.planes) materials.use(plane.material);
    packTextures(scene, materials, packed, context);
    packed.features = featuresOf(packed, materials, context);
    if (packed.features.transmission) {
        setEye(packed, packed.eye, packed.environment);
        packed.features.coloredShadows =
            scene.transmissiveShadows == TransmissiveShadows::Colored && !packed.lights.empty();
    } else {
        for (shared::Material& material : packed.materials) material.medium = 0;
        packed.optics.clear();
    }
    if (packed.features.transmission) rankDielectrics(packed, packed.nodes);
    if (packed.features.transmission || packed.features.mirrors)
        packed.environment.radianceBound = radianceBound(packed, packed.environment, packed.lights);
    packed.features.parallelCamera = scene.camera.projection == Projection::Orthographic;
    packed.features.thinLens = scene.camera.lensRadius > 0;
    return packed;
}

PackedScene packScene(const Scene& given, const PackOptions& wanted, const Context& context) {
    PackOptions options = wanted;
    if (options.memory) options.memory->begin();
    options.split = options.split && !anyTransmits(given);  // coloured shadows and mediaAt count surfaces
    Scene copy;
    const Scene& scene = placedScene(given, copy);
    const PrimitiveNumbers numbers(scene);
    Instances instances(scene, numbers, options, context);
    return packPlaced(scene, numbers, instances, options, context);
}

namespace {

bool looksTheSame(const Object& object, const Frame& before, const Frame& after, const Extent& extentBefore,
                  const Extent& extentAfter) {
    if (const auto* plane = std::get_if<PlaneShape>(&object.shape)) {
        const auto normal = unitVector(plane->normal);
        return normal && planeAnchor(plane->point, *normal, extentBefore) ==
                             planeAnchor(plane->point, *normal, extentAfter);
    }
    return packerOf(kindOf(object)).isSameFrom(object, before, after);
}

}  // namespace

bool keepsArrays(const PackedScene& packed, const Scene& scene, const Camera& camera) {
    const Camera& old = scene.camera;
    if (camera.projection != old.projection || (camera.lensRadius > 0) != (old.lensRadius > 0)) return false;
    Extent before = packed.geometry.extent;
    if (before.empty()) return false;  // nothing but planes: packed in no time
    if (originOf(packed.geometry, camera.eye) != packed.origin) return false;
    Extent after = before;
    before.include(old.eye);
    after.include(camera.eye);
    const Frame frameBefore{packed.origin, old.eye, nullptr}, frameAfter{packed.origin, camera.eye, nullptr};
    return std::all_of(scene.objects.begin(), scene.objects.end(), [&](const Object& object) {
        return looksTheSame(object, frameBefore, frameAfter, before, after);
    });
}

}  // namespace glint
