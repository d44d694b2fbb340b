// Rays: what they hit, and how much light passes.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "peer/geometry.h"

namespace glint::bench::peer {
namespace {

using glm::vec2;
using glm::vec3;

vec3 corner(const std::vector<glm::dvec3>& from, uint32_t i) {
    return vec3(from[i]);
}

template <class Value>
Value weigh(float u, float v, const Value& a, const Value& b, const Value& c) {
    return (1 - u - v) * a + u * b + v * c;
}

bool given(const std::vector<glm::uvec3>& corners, uint32_t triangle) {
    return !corners.empty() && corners[triangle].x != Mesh::kNoIndex;
}

RTCRay rayOf(const Ray& ray) {
    return {ray.origin.x,
            ray.origin.y,
            ray.origin.z,
            ray.tNear,
            ray.direction.x,
            ray.direction.y,
            ray.direction.z,
            0.0f,
            ray.tFar,
            ~0u,
            0,
            0};
}

}  // namespace

// What a shadow ray has come through so far. Embree names its surfaces in any order: a body's way adds up as
// the t of leaving less that of entering.
struct Geometry::Shadow {
    static constexpr int kMost = 8;

    RTCIntersectContext context;  // first: filters are given its address
    vec3 through{1};              // product of transmissions
    vec3 depth{0};                // sum of attenuation times t
    std::array<uint32_t, kMost> bodies{};
    std::array<int, kMost> inside{};
    int count = 0;

