// Triangles, planes, discs and polygons.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/vectors.h"
#include "reference/intersect.h"
#include "reference/rounding.h"

namespace glint::reference {
namespace {

using glm::dvec3;

// Intersects the line with a plane of unit normal; false if they are parallel.
bool solvePlane(const PreparedRay& ray, const dvec3& normal, const dvec3& point, Extended& t) {
    const Vec<Extended> n = toVec<Extended>(normal);
    const Extended nd = dot(n, toVec<Extended>(ray.direction));
    if (nd == 0) return false;
    t = dot(n, toVec<Extended>(point) - toVec<Extended>(ray.origin)) / nd;
    return true;
}

// Stores t in the root; true if it counts.
bool accept(Extended t, const dvec3& normal, const dvec3& point, const RayTest& test, Root& root) {
    root.t = static_cast<double>(t);
    root.slip = slipOfFlat(test.ray, normal, point, root.t);
    return countsAt(test.ray, root.t, root.slip, test.tMax);
}

// A plane, or a part of one: `anchor` is a point of it.
template <class Flat>
void flatSurface(const Flat& flat, const dvec3& anchor, const Place& place, Surface& surface) {
    surface.geometricNormal = glm::normalize(flat.normal);
    const double distance = glm::dot(surface.geometricNormal, place.point - anchor);
    surface.position = place.point - distance * surface.geometricNormal;
    surface.error = errorBox(surface.position, anchor);  // it is never an offset
    surface.scale = greatestMagnitude(anchor);
}

// The sign of d.(b x c): on which side of the edge the line passes (Pluecker). b and c are rounded
// differences; their terms pass 8 roundings. Four times that, and smaller results count as zero.
template <class T>
int edgeSide(const Vec<T>& d, const Vec<T>& b, const Vec<T>& c) {
    return dot(sums(d), cross(sums(b), sums(c))).sign(32);
}

// The sign that double proves, else that of quadruple precision, where 0 counts as on the border.
template <class Sign>
int provenSign(const Sign& sign) {
    const int rough = sign.template operator()<double>();
    return rough != 0 ? rough : sign.template operator()<Quad>();
}

// ---- Triangles

// A triangle relative to a ray: its corners from the ray's origin, and the direction.
template <class T>
struct SeenTriangle {
    Vec<T> d, a, b, c;

    SeenTriangle(const rows::Triangle& triangle, const PreparedRay& ray) : d(toVec<T>(ray.direction)) {
        const Vec<T> o = toVec<T>(ray.origin);
        a = toVec<T>(triangle.v0) - o;
        b = toVec<T>(triangle.v1) - o;
        c = toVec<T>(triangle.v2) - o;
    }
    std::array<int, 3> sides() const { return {edgeSide(d, b, c), edgeSide(d, c, a), edgeSide(d, a, b)}; }
};

// False too for a line in the triangle's plane, where all three sides are zero.
bool lineHitsTriangle(const rows::Triangle& triangle, const PreparedRay& ray) {
    const auto [least, greatest] = std::ranges::minmax(SeenTriangle<Quad>(triangle, ray).sides());
    return (greatest > 0) != (least < 0);
}

// edgeSide, and of a line that passes the edge exactly the side of one whose origin is moved by (e, e^2, e^3)
// for a tiny e: d.((b - m) x (c - m)) = d.(b x c) - m.(d x (b - c)). Edelsbrunner, Muecke, "Simulation of
// Simplicity", ACM Transactions on Graphics 9(1), 1990.
int edgeSideMoved(const Vec<Quad>& d, const Vec<Quad>& b, const Vec<Quad>& c) {
    if (const int side = edgeSide(d, b, c); side != 0) return side;
    const Vec<Quad> change = cross(d, b - c);
    for (const Quad component : {change.x, change.y, change.z})
        if (component != 0) return component < 0 ? 1 : -1;
    return 0;
}

dvec3 unitOf(const Vec<Extended>& n) {
    return glm::normalize(
        dvec3(static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)));
}

}  // namespace

