// What a ray has hit: the point, moved onto its surface, and the normals there.
#include <cmath>
#include <utility>

#include "reference/instance.h"
#include "reference/intersect.h"
#include "reference/material.h"
#include "reference/quadric.h"
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
dvec3 vertexNormal(const PackedScene& scene, const Hit& hit, const glm::vec3& normal) {
    if (hit.instance == shared::kNone) return dvec3(normal);
    return InstanceFrame(scene.instances[hit.instance]).normalInWorld(dvec3(normal));
}

void moveToWorld(const PackedScene& scene, const Hit& hit, Surface& surface) {
    const shared::Instance& instance = scene.instances[hit.instance];
    const InstanceFrame frame(instance);
    surface.position = frame.pointInWorld(surface.position);
    surface.geometricNormal = frame.normalInWorld(surface.geometricNormal);
    surface.shadingNormal = surface.geometricNormal;
    surface.object = instance.object;
    if (instance.material != shared::kNone) surface.material = instance.material;
}

// Vertex normals make the shading normal another one.
void smoothTriangle(const PackedScene& scene, const Hit& hit, Surface& surface) {
    if (kindOf(hit.primitive) != shared::kKindTriangle) return;
    const uint32_t index = scene.triangleSurfaces[indexOf(hit.primitive)].vertexNormals;
    if (index == shared::kNone) return;
    const shared::VertexNormals& normals = scene.vertexNormals[index];
    const dvec3 sum = (1 - hit.u - hit.v) * vertexNormal(scene, hit, normals.n0) +
                      hit.u * vertexNormal(scene, hit, normals.n1) +
                      hit.v * vertexNormal(scene, hit, normals.n2);
    const double length = glm::length(sum);
    if (length == 0) return;
    const double side = glm::dot(sum, surface.geometricNormal) < 0 ? -1 : 1;
    surface.shadingNormal = side / length * sum;
}

void fillTriangle(const PackedScene& scene, const Hit& hit, Surface& surface) {
    const uint32_t index = indexOf(hit.primitive);
    const shared::Triangle& triangle = scene.triangles[index];
    const shared::TriangleSurface& data = scene.triangleSurfaces[index];
    const dvec3 v0(triangle.v0), v1(triangle.v1), v2(triangle.v2);
    const double w = 1 - hit.u - hit.v;
    surface.object = data.object;
    surface.primitive = data.primitive;
    surface.material = data.material;
    surface.position = w * v0 + hit.u * v1 + hit.v * v2;
    surface.geometricNormal = glm::normalize(glm::cross(v1 - v0, v2 - v0));
    surface.shadingNormal = surface.geometricNormal;
}

// `point` is near the sphere: one step brings it onto the sphere, as far as double goes.
void fillSphere(const shared::Sphere& sphere, const dvec3& point, Surface& surface) {
    surface.object = sphere.object;
    surface.primitive = sphere.primitive;
    surface.material = sphere.material;
    const dvec3 anchor(sphere.point);
    const double radius = sphere.radius;
    if (isAnchored(sphere)) {
        // One Newton step along the gradient 2 (y + r n) of |y|^2 + 2 r n.y; the residue is that of o + t d
        // squared, over r.
        dvec3 y = point - anchor;
        const dvec3 n(sphere.anchorNormal);
        const dvec3 half = y + radius * n;
        y -= (glm::dot(y, y) + 2 * radius * glm::dot(n, y)) / (2 * glm::dot(half, half)) * half;
        surface.position = anchor + y;
        surface.geometricNormal = glm::normalize(y + radius * n);
    } else {
        surface.geometricNormal = glm::normalize(point - anchor);
        surface.position = anchor + radius * surface.geometricNormal;
    }
    surface.shadingNormal = surface.geometricNormal;
}

// A plane, or a part of one: `anchor` is a point of it.
template <class Flat>
void fillFlat(const Flat& flat, const glm::vec3& anchor, const dvec3& point, Surface& surface) {
    surface.object = flat.object;
    surface.primitive = flat.primitive;
    surface.material = flat.material;
    surface.geometricNormal = glm::normalize(dvec3(flat.normal));
    surface.shadingNormal = surface.geometricNormal;
    const double distance = glm::dot(surface.geometricNormal, point - dvec3(anchor));
    surface.position = point - distance * surface.geometricNormal;
}

void fillQuadric(const shared::Quadric& quadric, const Ray& ray, const Hit& hit, Surface& surface) {
    surface.object = quadric.object;
    surface.primitive = quadric.primitive;
    surface.material = quadric.material;
    const uint32_t part = hit.primitive >> shared::kQuadricPartShift & shared::kQuadricPartMask;
    const QuadricSite site = quadricSite(quadric, part, ray.origin + hit.t * ray.direction, ray.direction);
    surface.position = site.position;
    surface.geometricNormal = surface.shadingNormal = site.normal;
}

}  // namespace

Surface Tracer::surface(const Ray& worldRay, const Hit& worldHit) const {
    Surface surface;
    Hit hit = worldHit;
    if (kindOf(hit.primitive) == shared::kKindTriangle && isMirrored(scene_, hit.instance))
        std::swap(hit.u, hit.v);
    const bool inInstance = hit.instance != shared::kNone;
    const Ray ray = inInstance ? InstanceFrame(scene_.instances[hit.instance]).entered(worldRay) : worldRay;
    const dvec3 point = ray.origin + hit.t * ray.direction;
    switch (kindOf(hit.primitive)) {
        case shared::kKindTriangle:
            fillTriangle(scene_, hit, surface);
            break;
        case shared::kKindSphere:
            fillSphere(scene_.spheres[indexOf(hit.primitive)], point, surface);
            break;
        case shared::kKindDisc: {
            const shared::Disc& disc = scene_.discs[indexOf(hit.primitive)];
            fillFlat(disc, disc.center, point, surface);
            break;
        }
        case shared::kKindPolygon: {
            const shared::Polygon& polygon = scene_.polygons[indexOf(hit.primitive)];
            fillFlat(polygon, polygon.point, point, surface);
            break;
        }
        case shared::kKindQuadric:
            fillQuadric(scene_.quadrics[hit.primitive & shared::kLeafFirstMask], ray, hit, surface);
            break;
        default: {
            const shared::Plane& plane = scene_.planes[indexOf(hit.primitive)];
            fillFlat(plane, plane.point, point, surface);
        }
    }
    if (inInstance) moveToWorld(scene_, hit, surface);
    smoothTriangle(scene_, hit, surface);
    fillTexturing(scene_, hit, surface);
    return surface;
}

}  // namespace glint::reference
