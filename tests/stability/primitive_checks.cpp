#include <algorithm>
#include <cmath>
#include <numbers>

#include "../oracle/dyadic.h"
#include "checks.h"
#include "support/packed_scene_maker.h"

namespace glint::stability {

namespace {

using glint::test::Random;
using glm::dvec3;
using glm::vec3;

// A ray in double, and rounded for the subject.
struct Pair {
    oracle::Ray exact;
    FloatRay rounded;
    oracle::Ray asRounded() const { return {rounded.origin, rounded.direction}; }
};

// From the rounded origin to the target, so that the aim is as good as the direction's rounding.
Pair aim(const dvec3& origin, const dvec3& target) {
    Pair pair;
    pair.exact = {origin, target - origin};
    pair.rounded.origin = vec3(origin);
    pair.rounded.direction = vec3(target - dvec3(pair.rounded.origin));
    return pair;
}

// The reference decides in quadruple precision (src/reference/intersect.h) and takes 32 x 2^-113 of the
// terms, here rounded up, for zero.
double bandOf(const Subject& subject, double deviceBand) {
    return subject.device ? deviceBand : 0x1p-104;
}

// How near to a rim or a tangent rays aim, relative to its size.
double nearnessOf(const Subject& subject, double onDevice) {
    return subject.device ? onDevice : 1e-7;
}

// The truths of one case. A decision within `band` of its opposite may go either way.
struct Truths {
    oracle::Truth rounded, exact;
    double band;
};

// Intersects ray i with primitive i by the subject and judges the answer by truthsOf(i).
template <class TruthsOf, class... Arrays>
Judged judge(const Subject& subject, const std::vector<Pair>& pairs, const TruthsOf& truthsOf,
             const Arrays&... arrays) {
    std::vector<FloatRay> rays;
    for (const Pair& pair : pairs) rays.push_back(pair.rounded);
    const std::vector<Answer> answers = probe(subject, rays, arrays...);
    Judged judged;
    if (subject.device) judged.wrongEnds = countWrongEnds(subject, rays, answers, arrays...);
    for (size_t i = 0; i < pairs.size(); ++i) {
        const auto& [hit, t, u, v] = answers[i];
        const Truths truths = truthsOf(i);
        judged.arithmetic.add(truths.rounded, truths.band, hit, t, u, v);
        judged.withInputs.add(truths.exact, truths.band, hit, t, u, v);
    }
    return judged;
}

}  // namespace

std::string Judged::text() const {
    return arithmetic.text() + "\n    with the rounding of the inputs: " + withInputs.text();
}

Judged judgeTriangles(const Subject& subject, const TriangleFamily& family, size_t count, uint32_t seed) {
    Random random(seed);
    struct Corners {
        dvec3 v[3];
    };
    std::vector<Corners> corners(count);
    std::vector<Pair> pairs(count);
    std::vector<shared::Triangle> triangles(count);
    for (size_t i = 0; i < count; ++i) {
        const dvec3 base(family.offset, -family.offset, family.offset);
        dvec3(&v)[3] = corners[i].v;
        for (dvec3& corner : v) corner = base + random.box(family.size);
        if (family.height < 1) {
            v[0] = base;
            v[1] = base + family.size * dvec3(1, 0, 0);
            v[2] = base + family.size * dvec3(0.5, family.height, 0);
        }
        triangles[i] = triangleOf(vec3(v[0]), vec3(v[1]), vec3(v[2]));
        double u = random.uniform(-.3, 1.1), w = random.uniform(-.3, 1.1);
        if (i % 4 == 1) w = 0;
        if (i % 4 == 2) w = 1 - u;
        if (i % 4 == 3) u = i % 8 == 3, w = 0;
        // Rays aim at the rounded corners.
        const dvec3 at =
            (1 - u - w) * dvec3(triangles[i].v0) + u * dvec3(triangles[i].v1) + w * dvec3(triangles[i].v2);
        pairs[i] = aim(at + 10 * family.size * random.direction(), at);
    }
    const auto truths = [&](size_t i) -> Truths {
        const shared::Triangle& t = triangles[i];
        const dvec3(&v)[3] = corners[i].v;
        return {oracle::triangle(t.v0, t.v1, t.v2, pairs[i].asRounded()),
                oracle::triangle(v[0], v[1], v[2], pairs[i].exact), bandOf(subject, 64 * kUnit)};
    };
    return judge(subject, pairs, truths, triangles);
}

namespace {

// The sign of t at the triangle's plane; 0 if the plane holds the origin or is parallel.
int sideAhead(const shared::Triangle& triangle, const FloatRay& ray) {
    using oracle::Dyadic;
    struct Exact {
        Dyadic x, y, z;
        explicit Exact(const vec3& v) : x(v.x), y(v.y), z(v.z) {}
        Exact(Dyadic a, Dyadic b, Dyadic c) : x(std::move(a)), y(std::move(b)), z(std::move(c)) {}
        Exact operator-(const Exact& o) const { return {x - o.x, y - o.y, z - o.z}; }
        Dyadic dot(const Exact& o) const { return x * o.x + y * o.y + z * o.z; }
        Exact cross(const Exact& o) const {
            return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x};
        }
    };
    const Exact corner(triangle.v0);
    const Exact normal = (Exact(triangle.v1) - corner).cross(Exact(triangle.v2) - corner);
    return normal.dot(corner - Exact(ray.origin)).sign() * normal.dot(Exact(ray.direction)).sign();
}

// The height of the ray's origin over the triangle's plane, in units of the bound within which the rule for
// rays that leave surfaces accepts it as a point of the triangle (docs/design/numerics.md).
double heightInBounds(const shared::Triangle& triangle, const FloatRay& ray) {
    const dvec3 a(triangle.v0), o(ray.origin), d(ray.direction);
    const dvec3 n = glm::normalize(glm::cross(dvec3(triangle.v1) - a, dvec3(triangle.v2) - a));
    const double height = glm::dot(n, a - o), t = height / glm::dot(n, d);
    const dvec3 terms = 2.0 * glm::abs(a) + 6.0 * (glm::abs(a - o) + glm::abs(t * d));
    return std::abs(height) / (static_cast<double>(kUnit) * glm::dot(glm::abs(n), terms));
}

}  // namespace