bool crossesTriangle(const rows::Triangle& triangle, const PreparedRay& ray) {
    // Double proves nearly all sides, in a sixteenth of the time; a proven side needs no movement.
    const auto [e0, e1, e2] = SeenTriangle<double>(triangle, ray).sides();
    if (e0 != 0 && e1 != 0 && e2 != 0) return e0 == e1 && e1 == e2;
    const auto [d, a, b, c] = SeenTriangle<Quad>(triangle, ray);
    const int side = edgeSideMoved(d, b, c);
    return side == edgeSideMoved(d, c, a) && side == edgeSideMoved(d, a, b);
}

bool solveTriangle(const rows::Triangle& triangle, const RayTest& test, bool lineHits, Root& root) {
    const PreparedRay& ray = test.ray;
    if (!lineHits && !lineHitsTriangle(triangle, ray)) return false;
    const Vec<Extended> v0 = toVec<Extended>(triangle.v0), d = toVec<Extended>(ray.direction);
    const Vec<Extended> e1 = toVec<Extended>(triangle.v1) - v0, e2 = toVec<Extended>(triangle.v2) - v0;
    const Vec<Extended> n = cross(e1, e2);
    // Also the end of triangles without area: their n vanishes.
    const Extended nd = dot(n, d);
    if (nd == 0) return false;
    // From the plane, not from the edge functions, whose relative error grows without bound as the triangle
    // thins.
    const Vec<Extended> s = v0 - toVec<Extended>(ray.origin);
    const Extended t = dot(n, s) / nd;
    if (!accept(t, unitOf(n), triangle.v0, test, root)) return false;
    // Moeller & Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997, eq. 6, written with n.d
    // for the determinant.
    const Vec<Extended> q = cross(d, s);
    const Extended u = std::clamp<Extended>(-dot(e2, q) / nd, 0, 1);
    const Extended v = std::clamp<Extended>(dot(e1, q) / nd, 0, 1);
    const Extended sum = std::max<Extended>(u + v, 1);
    root.u = static_cast<double>(u / sum);
    root.v = static_cast<double>(v / sum);
    return true;
}

namespace {

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

}  // namespace

void surfaceOf(const rows::Triangle& triangle, const Place& place, Surface& surface) {
    const Hit& hit = place.hit;
    const dvec3 v0(triangle.v0), v1(triangle.v1), v2(triangle.v2);
    const double w = 1 - hit.u - hit.v;
    const dvec3 terms =
        std::abs(w) * glm::abs(v0) + std::abs(hit.u) * glm::abs(v1) + std::abs(hit.v) * glm::abs(v2);
    surface.position = w * v0 + hit.u * v1 + hit.v * v2;
    surface.error = gammaOf(7) * terms;
    surface.scale = std::max({greatestMagnitude(v0), greatestMagnitude(v1), greatestMagnitude(v2)});
    const dvec3 area = areaOf(v0, v1, v2);
    surface.geometricNormal = glm::normalize(area);
    // fp32 takes the nearer of two ways to the point (docs/design/numerics.md).
    const dvec3 way = glm::abs(place.ray.origin) + glm::abs(hit.t * place.ray.direction);
    if (greatestMagnitude(terms) > 16 * greatestMagnitude(way))
        surface.error = errorBox(surface.position, v0);
    // An edge function is a sum of products of two corners as seen from the point, and a weight its share of
    // twice the area: on a needle these products exceed the area.
    const double a = glm::distance(v0, surface.position), b = glm::distance(v1, surface.position),
                 c = glm::distance(v2, surface.position);
    surface.uvScale = glm::dvec2(std::min(std::max({a * b, b * c, c * a}) / glm::length(area), 0x1p23));
}

// ---- Planes

bool intersect(const rows::Plane& plane, const RayTest& test, Root& root) {
    Extended t;
    return !test.fromItself() && solvePlane(test.ray, plane.normal, plane.point, t) &&
           accept(t, plane.normal, plane.point, test, root);
}

void surfaceOf(const rows::Plane& plane, const Place& place, Surface& surface) {
    flatSurface(plane, plane.point, place, surface);
}

// ---- Discs

