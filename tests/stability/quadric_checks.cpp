// Quadrics against the exact roots of the equation that their packed numbers stand for.
#include <algorithm>
#include <cmath>

#include "checks.h"
#include "pack/packed_scene.h"
#include "support/packed_scene_maker.h"

namespace glint::stability {

namespace {

using glint::test::Random;
using glm::dmat3;
using glm::dvec3;
using glm::vec3;

// y.Qy + 2 linear.y + constant in double: exact for what the tests hang on it, the bisection of silhouettes
// and the bounds; the truth itself is the oracle's.
struct Form {
    explicit Form(const shared::Quadric& q)
        : point(q.point),
          toLocal(glm::transpose(dmat3(dvec3(q.toLocal0), dvec3(q.toLocal1), dvec3(q.toLocal2)))),
          squares(q.squares),
          products(q.products),
          linear(q.linear),
          constant(q.constant) {}

    dvec3 image(const dvec3& y) const {
        return squares * y + dvec3(products.z * y.y + products.y * y.z, products.z * y.x + products.x * y.z,
                                   products.y * y.x + products.x * y.y);
    }
    double at(const dvec3& y) const { return glm::dot(y, image(y) + 2.0 * linear) + constant; }
    dvec3 gradient(const dvec3& y) const { return 2.0 * (image(y) + linear); }
    // Of the terms that `at` sums.
    double magnitude(const dvec3& y) const {
        return glm::dot(glm::abs(y), glm::abs(image(y))) + 2 * glm::dot(glm::abs(linear), glm::abs(y)) +
               std::abs(constant);
    }
    double norm() const {
        double sum = 0;
        for (int i = 0; i < 3; ++i) sum += std::abs(squares[i]) + 2 * std::abs(products[i]);
        return sum;
    }
    oracle::Ray local(const oracle::Ray& ray) const {
        return {toLocal * (ray.origin - point), toLocal * ray.direction};
    }
    // B^2 - A C of a local ray, and the t between its roots.
    double discriminant(const oracle::Ray& ray) const {
        const double a = glm::dot(ray.direction, image(ray.direction)),
                     b = glm::dot(ray.origin, image(ray.direction)) + glm::dot(linear, ray.direction);
        return a == 0 ? b * b : -a * at(ray.origin - b / a * ray.direction);
    }
    double middle(const oracle::Ray& ray) const {
        const double a = glm::dot(ray.direction, image(ray.direction)),
                     b = glm::dot(ray.origin, image(ray.direction)) + glm::dot(linear, ray.direction);
        return a == 0 ? 0 : -b / a;
    }

