#include "pack/object_frame.h"

#include <cmath>
#include <limits>
#include <optional>

#include "core/vectors.h"
#include "scene/polygon_plane.h"

namespace glint {
namespace {

using glm::dvec3;

Affine inverse(const Affine& transform) {
    const glm::dmat3 linear = glm::inverse(transform.linear);
    return {linear, -(linear * transform.offset)};
}

dvec3 apply(const Affine& transform, const dvec3& point) {
    return transform.linear * point + transform.offset;
}

// An affine function on object space.
struct Coordinate {
    dvec3 direction{0};
    double offset = 0;
};
struct Coordinates {
    Coordinate u, v, w;
    uint32_t kind = shared::kUvFlat;
};

// (scaleU U.(p - anchor) + shiftU, ...)
Coordinate along(const dvec3& axis, const dvec3& anchor, double scale, double shift) {
    return {scale * axis, shift - scale * glm::dot(axis, anchor)};
}

struct FlatCoordinates {
    const Affine& toObject;  // from the shape's coordinates

    // Normals go by the inverse transpose.
    dvec3 normalOf(const dvec3& normal) const {
        return unitVector(glm::transpose(glm::inverse(toObject.linear)) * normal).value();
    }
    Coordinates operator()(const PlaneShape& plane) const {
        const SurfaceAxes axes = surfaceAxes(normalOf(unitVector(plane.normal).value()));
        const dvec3 anchor = apply(toObject, plane.point);
        return {along(axes.u, anchor, 1, 0), along(axes.v, anchor, 1, 0), {}};
    }
    Coordinates operator()(const DiscShape& disc) const {
        const dvec3 shapeNormal = unitVector(disc.normal).value();
        const SurfaceAxes axes = surfaceAxes(normalOf(shapeNormal));
        const dvec3 anchor = apply(toObject, disc.center);
        // Any radius will do: the disc is round in both coordinates.
        const double radius = glm::length(toObject.linear * (surfaceAxes(shapeNormal).u * disc.radius));
        return {along(axes.u, anchor, 0.5 / radius, 0.5), along(axes.v, anchor, 0.5 / radius, 0.5), {}};
    }
    Coordinates operator()(const PolygonShape& polygon) const {
        std::vector<dvec3> vertices = polygon.vertices;
        for (dvec3& vertex : vertices) vertex = apply(toObject, vertex);
        const auto plane = polygonPlane(polygon.vertices);
        if (!plane) return {};
        const SurfaceAxes axes = surfaceAxes(normalOf(plane->normal));
        return {across(axes.u, vertices), across(axes.v, vertices), {}};
    }
    Coordinates operator()(const SphereShape&) const { return {{}, {}, {}, shared::kUvNormal}; }
    // Quadrics keep their transform, so their shape's coordinates are the object's own.
    Coordinates operator()(const EllipsoidShape& e) const { return round(e.center, e.radii); }
    Coordinates operator()(const QuadricShape& q) const {
        return round(0.5 * (q.lo + q.hi), 0.5 * (q.hi - q.lo));
    }
    Coordinates operator()(const CylinderShape& c) const { return axial(c.base, c.top); }
    Coordinates operator()(const ConeShape& c) const { return axial(c.base, c.apex); }
    Coordinates operator()(const HyperboloidShape& h) const { return axial(h.base, h.top); }
    Coordinates operator()(const ParaboloidShape& p) const { return axial(p.vertex, p.top); }
    template <class Other>
    Coordinates operator()(const Other&) const {
        return {};
    }

    static Coordinates round(const dvec3& center, const dvec3& radii) {
        return {along({1, 0, 0}, center, 1 / radii.x, 0), along({0, 1, 0}, center, 1 / radii.y, 0),
                along({0, 0, 1}, center, 1 / radii.z, 0), shared::kUvRound};
    }
    // V from 0 to 1 along the axis. For one along y, U and W are x and z, as on a sphere.
    static Coordinates axial(const dvec3& base, const dvec3& top) {
        const dvec3 axis = top - base;
        const double length = glm::length(axis);
        const dvec3 y = axis / length;
        const dvec3 aside = std::abs(y.x) < 0.9 ? dvec3(1, 0, 0) : dvec3(0, 0, -1);
        const dvec3 x = glm::normalize(aside - glm::dot(aside, y) * y), z = glm::cross(x, y);
        return {along(x, base, 1, 0), along(y, base, 1 / length, 0), along(z, base, 1, 0), shared::kUvAxial};
    }

