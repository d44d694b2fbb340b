// Where hits of slivers come to lie, and points that are moved away from edges (shaders/primitives/
// triangle.glsl), in arithmetic that has as many digits as this takes.
#include <algorithm>
#include <cmath>

#include "checks.h"
#include "support/packed_scene_maker.h"

namespace glint::stability {

namespace {

using glint::test::Random;
using glm::dvec3;
using glm::vec3;
// Differences of floats are exact in it, and so are nearly all of their products.
using Vector = glm::vec<3, long double>;

shared::Triangle sliverOf(Random& random, double size, double width, double offset, size_t turn) {
    const dvec3 along = random.direction();
    const dvec3 across = glm::normalize(glm::cross(along, random.direction()));
    const dvec3 base = random.box(offset);
    const double third = random.uniform(0.1, 0.9);
    vec3 v[3] = {vec3(base), vec3(base + size * along), vec3(base + size * (third * along + width * across))};
    std::rotate(v, v + turn % 3, v + 3);
    return triangleOf(v[0], v[1], v[2]);
}

struct Planar {
    Vector a, e1, e2, normal;
    explicit Planar(const shared::Triangle& t)
        : a(t.v0), e1(Vector(t.v1) - a), e2(Vector(t.v2) - a), normal(glm::cross(e1, e2)) {}
    long double longest() const { return std::max({glm::length(e1), glm::length(e2), glm::length(e2 - e1)}); }
    Vector at(long double u, long double v) const { return a + u * e1 + v * e2; }
};

// The distance of the point with these weights from the ray's point in the plane, and the error of its t, in
// units of the rounding bound. The corners relative to the origin err by a unit of the way to them, `reach`,
// and the edge functions by one of reach^2, which over the sliver's longest side is a distance across it.
// Both grow with the ray's slant to the plane, and along the side with its slant to the side.
double offBy(const Planar& plane, const FloatRay& ray, const Answer& answer) {
    const Vector o(ray.origin), d(ray.direction);
    const long double speed = glm::dot(plane.normal, d), length = glm::length(d);
    const long double t = glm::dot(plane.normal, plane.a - o) / speed;
    const Vector met = o + t * d;
    const long double reach = std::max(
        {glm::length(plane.a - o), glm::length(plane.a + plane.e1 - o), glm::length(plane.a + plane.e2 - o)});
    const long double steep = std::abs(speed) / (glm::length(plane.normal) * length);
    const Vector edge = glm::length(plane.e1) == plane.longest()
                            ? plane.e1
                            : (glm::length(plane.e2) == plane.longest() ? plane.e2 : plane.e2 - plane.e1);
    const long double aslant = glm::length(glm::cross(edge, d)) / (plane.longest() * length);
    const long double unit = kUnit * reach * reach / (plane.longest() * steep * aslant);
    const long double point = glm::length(plane.at(answer.u, answer.v) - met);
    const long double time = std::abs(answer.t - t) * length;
    return static_cast<double>(std::max(point, time) / unit);
}

}  // namespace

SettledCount judgeSettled(const Subject& subject, const SliverFamily& family, bool exchanged, size_t count,
                          uint32_t seed) {
    Random random(seed);
    std::vector<shared::Triangle> triangles(count);
    std::vector<FloatRay> rays(count);
    for (size_t i = 0; i < count; ++i) {
        triangles[i] = sliverOf(random, family.size, family.width, family.offset, i);
        const Planar plane(triangles[i]);
        long double u = random.uniform(0.05, 0.9), v = random.uniform(0.05, 0.9);
        if (u + v > 0.95L) u *= 0.5L, v *= 0.5L;
        const dvec3 on(plane.at(u, v));
        rays[i].origin = vec3(on + random.uniform(0.2, 2) * family.size * random.direction());
        rays[i].direction = vec3(random.uniform(0.3, 3) * (on - dvec3(rays[i].origin)));
    }
    const std::vector<Answer> met = probe(subject, rays, triangles);
    const std::vector<Answer> settled = probeSettled(subject, rays, triangles, exchanged);
    SettledCount sum;
    for (size_t i = 0; i < count; ++i) {
        const Planar plane(triangles[i]);
        // A third narrower than those that are settled, for the rounding of either side.
        const bool narrow = plane.longest() * plane.longest() > 43 * glm::length(plane.normal);
        sum.lost += met[i].hit != settled[i].hit;
        if (!met[i].hit || !narrow) continue;
        ++sum.hits;
        const double before = offBy(plane, rays[i], met[i]), after = offBy(plane, rays[i], settled[i]);
        sum.slid += before > 8;
        sum.worst = std::max(sum.worst, after);
        sum.outside += settled[i].u < 0 || settled[i].v < 0 || settled[i].u + settled[i].v > 1 + 4 * kUnit;
    }
    return sum;
}

size_t countMetBeyondEnds(const Subject& subject, const SliverFamily& family, size_t count, uint32_t seed) {
    Random random(seed);
    std::vector<shared::Triangle> triangles(count);
    std::vector<FloatRay> rays(count);
    for (size_t i = 0; i < count; ++i) {
        shared::Triangle& triangle = triangles[i];
        triangle = sliverOf(random, family.size, family.width, family.offset, 0);
        // Along an axis, so that the corners stand around the ray along the others.
        if (i % 3 != 0) {
            const auto axis = static_cast<glm::length_t>(random.below(3));
            triangle.v2 = triangle.v1 = triangle.v0;
            triangle.v1[axis] += static_cast<float>(family.size);
            triangle.v2[axis] += static_cast<float>(random.uniform(0.1, 0.9) * family.size);
            triangle.v2[(axis + (i % 2 == 0 ? 1 : 2)) % 3] += static_cast<float>(family.width * family.size);
        }
        const dvec3 a(triangle.v0), along = dvec3(triangle.v1) - a;
        const double beyond = random.uniform(0.05, 2);
        const dvec3 on = a + (random.below(2) == 0 ? 1 + beyond : -beyond) * along;
        rays[i].origin = vec3(on + random.uniform(0.2, 2) * family.size * random.direction());
        rays[i].direction = vec3(on - dvec3(rays[i].origin));
    }
    size_t met = 0;
    for (const Answer& answer : probe(subject, rays, triangles)) met += answer.hit;
    return met;
}

}  // namespace glint::stability