SliverCount judgeSlivers(const Subject& subject, const SliverFamily& family, size_t count, uint32_t seed) {
    Random random(seed);
    std::vector<shared::Triangle> triangles(count);
    std::vector<FloatRay> rays(count);
    for (size_t i = 0; i < count; ++i) {
        const dvec3 along = random.direction();
        const dvec3 across = glm::normalize(glm::cross(along, random.direction()));
        const dvec3 base = random.box(family.offset);
        const double from = random.uniform(-1, 1);
        vec3 v[3] = {vec3(base), vec3(base + family.size * along),
                     vec3(base + family.size * (from * along + family.width * across))};
        std::rotate(v, v + i % 3, v + 3);
        triangles[i] = triangleOf(v[0], v[1], v[2]);
        double a = random.uniform(0, 1), b = random.uniform(0, 1);
        if (a + b > 1) a = 1 - a, b = 1 - b;
        const dvec3 on = dvec3(v[0]) + a * dvec3(v[1] - v[0]) + b * dvec3(v[2] - v[0]);
        const dvec3 normal = glm::cross(along, across);
        const double reach = std::max(glm::length(on), family.size);
        const double lift = (i % 2 == 0 ? 1 : -1) * family.lift * kUnit * reach * random.uniform(0.5, 2);
        double turn = random.uniform(0, 2 * std::numbers::pi);
        double rise = random.uniform(0.5, 3) * std::numbers::pi / 180;
        if (family.lengthwise) {
            turn = random.uniform(-1e-4, 1e-4) + (i / 2 % 2 == 0 ? 0 : std::numbers::pi);
            rise = (i / 4 % 2 == 0 ? 1 : -1) * std::pow(10, random.uniform(-5, -3));
        }
        const dvec3 flat = std::cos(turn) * along + std::sin(turn) * across;
        const dvec3 direction = std::cos(rise) * flat + std::sin(rise) * normal;
        rays[i].origin = vec3(on + lift * normal);
        rays[i].direction = vec3(family.size * random.uniform(0.1, 2) * direction);
    }
    const std::vector<Answer> met = probe(subject, rays, triangles);
    const std::vector<Answer> ahead = probeAhead(subject, rays, triangles);
    SliverCount sum;
    for (size_t i = 0; i < count; ++i) {
        ++sum.rays;
        if (!met[i].hit) continue;
        const bool isAhead = sideAhead(triangles[i], rays[i]) > 0;
        const bool isBeyond = isAhead && heightInBounds(triangles[i], rays[i]) > 2;
        sum.ahead += isAhead;
        sum.metBehind += !isAhead;
        sum.left += !isAhead && ahead[i].hit;
        sum.beyond += isBeyond;
        sum.lost += isBeyond && !ahead[i].hit;
    }
    return sum;
}