    // From 0 to 1 over the vertices' extent.
    static Coordinate across(const dvec3& axis, const std::vector<dvec3>& vertices) {
        double least = std::numeric_limits<double>::infinity(), greatest = -least;
        for (const dvec3& vertex : vertices) {
            least = std::min(least, glm::dot(axis, vertex));
            greatest = std::max(greatest, glm::dot(axis, vertex));
        }
        const double scale = 1 / (greatest - least);
        return {scale * axis, -scale * least};
    }
};

}  // namespace

SurfaceAxes surfaceAxes(const dvec3& normal) {
    const dvec3 horizontal = glm::cross(dvec3(0, 1, 0), normal);
    const double sine = glm::length(horizontal);
    const dvec3 u = sine > 1e-4 ? horizontal / sine : glm::normalize(dvec3(1, 0, 0) - normal.x * normal);
    return {u, glm::cross(normal, u)};
}

namespace {

// Takes the period of the scene's textures that are asked about: one of all, or 0.
class CommonPeriod {
  public:
    explicit CommonPeriod(const Scene& scene) : scene_(scene) {}

    void include(uint32_t texture) {
        if (texture == Material::kNoTexture) return;
        const auto* checker = std::get_if<CheckerTexture>(&scene_.textures[texture].source);
        if (checker == nullptr || !checker->solid) return;
        const double period = 2 / scene_.textures[texture].scale.x;
        period_ = !found_ || period == period_ ? period : 0;
        found_ = true;
    }
    double value() const { return period_; }

  private:
    const Scene& scene_;
    bool found_ = false;
    double period_ = 0;
};

double periodOf(const Scene& scene, const Object& object, const CubeOrigin& cubes) {
    const auto* mesh = std::get_if<MeshShape>(&object.shape);
    if (cubes.period > 0 || (mesh != nullptr && !mesh->mesh->materials.empty())) return cubes.period;
    const Material& material = scene.materials[object.material];
    CommonPeriod period(scene);
    for (const uint32_t texture : {material.ambientTexture, material.diffuseTexture, material.specularTexture,
                                   material.mirrorTexture, material.transmissionTexture})
        period.include(texture);
    return period.value();
}

}  // namespace

CubeOrigin cubeOrigin(const Scene& scene) {
    CommonPeriod period(scene);
    std::optional<dvec3> corner;
    for (uint32_t i = 0; i < scene.textures.size(); ++i) {
        period.include(i);
        const auto* checker = std::get_if<CheckerTexture>(&scene.textures[i].source);
        if (checker != nullptr && checker->solid && !corner) corner = checker->corner;
    }
    return {corner.value_or(dvec3(0)), period.value()};
}

double inCubes(double fromCorner, double period) {
    // Cubes of a thousand periods away are still told apart to 2^-13 of their size.
    constexpr double kManyPeriods = 1024;
    const bool far = period > 0 && std::abs(fromCorner) > kManyPeriods * period;
    return far ? std::remainder(fromCorner, period) : fromCorner;
}

shared::ObjectFrame objectFrame(const Scene& scene, const Object& object, const dvec3& origin,
                                const CubeOrigin& cubes) {
    const Affine fromWorld = object.transform ? inverse(*object.transform) : Affine{};
    const Affine toObject = inverse(object.applied);  // from the shape's coordinates
    const Affine all{toObject.linear * fromWorld.linear,
                     apply(toObject, apply(fromWorld, origin))};  // from local coordinates
    const Coordinates uv = std::visit(FlatCoordinates{toObject}, object.shape);
    const glm::dmat3 rows = glm::transpose(all.linear);
    const auto offsetOf = [&](const Coordinate& c) { return glm::dot(c.direction, all.offset) + c.offset; };
    shared::ObjectFrame frame;
    frame.toObjectX = glm::vec3(rows[0]);
    frame.toObjectY = glm::vec3(rows[1]);
    frame.toObjectZ = glm::vec3(rows[2]);
    const double period = periodOf(scene, object, cubes);
    const auto fromCubes = [&](double offset, double corner) {
        return static_cast<float>(inCubes(offset - corner, period));
    };
    frame.offsetX = fromCubes(all.offset.x, cubes.corner.x);
    frame.offsetY = fromCubes(all.offset.y, cubes.corner.y);
    frame.offsetZ = fromCubes(all.offset.z, cubes.corner.z);
    frame.toU = glm::vec3(rows * uv.u.direction);
    frame.toV = glm::vec3(rows * uv.v.direction);
    frame.offsetU = static_cast<float>(offsetOf(uv.u));
    frame.offsetV = static_cast<float>(offsetOf(uv.v));
    frame.toW = glm::vec3(rows * uv.w.direction);
    frame.offsetW = static_cast<float>(offsetOf(uv.w));
    frame.uvKind = uv.kind;
    return frame;
}

}  // namespace glint
