#include "reference/primitives.h"

#include <algorithm>
#include <cmath>

#include "core/vectors.h"
#include "reference/error_box.h"
#include "reference/quadric.h"

namespace glint::reference {
namespace {

using glm::dvec3;

// A plane, or a part of one: `anchor` is a point of it.
template <class Flat>
void flatSurface(const Flat& flat, const dvec3& anchor, const Place& place, Surface& surface) {
    surface.geometricNormal = glm::normalize(dvec3(flat.normal));
    surface.shadingNormal = surface.geometricNormal;
    const double distance = glm::dot(surface.geometricNormal, place.point - dvec3(anchor));
    surface.position = place.point - distance * surface.geometricNormal;
    surface.error = errorBox(surface.position - anchor, anchor);
}

// Without what says whose it is.
template <class Kind>
Kind shapeOf(Kind primitive) {
    primitive.id = 0;
    if constexpr (requires { primitive.object; })
        primitive.object = primitive.primitive = primitive.material = 0;
    return primitive;
}

}  // namespace

bool isSameSurface(const Model& scene, const Hit& a, const Hit& b) {
    const uint32_t ofKindAndPart = ~shared::kLeafFirstMask;
    if (a.instance != b.instance || ((a.primitive ^ b.primitive) & ofKindAndPart) != 0) return false;
    return visitHit(scene, a.primitive, [&]<class Kind>(const Kind& one) {
        const Kind* first = &one - (a.primitive & shared::kLeafFirstMask);
        const Kind shape = shapeOf(one), other = shapeOf(first[b.primitive & shared::kLeafFirstMask]);
        return shape == other;
    });
}

// ---- Triangles

// Along (v1 - v0) x (v2 - v0). Where most of that cancels, from the corner across from the longest edge: a
// needle's width is the difference of two corners that lie together, and would be lost in those to a far one.
dvec3 areaOf(const dvec3& v0, const dvec3& v1, const dvec3& v2) {
    const dvec3 a = v1 - v0, b = v2 - v0, c = v2 - v1;
    const dvec3 area = glm::cross(a, b);
    const double lengthA = glm::length(a), lengthB = glm::length(b), lengthC = glm::length(c);
    if (glm::length(area) > 1e-6 * lengthA * lengthB) return area;
    if (lengthB >= lengthA && lengthB >= lengthC) return glm::cross(c, -a);
    return lengthA >= lengthC ? glm::cross(b, c) : area;
}

void surfaceOf(const rows::Triangle& triangle, const Place& place, Surface& surface) {
    const Hit& hit = place.hit;
    const rows::TriangleSurface& data = place.scene.triangleSurfaces[place.index()];
    const dvec3 v0(triangle.v0), v1(triangle.v1), v2(triangle.v2);
    const double w = 1 - hit.u - hit.v;
    surface.object = data.object;
    surface.primitive = data.primitive;
    surface.material = data.material;
    surface.position = w * v0 + hit.u * v1 + hit.v * v2;
    surface.error = gammaOf(7) * (std::abs(w) * glm::abs(v0) + std::abs(hit.u) * glm::abs(v1) +
                                  std::abs(hit.v) * glm::abs(v2));
    surface.geometricNormal = glm::normalize(areaOf(v0, v1, v2));
    surface.shadingNormal = surface.geometricNormal;
}

double reachOf(const Model&, const Methods&, const rows::Triangle& t) {
    return std::max({greatestMagnitude(t.v0), greatestMagnitude(t.v1), greatestMagnitude(t.v2)});
}

// ---- Spheres

bool meets(const rows::Sphere& sphere, const Meeting& m, Root& root, uint32_t&) {
    if (m.methods.spheres != SphereMethod::Robust)
        return textbookSphere(m.methods.spheres, sphere, m.ray, m.fromItself(), m.tMax, root);
    return intersectSphere(sphere, m.ray, m.fromItself(), m.tMax, root);
}

// The point is near the sphere: one step brings it onto the sphere, as far as double goes.
void surfaceOf(const rows::Sphere& sphere, const Place& place, Surface& surface) {
    const dvec3 anchor(sphere.point);
    const double radius = sphere.radius;
    if (isAnchored(sphere)) {
        // One Newton step along the gradient 2 (y + r n) of |y|^2 + 2 r n.y; the residue is that of o + t d
        // squared, over r.
        dvec3 y = place.point - anchor;
        const dvec3 n(sphere.anchorNormal);
        const dvec3 half = y + radius * n;
        y -= (glm::dot(y, y) + 2 * radius * glm::dot(n, y)) / (2 * glm::dot(half, half)) * half;
        surface.position = anchor + y;
        surface.geometricNormal = glm::normalize(y + radius * n);
    } else {
        surface.geometricNormal = glm::normalize(place.point - anchor);
        surface.position = anchor + radius * surface.geometricNormal;
    }
    surface.error = errorBox(surface.position - anchor, anchor);
    surface.shadingNormal = surface.geometricNormal;
}

double reachOf(const Model&, const Methods& methods, const rows::Sphere& s) {
    return greatestMagnitude(s.point) +
           (isAnchored(s) && methods.spheres == SphereMethod::Robust ? 0 : s.radius);
}

// ---- Planes

bool meets(const rows::Plane& plane, const Meeting& m, Root& root, uint32_t&) {
    return !m.fromItself() && intersectPlane(plane, m.ray, m.tMax, root);
}

void surfaceOf(const rows::Plane& plane, const Place& place, Surface& surface) {
    flatSurface(plane, plane.point, place, surface);
    surface.error = errorBox(surface.position, plane.point);  // it is never an offset
}

double reachOf(const Model&, const Methods&, const rows::Plane& plane) {
    return greatestMagnitude(plane.point);
}

// ---- Discs

bool meets(const rows::Disc& disc, const Meeting& m, Root& root, uint32_t&) {
    return !m.fromItself() && intersectDisc(disc, m.ray, m.tMax, root);
}

void surfaceOf(const rows::Disc& disc, const Place& place, Surface& surface) {
    flatSurface(disc, disc.center, place, surface);
}

double reachOf(const Model&, const Methods&, const rows::Disc& disc) {
    return greatestMagnitude(disc.center) + disc.radius;
}

// ---- Polygons

bool meets(const rows::Polygon& polygon, const Meeting& m, Root& root, uint32_t&) {
    return !m.fromItself() && intersectPolygon(polygon, outlineOf(m.scene, polygon), m.ray, m.tMax, root);
}

void surfaceOf(const rows::Polygon& polygon, const Place& place, Surface& surface) {
    flatSurface(polygon, polygon.point, place, surface);
}

double reachOf(const Model& scene, const Methods&, const rows::Polygon& polygon) {
    double most = 0;
    for (const rows::PolygonVertex& v : outlineOf(scene, polygon))
        most = std::max(most, greatestMagnitude(v.position));
    return most;
}

// ---- Quadrics

bool meets(const rows::Quadric& quadric, const Meeting& m, Root& root, uint32_t& part) {
    return intersectQuadric(quadric, m.ray, m.primitive, m.source, m.tMax, root, part);
}

void surfaceOf(const rows::Quadric& quadric, const Place& place, Surface& surface) {
    const QuadricPoint site = quadricPoint(quadric, place.part(), place.point, place.ray.direction);
    surface.position = site.position;
    surface.geometricNormal = surface.shadingNormal = site.normal;
    surface.bend = site.bend;
    surface.error =
        errorBox(site.position - quadric.point, quadric.point) + site.error * glm::abs(site.normal);
}

double reachOf(const Model&, const Methods&, const rows::Quadric& quadric) {
    return greatestMagnitude(quadric.point) + quadricReach(quadric);
}

}  // namespace glint::reference