Judged judgeSpheres(const Subject& subject, const SphereFamily& family, size_t count, uint32_t seed) {
    Random random(seed);
    const dvec3 center(family.offset);
    std::vector<Pair> pairs(count);
    std::vector<shared::Sphere> spheres(count);
    for (size_t i = 0; i < count; ++i) {
        const dvec3 away = family.distance * family.radius * random.direction();
        const dvec3 side = glm::normalize(glm::cross(away, random.direction()));
        const double rim = family.atLimb ? 1 + random.uniform(-1, 1) * nearnessOf(subject, 1e-3)
                                         : 1.2 * std::sqrt(random.uniform(0, 1));
        pairs[i] = aim(center + away, center + rim * family.radius * side);
        const dvec3 d = glm::normalize(pairs[i].exact.direction);
        pairs[i].exact.direction = d;
        pairs[i].rounded.direction = vec3(glm::normalize(dvec3(pairs[i].rounded.direction)));
        spheres[i] = {.point = vec3(center), .radius = static_cast<float>(family.radius)};
    }
    const double rounding = 16 * kUnit * family.distance;
    const double band =
        bandOf(subject, family.atLimb || family.distance > 8000 ? std::max(1e-3, rounding) : 1e-3);
    const auto truths = [&](size_t i) -> Truths {
        return {oracle::sphere(spheres[i].point, spheres[i].radius, pairs[i].asRounded()),
                oracle::sphere(center, family.radius, pairs[i].exact), band};
    };
    return judge(subject, pairs, truths, spheres);
}

Judged judgePlanet(const Subject& subject, double height, size_t count, uint32_t seed) {
    constexpr double kRadius = 1e6;
    Random random(seed);
    std::vector<Pair> pairs(count);
    std::vector<shared::Sphere> spheres(count);
    for (size_t i = 0; i < count; ++i) {
        const vec3 point(random.box(2)), up(random.direction());
        spheres[i] = {.point = point, .radius = float{kRadius}, .anchorNormal = up};
        const dvec3 normal(up), along = glm::normalize(glm::cross(normal, random.direction()));
        const double above = height * random.uniform(.5, 1.5);
        double sinking = random.uniform(0.05, 1);
        // The horizon dips by sqrt(2 h / r).
        if (!subject.device && i % 2 == 0)
            sinking = std::sqrt(2 * above / kRadius) * (1 + random.uniform(-1, 1) * 1e-6);
        pairs[i].exact = {dvec3(point) + above * normal, glm::normalize(along - sinking * normal)};
        pairs[i].rounded = {vec3(pairs[i].exact.origin), vec3(pairs[i].exact.direction)};
    }
    const auto truths = [&](size_t i) -> Truths {
        const dvec3 point(spheres[i].point), normal(spheres[i].anchorNormal);
        return {oracle::anchoredSphere(point, normal, kRadius, pairs[i].asRounded()),
                oracle::anchoredSphere(point, normal, kRadius, pairs[i].exact), bandOf(subject, 0)};
    };
    return judge(subject, pairs, truths, spheres);
}

