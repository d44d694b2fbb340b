// Surface at a hit: the point, moved onto the surface, and its normals.
#include <algorithm>
#include <cmath>
#include <utility>

#include "reference/instance.h"
#include "reference/material.h"
#include "reference/primitives.h"
#include "reference/tracer.h"

namespace glint::reference {
namespace {

using glm::dvec3;

uint32_t kindOf(uint32_t primitive) {
    return primitive >> shared::kPrimitiveKindShift;
}
uint32_t indexOf(uint32_t primitive) {
    return primitive & shared::kPrimitiveIndexMask;
}

// The unit vertex normals are interpolated in the world.
dvec3 vertexNormal(const Model& scene, const Hit& hit, const dvec3& normal) {
    if (hit.instance == shared::kNone) return dvec3(normal);
    return InstanceFrame(scene.instances[hit.instance]).normalInWorld(dvec3(normal));
}

void surfaceInWorld(const Model& scene, const Hit& hit, Surface& surface) {
    const rows::Instance& instance = scene.instances[hit.instance];
    const InstanceFrame frame(instance);
    surface.error = frame.errorInWorld(surface.position, surface.error);
    surface.position = frame.pointInWorld(surface.position);
    surface.geometricNormal = frame.normalInWorld(surface.geometricNormal);
    surface.shadingNormal = surface.geometricNormal;
    surface.object = instance.object;
    surface.bend *= frame.stretch();
    if (instance.material != shared::kNone) surface.material = instance.material;
}

// Vertex normals make the shading normal another one.
void smoothTriangle(const Model& scene, const Hit& hit, Surface& surface) {
    if (kindOf(hit.primitive) != shared::kKindTriangle) return;
    const uint32_t index = scene.triangleSurfaces[indexOf(hit.primitive)].vertexNormals;
    if (index == shared::kNone) return;
    const rows::VertexNormals& normals = scene.vertexNormals[index];
    const dvec3 sum = (1 - hit.u - hit.v) * vertexNormal(scene, hit, normals.n0) +
                      hit.u * vertexNormal(scene, hit, normals.n1) +
                      hit.v * vertexNormal(scene, hit, normals.n2);
    const double length = glm::length(sum);
    if (length == 0) return;
    const double side = glm::dot(sum, surface.geometricNormal) < 0 ? -1 : 1;
    surface.shadingNormal = side / length * sum;
}

// The greatest magnitude among the coordinates that the hit point is computed from.
double geometryScale(const Model& scene, const Methods& methods, const Hit& hit) {
    const double own = visitHit(scene, hit.primitive,
                                [&](const auto& primitive) { return reachOf(scene, methods, primitive); });
    if (hit.instance == shared::kNone) return own;
    return InstanceFrame(scene.instances[hit.instance]).scaleInWorld(own);
}

}  // namespace

Surface Tracer::surfaceAt(const Ray& worldRay, const Hit& worldHit) const {
    Surface surface;
    Hit hit = worldHit;
    if (kindOf(hit.primitive) == shared::kKindTriangle && isMirrored(scene_, hit.instance))
        std::swap(hit.u, hit.v);
    const bool inInstance = hit.instance != shared::kNone;
    const Ray ray =
        inInstance ? InstanceFrame(scene_.instances[hit.instance]).enterInstance(worldRay) : worldRay;
    const dvec3 point = ray.origin + hit.t * ray.direction;
    visitHit(scene_, hit.primitive, [&](const auto& primitive) {
        if constexpr (requires { primitive.material; }) {
            surface.object = primitive.object;
            surface.primitive = primitive.primitive;
            surface.material = primitive.material;
        }
        surfaceOf(primitive, {scene_, ray, hit, point}, surface);
    });
    if (inInstance) surfaceInWorld(scene_, hit, surface);
    const dvec3 place = glm::abs(surface.position);
    surface.scale = std::max({place.x, place.y, place.z, geometryScale(scene_, methods(), hit)});
    smoothTriangle(scene_, hit, surface);
    if (kindOf(hit.primitive) == shared::kKindTriangle)
        triangleAttributes(scene_, hit, surface);
    else
        fillObjectUv(scene_, hit, surface);
    surface.uvScale = glm::max(surface.uvScale, glm::abs(surface.uv));
    return surface;
}

Surface Tracer::namesAt(const Hit& hit) const {
    Surface surface;
    const auto take = [&](const auto& named) {
        surface.object = named.object;
        surface.primitive = named.primitive;
        surface.material = named.material;
    };
    visitHit(scene_, hit.primitive, [&](const auto& primitive) {
        if constexpr (requires { primitive.material; })
            take(primitive);
        else
            take(scene_.triangleSurfaces[indexOf(hit.primitive)]);
    });
    if (hit.instance == shared::kNone) return surface;
    const rows::Instance& instance = scene_.instances[hit.instance];
    surface.object = instance.object;
    if (instance.material != shared::kNone) surface.material = instance.material;
    return surface;
}

}  // namespace glint::reference
