#include <algorithm>
#include <cmath>

#include "reference/intersect.h"
#include "reference/ray_mover.h"

namespace glint::reference {
namespace {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;

dvec3 vectorOf(const double (&v)[3]) {
    return {v[0], v[1], v[2]};
}

// The unknowns beta, gamma, t of v0 + beta (v1 - v0) + gamma (v2 - v0) = o + t d by Cramer's rule (P.
// Shirley, S. Marschner, Fundamentals of Computer Graphics, sec. 4.4.2), each a quotient of 3 x 3
// determinants.
bool triangleByCramer(const dvec3 (&v)[3], const PreparedRay& ray, Root& root) {
    const dvec3 e1 = v[1] - v[0], e2 = v[2] - v[0], d = vectorOf(ray.direction);
    const dvec3 right = vectorOf(ray.origin) - v[0];
    const double all = glm::determinant(dmat3(e1, e2, -d));
    if (all == 0) return false;
    root.u = glm::determinant(dmat3(right, e2, -d)) / all;
    root.v = glm::determinant(dmat3(e1, right, -d)) / all;
    root.t = glm::determinant(dmat3(e1, e2, right)) / all;
    return root.u >= 0 && root.v >= 0 && root.u + root.v <= 1;
}

bool planeHit(const dvec3 (&v)[3], const PreparedRay& ray, dvec3& normal, dvec3& point, double& t) {
    normal = glm::cross(v[1] - v[0], v[2] - v[0]);
    const dvec3 o = vectorOf(ray.origin), d = vectorOf(ray.direction);
    const double speed = glm::dot(normal, d);
    if (speed == 0) return false;
    t = glm::dot(normal, v[0] - o) / speed;
    point = o + t * d;
    return true;
}

// D. Badouel, "An Efficient Ray-Polygon Intersection", Graphics Gems, 1990: two coordinates, and areas in
// them.
bool triangleByProjection(const dvec3 (&v)[3], const PreparedRay& ray, Root& root) {
    dvec3 n, p;
    if (!planeHit(v, ray, n, p, root.t)) return false;
    const dvec3 size = glm::abs(n);
    const int drop = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int i = drop == 0 ? 1 : 0, j = drop == 2 ? 1 : 2;
    const auto flat = [&](const dvec3& x) { return dvec2(x[i], x[j]); };
    const auto area = [&](const dvec3& a, const dvec3& b, const dvec3& c) {
        const dvec2 ab = flat(b) - flat(a), ac = flat(c) - flat(a);
        return ab.x * ac.y - ab.y * ac.x;
    };
    const double whole = area(v[0], v[1], v[2]);
    root.u = area(v[0], p, v[2]) / whole;
    root.v = area(v[0], v[1], p) / whole;
    return root.u >= 0 && root.v >= 0 && area(p, v[1], v[2]) / whole >= 0;
}

// The point is inside if no edge's inward normal n x e points away from it.
bool triangleInSpace(const dvec3 (&v)[3], const PreparedRay& ray, Root& root) {
    dvec3 n, p;
    if (!planeHit(v, ray, n, p, root.t)) return false;
    double height[3];  // over the edge opposite to each vertex, times lengths that are the same for all
    for (int i = 0; i < 3; ++i) {
        const dvec3 &from = v[(i + 1) % 3], &to = v[(i + 2) % 3];
        height[i] = glm::dot(glm::cross(n, to - from), p - from);
        if (height[i] < 0) return false;
    }
    const double square = glm::dot(n, n);
    root.u = height[1] / square;
    root.v = height[2] / square;
    return true;
}

}  // namespace

bool textbookTriangle(const rows::Triangle& triangle, const RayTest& test, Root& root) {
    const PreparedRay& ray = test.ray;
    const TriangleMethod method = test.methods.triangles;
    const dvec3 v[3] = {dvec3(triangle.v0), dvec3(triangle.v1), dvec3(triangle.v2)};
    const bool inside = method == TriangleMethod::Barycentric  ? triangleByCramer(v, ray, root)
                        : method == TriangleMethod::Projection ? triangleByProjection(v, ray, root)
                                                               : triangleInSpace(v, ray, root);
    if (!inside) return false;
    const dvec3 normal = glm::normalize(glm::cross(v[1] - v[0], v[2] - v[0]));
    return accept(root.t, slipOfFlat(ray, normal, v[0], root.t), test, root);
}

namespace {

// Error of fp32 in either form, by the terms it sums, with u = 2^-24 and w from the ray's origin to the
// centre; a = d.d.
// - geometric, r^2 - (w.w - s^2 a) with s = w.d / a: w rounds once, w.w errs by gamma_5 |w|^2, s by gamma_8
// |w| / |d|, s^2 a by gamma_21 |w|^2, each difference by one more: 29 u |w|^2 + 2 u r^2;
constexpr double kSquareRoundings = 30, kMiddleRoundings = 8;

}  // namespace

bool textbookSphere(const rows::Sphere& sphere, const RayTest& test, Root& root) {
    const PreparedRay& ray = test.ray;
    root.u = root.v = 0;
    const dvec3 d = vectorOf(ray.direction), o = vectorOf(ray.origin);
    const double r = sphere.radius;
    const dvec3 center = dvec3(sphere.point) - r * dvec3(sphere.anchorNormal);
    const double a = glm::dot(d, d), reach = glm::dot(o - center, o - center);
    double middle = glm::dot(center - o, d) / a;
    double half;      // of the chord
    double lost = 0;  // of its square
    if (ray.noise.step != 0) {
        // Up to as many of so many roundings as the ray's noise has units, by the sphere.
        uint64_t state = ray.noise.seed ^ sphere.id;
        const auto upTo = [&](double roundings) {
            return std::min(ray.noise.step, roundings * 0x1p-24) * uniform(state);
        };
        lost = upTo(kSquareRoundings) * (reach + r * r);
        middle += upTo(kMiddleRoundings) * std::sqrt(reach / a);
    }
    if (test.fromItself()) {
        half = std::abs(middle);
    } else if (test.methods.spheres == SphereMethod::Geometric) {
        const dvec3 foot = o + middle * d;
        const double square = r * r - glm::dot(foot - center, foot - center) + lost;
        if (square < 0) return false;
        half = std::sqrt(square / a);
    } else {
        const double b = -2 * glm::dot(center - o, d), c = reach - r * r;
        const double disc = b * b - 4 * a * (c - lost);
        if (disc < 0) return false;
        half = std::sqrt(disc) / (2 * a);
    }
    return acceptSphere(middle - half, sphere, test, root) || acceptSphere(middle + half, sphere, test, root);
}

}  // namespace glint::reference