namespace {

// A point with a normal, and an axis in the plane.
struct FlatCase {
    dvec3 point, normal, along;
};

// `ray` aims at the rim, a circle of the size, within `nearness` of it, or anywhere; every third one grazes.
FlatCase flatCase(const FlatFamily& family, double nearness, Random& random, size_t i, Pair& ray) {
    FlatCase c;
    c.point = dvec3(family.offset, -family.offset, family.offset) + random.box(family.size);
    c.normal = random.direction();
    c.along = glm::normalize(glm::cross(c.normal, random.direction()));
    const double rim = i % 2 ? 1 + random.uniform(-1, 1) * nearness : 1.4 * random.uniform(0, 1);
    const dvec3 at = c.point + rim * family.size * c.along;
    const dvec3 away =
        i % 3 ? random.direction() : glm::normalize(c.along + 100 * nearness * random.direction());
    ray = aim(at + 10 * family.size * away, at);
    if (i % 7 == 0) ray.rounded.direction = -ray.rounded.direction;
    if (i % 7 == 0) ray.exact.direction = -ray.exact.direction;
    return c;
}

}  // namespace

Judged judgePlanes(const Subject& subject, const FlatFamily& family, size_t count, uint32_t seed) {
    Random random(seed);
    std::vector<FlatCase> cases(count);
    std::vector<Pair> pairs(count);
    std::vector<shared::Plane> planes(count);
    for (size_t i = 0; i < count; ++i) {
        cases[i] = flatCase(family, nearnessOf(subject, 1e-5), random, i, pairs[i]);
        planes[i] = {.point = vec3(cases[i].point), .normal = vec3(cases[i].normal)};
    }
    const auto truths = [&](size_t i) -> Truths {
        return {oracle::plane(planes[i].point, planes[i].normal, pairs[i].asRounded()),
                oracle::plane(cases[i].point, cases[i].normal, pairs[i].exact), bandOf(subject, 64 * kUnit)};
    };
    return judge(subject, pairs, truths, planes);
}

// The point in the plane errs by 64 u of the way over the cosine, its squared radius by as large a part.
Judged judgeDiscs(const Subject& subject, const FlatFamily& family, size_t count, uint32_t seed) {
    Random random(seed);
    std::vector<FlatCase> cases(count);
    std::vector<Pair> pairs(count);
    std::vector<shared::Disc> discs(count);
    for (size_t i = 0; i < count; ++i) {
        cases[i] = flatCase(family, nearnessOf(subject, 1e-5), random, i, pairs[i]);
        discs[i] = {.center = vec3(cases[i].point),
                    .normal = vec3(cases[i].normal),
                    .radius = static_cast<float>(family.size)};
    }
    const auto truths = [&](size_t i) -> Truths {
        const dvec3 d = glm::normalize(pairs[i].exact.direction);
        const double cosine = std::abs(glm::dot(d, cases[i].normal));
        const double reach = glm::length(dvec3(pairs[i].rounded.origin) - dvec3(discs[i].center));
        const double band = bandOf(subject, 64 * kUnit * (1 + reach / (family.size * cosine)));
        return {oracle::disc(discs[i].center, discs[i].normal, discs[i].radius, pairs[i].asRounded()),
                oracle::disc(cases[i].point, cases[i].normal, family.size, pairs[i].exact), band};
    };
    return judge(subject, pairs, truths, discs);
}