namespace {

// With w = centre - o, the point of the line in the plane is (n.w / n.d) d - w away from the centre. Squared
// and multiplied by (n.d)^2: in the disc if |(n.w) d - (n.d) w|^2 <= r^2 (n.d)^2, decided without a division.
// Its terms pass 16 roundings.
template <class T>
int discSide(const rows::Disc& disc, const PreparedRay& ray) {
    const Vec<Sum<T>> n = toVec<Sum<T>>(disc.normal), d = toVec<Sum<T>>(ray.direction);
    const Vec<Sum<T>> w = sums(toVec<T>(disc.center) - toVec<T>(ray.origin));
    const Sum<T> nd = dot(n, d), reach = Sum<T>(disc.radius) * nd;
    const Vec<Sum<T>> q = dot(n, w) * d - nd * w;
    return (reach * reach - dot(q, q)).sign(32);
}

}  // namespace

bool intersect(const rows::Disc& disc, const RayTest& test, Root& root) {
    Extended t;
    if (test.fromItself() || !solvePlane(test.ray, disc.normal, disc.center, t)) return false;
    if (provenSign([&]<class T>() { return discSide<T>(disc, test.ray); }) < 0) return false;
    return accept(t, disc.normal, disc.center, test, root);
}

void surfaceOf(const rows::Disc& disc, const Place& place, Surface& surface) {
    flatSurface(disc, disc.center, place, surface);
    surface.scale += disc.radius;
}

// ---- Polygons

namespace {

// True if component ky of the vertex is positive, measured from the ray: moved along the ray to where
// component kz is 0, v_y - (d_y / d_z) v_z, here times d_z. Each of the two products passes 3 roundings.
bool isAbove(const dvec3& vertex, const PreparedRay& ray) {
    const double dy = ray.direction[ray.ky], dz = ray.direction[ray.kz];
    const int side = provenSign([&]<class T>() {
        const auto seen = [&](int axis) -> Sum<T> { return T(vertex[axis]) - T(ray.origin[axis]); };
        return (seen(ray.ky) * Sum<T>(dz) - seen(ray.kz) * Sum<T>(dy)).sign(4);
    });
    return (dz < 0 ? -side : side) > 0;
}

// The side of the line on which the edge from a to b passes, in projection along axis kz.
int sideOf(const dvec3& a, const dvec3& b, const PreparedRay& ray) {
    const int side = provenSign([&]<class T>() {
        const Vec<T> o = toVec<T>(ray.origin);
        return edgeSide(toVec<T>(ray.direction), toVec<T>(a) - o, toVec<T>(b) - o);
    });
    return ray.direction[ray.kz] < 0 ? -side : side;
}

}  // namespace

// Even-odd rule (docs/reference/shading.md): the edges that cross the half line which leaves the ray's line
// along axis kx. An edge goes over it from below to above with the line on its left, or down with the line on
// its right.
bool intersect(const rows::Polygon& polygon, const RayTest& test, Root& root) {
    const PreparedRay& ray = test.ray;
    const std::span<const rows::PolygonVertex> vertices = outlineOf(test.scene, polygon);
    Extended t;
    if (test.fromItself() || !solvePlane(ray, polygon.normal, polygon.point, t)) return false;
    bool odd = false, above = isAbove(vertices[0].position, ray);
    Extended least = std::numeric_limits<Extended>::infinity(), greatest = -least;
    for (size_t i = 1; i < vertices.size(); ++i) {
        const dvec3 &a = vertices[i - 1].position, &b = vertices[i].position;
        const bool wasAbove = std::exchange(above, isAbove(b, ray));
        const Extended corner =
            (static_cast<Extended>(b[ray.kz]) - ray.origin[ray.kz]) / ray.direction[ray.kz];
        least = std::min(least, corner);
        greatest = std::max(greatest, corner);
        if (above != wasAbove && sideOf(a, b, ray) == (above ? 1 : -1)) odd = !odd;
    }
    if (!odd) return false;
    return accept(std::clamp(t, least, greatest), polygon.normal, polygon.point, test, root);
}

void surfaceOf(const rows::Polygon& polygon, const Place& place, Surface& surface) {
    flatSurface(polygon, polygon.point, place, surface);
    surface.scale = 0;
    for (const rows::PolygonVertex& v : outlineOf(place.scene, polygon))
        surface.scale = std::max(surface.scale, greatestMagnitude(v.position));
}

}  // namespace glint::reference