    explicit Shadow(const Media& media) {
        rtcInitIntersectContext(&context);
        for (int i = 0; i < media.count; ++i) step(media.list[i], 1);
    }
    void step(uint32_t material, int by) {
        int i = 0;
        while (i < count && bodies[i] != material) ++i;
        if (i == kMost) return;
        if (i == count) bodies[count++] = material;
        inside[i] += by;
    }
    void cross(const Material& m, uint32_t material, const vec3& transmission, bool entering, float t) {
        through *= transmission;
        if (!m.attenuates) return;
        depth += (entering ? -t : t) * m.attenuation;
        step(material, entering ? 1 : -1);
    }
};

void Geometry::placeTexture(const Item& item, Surface& s) const {
    const Material& m = materials_[s.material];
    if (!m.wantsUv && !m.wantsPlace) return;
    const shared::ObjectFrame& f = frames_[item.frame];
    const auto along = [&](const vec3& axis, float offset) { return glm::dot(axis, s.point) + offset; };
    if (m.wantsPlace)
        s.place = {along(f.toObjectX, f.offsetX), along(f.toObjectY, f.offsetY),
                   along(f.toObjectZ, f.offsetZ)};
    if (!m.wantsUv || item.byCorners) return;
    if (f.uvKind == shared::kUvFlat) {
        s.uv = {along(f.toU, f.offsetU), along(f.toV, f.offsetV)};
        return;
    }
    const bool round = f.uvKind == shared::kUvRound;
    const vec3 d = round ? vec3(along(f.toU, f.offsetU), along(f.toV, f.offsetV), along(f.toW, f.offsetW))
                         : vec3(glm::dot(f.toObjectX, s.outward), glm::dot(f.toObjectY, s.outward),
                                glm::dot(f.toObjectZ, s.outward));
    constexpr float kPi = 3.14159265f;
    s.uv = {0.5f + std::atan2(d.x, d.z) / (2 * kPi),
            0.5f + std::asin(glm::clamp(d.y / glm::length(d), -1.0f, 1.0f)) / kPi};
}

void Geometry::surfaceOfMesh(const Found& found, Surface& s) const {
    const Mesh& mesh = *found.part->mesh;
    const float u = found.u, v = found.v;
    const uint32_t i = found.primitive;
    if (given(mesh.normalCorners, i)) {
        const glm::uvec3 c = mesh.normalCorners[i];
        const std::vector<vec3>& n = found.part->normals;
        const auto inWorld = [&](const vec3& normal) {
            return found.instance ? glm::normalize(found.instance->normalMatrix * normal) : normal;
        };
        const vec3 sum = weigh(u, v, inWorld(n[c.x]), inWorld(n[c.y]), inWorld(n[c.z]));
        const float length = glm::length(sum);
        if (length > 0) s.normal = glm::dot(sum, s.outward) < 0 ? -sum / length : sum / length;
    }
    if (materials_[s.material].wantsUv) {
        s.uv = {u, v};
        if (given(mesh.uvCorners, i)) {
            const glm::uvec3 c = mesh.uvCorners[i];
            s.uv = weigh(u, v, vec2(mesh.uvs[c.x]), vec2(mesh.uvs[c.y]), vec2(mesh.uvs[c.z]));
        }
    }
    if (given(mesh.colorCorners, i)) {
        const glm::uvec3 c = mesh.colorCorners[i];
        s.color = weigh(u, v, corner(mesh.colors, c.x), corner(mesh.colors, c.y), corner(mesh.colors, c.z));
    }
}

uint32_t Geometry::materialOf(const Found& found) const {
    const Part& part = *found.part;
    if (part.mesh && !part.mesh->materials.empty()) return part.mesh->materials[found.primitive];
    if (found.instance != nullptr) return found.instance->material;
    return part.items[part.kind == Kind::Mesh ? 0 : found.primitive].material;
}

Surface Geometry::surfaceOf(const Found& found, float t) const {
    const Part& part = *found.part;
    Surface s;
    s.t = t;
    s.point = found.point;
    s.reach = t;
    s.material = materialOf(found);
    Item item = part.items[part.kind == Kind::Mesh ? 0 : found.primitive];
    if (found.instance != nullptr) {
        item.frame = found.instance->frame;
        s.outward = glm::normalize(found.instance->normalMatrix *
                                   (part.kind == Kind::Discs ? item.normal : found.normal));
    } else if (part.kind == Kind::Spheres) {
        // Put back onto the ball: Embree's t of a large one is good for little.
        const float radius = sphereRows_[found.primitive].w;
        s.outward = glm::normalize(s.point - item.center);
        s.point = item.center + radius * s.outward;
        s.reach = std::max(s.reach, radius);
    } else {
        s.outward = part.kind == Kind::Mesh ? glm::normalize(found.normal) : item.normal;
    }
    s.normal = s.outward;
    if (part.kind == Kind::Mesh) surfaceOfMesh(found, s);
    if (item.byCorners) s.uv = item.swapped ? vec2(found.v, found.u) : vec2(found.u, found.v);
    if (part.kind == Kind::Mesh) item.byCorners = true;
    placeTexture(item, s);
    return s;
}

bool Geometry::intersectPlane(const Item& plane, const Ray& ray, float tFar, Surface& s) const {
    const float slope = glm::dot(plane.normal, ray.direction);
    const float t = glm::dot(plane.normal, plane.center - ray.origin) / slope;
    if (!(slope != 0 && t > ray.tNear && t <= tFar)) return false;
    s = {};
    s.t = s.reach = t;
    s.point = ray.origin + t * ray.direction;
    s.outward = s.normal = plane.normal;
    s.material = plane.material;
    placeTexture(plane, s);
    return !materials_.hole(materials_[s.material], s);
}

bool Geometry::intersect(const Ray& ray, Surface& surface) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit q{};
    q.ray = rayOf(ray);
    q.hit.geomID = q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(embree_, &context, &q);
    bool hit = false;
    for (const Item& plane : planes_) {
        Surface s;
        if (!intersectPlane(plane, ray, hit ? surface.t : q.ray.tfar, s)) continue;
        surface = s;
        hit = true;
    }
    if (hit) return true;
    if (q.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    Found found;
    if (q.hit.instID[0] != RTC_INVALID_GEOMETRY_ID) {
        found.instance = &instances_[instanceOf_[q.hit.instID[0]]];
        found.part = found.instance->part;
    } else {
        found.part = partOf_[q.hit.geomID];
    }
    found.primitive = q.hit.primID;
    found.u = q.hit.u;
    found.v = q.hit.v;
    found.normal = {q.hit.Ng_x, q.hit.Ng_y, q.hit.Ng_z};
    found.point = ray.origin + q.ray.tfar * ray.direction;
    surface = surfaceOf(found, q.ray.tfar);
    return true;
}

vec3 Geometry::passes(const Ray& ray, const Media& media) const {
    Shadow shadow(media);
    RTCRay q = rayOf(ray);
    rtcOccluded1(embree_, &shadow.context, &q);
    if (q.tfar < 0) return vec3(0);
    for (const Item& plane : planes_) {
        Surface s;
        if (!intersectPlane(plane, ray, ray.tFar, s)) continue;
        const Material& m = materials_[s.material];
        if (!m.dielectric || !colored_) return vec3(0);
        shadow.cross(m, s.material, materials_.textured(m.transmission, m.transmissionTexture, s),
                     glm::dot(ray.direction, s.outward) <= 0, s.t);
    }
    if (shadow.count == 0) return shadow.through;
    // What it is inside of at its end; nothing reaches infinitely far.
    for (int i = 0; i < shadow.count; ++i)
        if (shadow.inside[i] > 0 && std::isfinite(ray.tFar))
            shadow.depth +=
                materials_[shadow.bodies[i]].attenuation * (ray.tFar * static_cast<float>(shadow.inside[i]));
    return shadow.through * glm::min(vec3(1), glm::exp(-shadow.depth * glm::length(ray.direction)));
}

Geometry::Found Geometry::foundBy(const RTCFilterFunctionNArguments& a, const Part& part, float t) const {
    Found found;
    found.part = &part;
    found.primitive = RTCHitN_primID(a.hit, 1, 0);
    found.u = RTCHitN_u(a.hit, 1, 0);
    found.v = RTCHitN_v(a.hit, 1, 0);
    found.normal = {RTCHitN_Ng_x(a.hit, 1, 0), RTCHitN_Ng_y(a.hit, 1, 0), RTCHitN_Ng_z(a.hit, 1, 0)};
    const vec3 origin(RTCRayN_org_x(a.ray, 1, 0), RTCRayN_org_y(a.ray, 1, 0), RTCRayN_org_z(a.ray, 1, 0));
    const vec3 direction(RTCRayN_dir_x(a.ray, 1, 0), RTCRayN_dir_y(a.ray, 1, 0), RTCRayN_dir_z(a.ray, 1, 0));
    found.point = origin + t * direction;
    const uint32_t number = RTCHitN_instID(a.hit, 1, 0, 0);
    if (number != RTC_INVALID_GEOMETRY_ID) {
        found.instance = &instances_[instanceOf_[number]];
        found.point = found.instance->linear * found.point + found.instance->offset;
    }
    return found;
}

void Geometry::filterHit(const RTCFilterFunctionNArguments* a) {
    if (a->valid[0] == 0) return;
    const Part& part = *static_cast<const Part*>(a->geometryUserPtr);
    const Geometry& self = *part.owner;
    const float t = RTCRayN_tfar(a->ray, 1, 0);
    const Found found = self.foundBy(*a, part, t);
    const Material& m = self.materials_[self.materialOf(found)];
    if (m.alphaCutoff > 0 && self.materials_.hole(m, self.surfaceOf(found, t))) a->valid[0] = 0;
}

void Geometry::filterShadow(const RTCFilterFunctionNArguments* a) {
    if (a->valid[0] == 0) return;
    const Part& part = *static_cast<const Part*>(a->geometryUserPtr);
    const Geometry& self = *part.owner;
    const float t = RTCRayN_tfar(a->ray, 1, 0);
    const Found found = self.foundBy(*a, part, t);
    const uint32_t material = self.materialOf(found);
    const Material& m = self.materials_[material];
    const bool through = m.dielectric && self.colored_;
    const bool textured = m.transmissionTexture != glint::Material::kNoTexture;
    Surface s;
    if (m.alphaCutoff > 0 || (through && textured)) s = self.surfaceOf(found, t);
    if (m.alphaCutoff > 0 && self.materials_.hole(m, s)) {
        a->valid[0] = 0;
    } else if (through) {
        const vec3 direction(RTCRayN_dir_x(a->ray, 1, 0), RTCRayN_dir_y(a->ray, 1, 0),
                             RTCRayN_dir_z(a->ray, 1, 0));
        reinterpret_cast<Shadow*>(a->context)
            ->cross(m, material, self.materials_.textured(m.transmission, m.transmissionTexture, s),
                    glm::dot(direction, found.normal) <= 0, t);
        a->valid[0] = 0;
    }
}

}  // namespace glint::bench::peer