// The sheared corners err by gamma_5 of the way (docs/design/numerics.md 2.3): 64 u of it over the size.
Judged judgePolygons(const Subject& subject, const FlatFamily& family, size_t count, uint32_t seed) {
    Random random(seed);
    std::vector<FlatCase> cases(count);
    std::vector<Pair> pairs(count);
    std::vector<std::vector<dvec3>> outlines(count);
    std::vector<shared::Polygon> polygons(count);
    std::vector<shared::PolygonVertex> vertices;
    for (size_t i = 0; i < count; ++i) {
        cases[i] = flatCase(family, 1e-5, random, i, pairs[i]);
        const dvec3 x = cases[i].along, y = glm::cross(cases[i].normal, x);
        const uint32_t corners = 3 + random.below(38);
        polygons[i].firstVertex = static_cast<uint32_t>(vertices.size());
        polygons[i].trips = (corners + shared::kPolygonEdgesPerTrip - 1) / shared::kPolygonEdgesPerTrip;
        for (uint32_t k = 0; k < corners; ++k) {
            const double angle = 2 * std::numbers::pi * k / corners,
                         r = family.size * random.uniform(.4, 1.6);
            outlines[i].push_back(cases[i].point + r * (std::cos(angle) * x + std::sin(angle) * y));
            vertices.emplace_back().position = vec3(outlines[i].back());
        }
        const dvec3 a(vertices[polygons[i].firstVertex].position),
            b(vertices[polygons[i].firstVertex + 1].position),
            c(vertices[polygons[i].firstVertex + 2].position);
        // The first corner closes the outline and fills the last trip up.
        vertices.resize(polygons[i].firstVertex + polygons[i].trips * shared::kPolygonEdgesPerTrip + 1,
                        {vec3(a)});
        polygons[i].point = vec3(a);
        if (i % 4 == 1) {
            const dvec3 at = glm::mix(a, b, random.uniform(0, 1));
            pairs[i] =
                aim(at + 4 * family.size * glm::normalize(cases[i].normal + .9 * random.direction()), at);
        }
        polygons[i].normal = vec3(glm::normalize(glm::cross(b - a, c - a)));
    }
    const auto truths = [&](size_t i) -> Truths {
        std::vector<dvec3> rounded;
        for (size_t k = 0; k < outlines[i].size(); ++k)
            rounded.emplace_back(vertices[polygons[i].firstVertex + k].position);
        const double cosine = std::abs(glm::dot(glm::normalize(pairs[i].exact.direction), cases[i].normal));
        // On the outline both answers are right. The oracle's distance to it is a double.
        const double band = std::max(bandOf(subject, 64 * kUnit * 12 / cosine), 1e-13);
        return {oracle::polygon(rounded, polygons[i].point, polygons[i].normal, pairs[i].asRounded()),
                oracle::polygon(outlines[i], cases[i].point, cases[i].normal, pairs[i].exact), band};
    };
    return judge(subject, pairs, truths, polygons, vertices);
}

BoxCount judgeBoxes(const Subject& subject, double thickness, double offset, bool widened, size_t count,
                    uint32_t seed) {
    constexpr size_t kChunk = 1u << 17;
    Random random(seed);
    BoxCount total;
    for (size_t done = 0; done < count; done += kChunk) {
        const size_t n = std::min(kChunk, count - done);
        std::vector<FloatRay> rays(n);
        std::vector<Box> boxes(n);
        for (size_t i = 0; i < n; ++i) {
            const dvec3 corner = dvec3(offset) + random.box(1);
            dvec3 size(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1));
            size[static_cast<int>(i % 3)] = thickness * random.uniform(0, 1);
            boxes[i] = {vec3(corner), vec3(corner + size)};
            // A point on a random one of the twelve edges of the rounded box.
            const dvec3 lo(boxes[i].lo), hi(boxes[i].hi);
            dvec3 w(random.below(2), random.below(2), random.below(2));
            w[static_cast<int>(random.below(3))] = random.uniform(0, 1);
            rays[i] = aim(dvec3(offset) + random.box(2), lo + w * (hi - lo)).rounded;
        }
        std::vector<Box> stored = boxes;
        for (Box& box : stored) {
            for (int axis = 0; axis < 3 && widened; ++axis) {
                box.lo[axis] = std::nextafter(box.lo[axis], -shared::kInfinity);
                box.hi[axis] = std::nextafter(box.hi[axis], shared::kInfinity);
            }
        }
        const std::vector<Answer> answers = probe(subject, rays, stored);
        for (size_t i = 0; i < n; ++i) {
            const bool sampled = i % 16 == 0;
            total.hits += answers[i].hit;
            if (answers[i].hit && !sampled) continue;
            const bool truth =
                oracle::box(boxes[i].lo, boxes[i].hi, {dvec3(rays[i].origin), dvec3(rays[i].direction)});
            total.falseMisses += truth && !answers[i].hit;
            total.judgedHits += sampled && answers[i].hit;
            total.falseHits += sampled && answers[i].hit && !truth;
        }
        total.rays += n;
    }
    return total;
}

}  // namespace glint::stability
