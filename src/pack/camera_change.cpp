#include "pack/camera_change.h"

#include <algorithm>
#include <cstring>

#include "pack/kind_packer.h"
#include "pack/object_extents.h"
#include "pack/quadrics.h"
#include "pack/unit_vector.h"

namespace glint {

namespace {

template <typename Rounded>
bool sameBits(const Rounded& a, const Rounded& b) {
    return std::memcmp(&a, &b, sizeof(Rounded)) == 0;
}

bool looksTheSame(const Object& object, const Frame& before, const Frame& after, const Extent& extentBefore,
                  const Extent& extentAfter) {
    if (const auto* plane = std::get_if<PlaneShape>(&object.shape)) {
        const auto normal = unitVector(plane->normal);
        return normal && planeAnchor(plane->point, *normal, extentBefore) ==
                             planeAnchor(plane->point, *normal, extentAfter);
    }
    const shared::PrimitiveKind kind = kindOf(object);
    if (kind == shared::PrimitiveKind::Sphere) {
        const auto& sphere = std::get<SphereShape>(object.shape);
        return sameBits(roundSphere(sphere, before), roundSphere(sphere, after));
    }
    if (kind == shared::PrimitiveKind::Cuboid)
        return sameBits(roundCuboid(object, before), roundCuboid(object, after));
    if (kind == shared::PrimitiveKind::Quadric)
        return sameBits(roundQuadric(object, before), roundQuadric(object, after));
    return true;
}

}  // namespace

bool keepsArrays(const PackedScene& packed, const Scene& scene, const Camera& camera) {
    const Camera& old = scene.camera;
    if (camera.projection != old.projection || (camera.lensRadius > 0) != (old.lensRadius > 0)) return false;
    Extent before;
    before.lo = packed.geometryLo;
    before.hi = packed.geometryHi;
    if (before.empty()) return false;  // nothing but planes: packed in no time
    const Geometry geometry{before, packed.geometryMiddle, packed.geometryReach};
    if (originOf(geometry, camera.eye) != packed.origin) return false;
    Extent after = before;
    before.include(old.eye);
    after.include(camera.eye);
    const Frame frameBefore{packed.origin, old.eye, nullptr}, frameAfter{packed.origin, camera.eye, nullptr};
    return std::all_of(scene.objects.begin(), scene.objects.end(), [&](const Object& object) {
        return looksTheSame(object, frameBefore, frameAfter, before, after);
    });
}

void setEye(PackedScene& packed, const glm::dvec3& eye) {
    if (!packed.features.transmission) return;
    const glm::uvec4 media = mediaAt(packed, eye - packed.origin);
    shared::Environment& environment = packed.environment;
    environment.eyeMedium0 = media.x;
    environment.eyeMedium1 = media.y;
    environment.eyeMedium2 = media.z;
    environment.eyeMedium3 = media.w;
}

}  // namespace glint