    dvec3 point;
    dmat3 toLocal;
    dvec3 squares, products, linear;
    double constant;
};

// What a subject may be off by. unit: of its numbers.
struct Rounding {
    double unit = kUnit;
    bool fromOrigin = false;  // the equation is set up at the ray's origin, however far away, in long double
};

// Local coordinates at t: gamma_5 of the magnitudes that make them (a difference, a product, two sums, t d).
double placeError(const Form& form, const oracle::Ray& world, double t, const Rounding& rounding) {
    const dvec3 from = glm::abs(world.origin - form.point) + std::abs(t) * glm::abs(world.direction);
    const dmat3 magnitudes(glm::abs(form.toLocal[0]), glm::abs(form.toLocal[1]), glm::abs(form.toLocal[2]));
    return 5 * rounding.unit * glm::length(magnitudes * from);
}

// The left side of the equation at a point that is off by `place`, and by the rounding of its terms; in the
// reference by 32 roundings of those at the origin as well (src/reference/primitives/quadric.cpp).
double formError(const Form& form, const oracle::Ray& local, double t, double place,
                 const Rounding& rounding) {
    const dvec3 y = local.origin + t * local.direction;
    double error = glm::length(form.gradient(y)) * place + form.norm() * place * place +
                   9 * rounding.unit * form.magnitude(y);
    if (rounding.fromOrigin)
        error +=
            32 * 0x1p-64 * form.magnitude(glm::abs(local.origin) + std::abs(t) * glm::abs(local.direction));
    return error;
}

struct Verdict {
    bool hit = false, inBand = false;
    double t = 0, bound = 0;
};

// The nearest crossing within the box; in the band where the discriminant, or the side of a face of the box
// on which a crossing lies, hangs on rounding.
Verdict judge(const Form& form, const shared::Quadric& q, const oracle::Ray& world,
              const Rounding& rounding) {
    const oracle::Ray ray = form.local(world);
    const double coefficients[10] = {
        form.squares.x,      form.squares.y,    form.squares.z,    2 * form.products.z, 2 * form.products.x,
        2 * form.products.y, 2 * form.linear.x, 2 * form.linear.y, 2 * form.linear.z,   form.constant};
    Verdict verdict;
    const double middle = form.middle(ray);
    const dvec3 between = ray.origin + middle * ray.direction;
    const double doubt = formError(form, ray, middle, placeError(form, world, middle, rounding), rounding);
    verdict.inBand = std::abs(form.at(between)) <= doubt;
    const oracle::Roots roots = oracle::quadric(coefficients, ray);
    for (int i = 0; i < roots.count && !verdict.hit; ++i) {
        const double t = roots.t[i];
        const dvec3 y = ray.origin + t * ray.direction, slope = form.gradient(y);
        const double place = placeError(form, world, t, rounding),
                     turning = std::abs(glm::dot(slope, ray.direction));
        // To first order, doubled: outside the band the second order is at most the first.
        const double bound = 2 * formError(form, ray, t, place, rounding) / turning;
        const double room = place + bound * glm::length(ray.direction);
        bool inside = true;
        for (int axis = 0; axis < 3; ++axis) {
            const double below = y[axis] - q.lo[axis], above = q.hi[axis] - y[axis];
            inside = inside && below >= 0 && above >= 0;
            if (std::min(std::abs(below), std::abs(above)) <= room) verdict.inBand = true;
        }
        if (t <= bound && t >= -bound) verdict.inBand = true;
        verdict.hit = inside && t > 0;
        verdict.t = t;
        verdict.bound = bound;
    }
    return verdict;
}

// The share of the way from `inner` to `outer`, at which rays from `origin` begin to miss.
double silhouette(const Form& form, const dvec3& origin, const dvec3& inner, const dvec3& outer) {
    double lo = 0, hi = 1;
    for (int i = 0; i < 60; ++i) {
        const double at = 0.5 * (lo + hi);
        const dvec3 target = glm::mix(inner, outer, at);
        (form.discriminant(form.local({origin, target - origin})) >= 0 ? lo : hi) = at;
    }
    return lo;
}

std::vector<FloatRay> raysAt(const QuadricFamily& family, const Form& form, const dvec3& packOrigin,
                             size_t count, Random& random) {
    std::vector<FloatRay> rays(count);
    for (size_t i = 0; i < count; ++i) {
        const dvec3 origin = family.distance * family.size * random.direction() - packOrigin;
        dvec3 target = family.target - packOrigin;
        const dvec3 around = target + random.box(family.size);
        const dvec3 outer = target + 4 * family.size * random.direction();
        if (i % 4 == 0) target += random.box(1e-3 * family.size);
        if (i % 4 == 1) target = around;
        if (i % 4 >= 2) {
            const double rim = silhouette(form, origin, around, outer);
            target = glm::mix(around, outer, rim * (1 + random.uniform(-1, 1) * 1e-3));
        }
        rays[i].origin = vec3(origin);
        rays[i].direction = vec3(target - dvec3(rays[i].origin));
    }
    return rays;
}

std::vector<Answer> answersOf(const Subject& subject, const PackedScene& packed,
                              const std::vector<FloatRay>& rays) {
    if (subject.device)
        return probe(subject, rays, std::vector<shared::Quadric>(rays.size(), packed.quadrics[0]));
    const reference::Tracer tracer(packed);
    std::vector<Answer> answers;
    for (const FloatRay& ray : rays) {
        const auto hit = tracer.closest({dvec3(ray.origin), dvec3(ray.direction)});
        answers.push_back(hit ? Answer{true, hit->t, 0, 0} : Answer{});
    }
    return answers;
}

}  // namespace

QuadricCount judgeQuadric(const Subject& subject, const QuadricFamily& family, size_t count, uint32_t seed) {
    Scene scene;
    scene.materials.emplace_back();
    scene.objects.push_back({"quadric", family.shape, 0});
    scene.camera.eye = dvec3(0, 0, family.distance * family.size);
    const PackedScene packed = packScene(scene);
    QuadricCount found;
    if (packed.quadrics.size() != 1) return found;
    const Form form(packed.quadrics[0]);
    Random random(seed);
    const std::vector<FloatRay> rays = raysAt(family, form, packed.origin, count, random);
    const std::vector<Answer> answers = answersOf(subject, packed, rays);
    if (subject.device)
        found.wrongEnds = countWrongEnds(subject, rays, answers,
                                         std::vector<shared::Quadric>(rays.size(), packed.quadrics[0]));
    // The local ray of this file is good to double; the reference may be no better.
    const Rounding rounding = subject.device ? Rounding{} : Rounding{0x1p-52, true};
    for (size_t i = 0; i < count; ++i) {
        const Verdict truth = judge(form, packed.quadrics[0], {rays[i].origin, rays[i].direction}, rounding);
        ++found.rays;
        found.hits += truth.hit;
        if (truth.inBand) {
            ++found.inBand;
        } else if (answers[i].hit != truth.hit) {
            ++found.wrong;
        } else if (truth.hit) {
            const double share = std::abs(answers[i].t - truth.t) / truth.bound;
            found.worst = std::max(found.worst, share);
            found.beyond += share > 1;
        }
    }
    return found;
}

GrazingCount judgeGrazing(const Subject& subject, const Shape& shape, const dvec3& from, size_t count,
                          uint32_t seed) {
    Scene scene;
    scene.materials.emplace_back();
    scene.objects.push_back({"quadric", shape, 0});
    const auto packedFrom = [&](const dvec3& eye) {
        scene.camera.eye = eye;
        return packScene(scene);
    };
    double share = 0;
    {
        const PackedScene far = packedFrom(100.0 * from);
        const Form form(far.quadrics.at(0));
        double lo = 0, hi = 10;
        for (int i = 0; i < 60; ++i) {
            share = 0.5 * (lo + hi);
            (form.at(form.toLocal * (share * from - far.origin - form.point)) < 0 ? lo : hi) = share;
        }
    }
    const dvec3 eye = 1.01 * share * from;
    const PackedScene packed = packedFrom(eye);
    const Form form(packed.quadrics.at(0));
    const vec3 origin(eye - packed.origin);
    Random random(seed);
    std::vector<FloatRay> rays(count);
    for (FloatRay& ray : rays) {
        const dvec3 inner = dvec3(origin) - 0.5 * share * from;
        const dvec3 outer = dvec3(origin) + glm::normalize(glm::cross(from, random.direction()));
        const double rim = silhouette(form, origin, inner, outer);
        ray.origin = origin;
        ray.direction = vec3(glm::mix(inner, outer, rim) - dvec3(origin));
    }
    const std::vector<Answer> normals =
        probeNormals(subject, rays, std::vector<shared::Quadric>(rays.size(), packed.quadrics[0]));
    GrazingCount found;
    for (size_t i = 0; i < count; ++i) {
        const dvec3 normal(normals[i].t, normals[i].u, normals[i].v);
        found.hits += normals[i].hit;
        found.insides += normals[i].hit && glm::dot(normal, dvec3(rays[i].direction)) >= 0;
    }
    return found;
}

}  // namespace glint::stability
