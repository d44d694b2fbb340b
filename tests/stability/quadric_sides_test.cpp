// Rays that start on a quadric's side, near it, or are tangent, where the exact values of the device's inputs
// decide.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>

#include "../render/support.h"
#include "checks.h"
#include "support/packed_scene_maker.h"

namespace glint::stability::quadric_sides_test {
using glint::test::Random;
using glm::dmat3;
using glm::dvec3;
using glm::vec3;
// Differences of floats are exact in it, and so are most of their products.
using Vector = glm::vec<3, long double>;

// Of a packed quadric, by its numbers.
struct Exact {
    explicit Exact(const shared::Quadric& q) : q_(q) {}
    Vector turned(const Vector& v) const {
        return {glm::dot(Vector(q_.toLocal0), v), glm::dot(Vector(q_.toLocal1), v),
                glm::dot(Vector(q_.toLocal2), v)};
    }
    Vector local(const Vector& x) const { return turned(x - Vector(q_.point)); }
    Vector image(const Vector& y) const {
        const Vector s(q_.squares), p(q_.products);
        return s * y + Vector(p.z * y.y + p.y * y.z, p.z * y.x + p.x * y.z, p.y * y.x + p.x * y.y);
    }
    long double at(const Vector& y) const {
        return glm::dot(y, image(y) + 2.0L * Vector(q_.linear)) + static_cast<long double>(q_.constant);
    }
    // Half the gradient, in local coordinates and in the world.
    Vector slope(const Vector& y) const { return image(y) + Vector(q_.linear); }
    dvec3 worldSlope(const dvec3& x) const {
        const dvec3 s(slope(local(Vector(x))));
        return s.x * dvec3(q_.toLocal0) + s.y * dvec3(q_.toLocal1) + s.z * dvec3(q_.toLocal2);
    }
    // Onto the side, along its gradient.
    dvec3 moved(dvec3 x) const {
        for (int step = 0; step < 20; ++step) {
            const dvec3 g = worldSlope(x);
            x -= static_cast<double>(at(local(Vector(x)))) / (2 * glm::dot(g, g)) * g;
        }
        return x;
    }

    shared::Quadric q_;
};

shared::Quadric quadricOf(const dmat3& toLocal) {
    const dmat3 rows = glm::transpose(toLocal);
    shared::Quadric q;
    q.toLocal0 = vec3(rows[0]);
    q.toLocal1 = vec3(rows[1]);
    q.toLocal2 = vec3(rows[2]);
    q.lo = vec3(-8);
    q.hi = vec3(8);
    return q;
}

dmat3 anyTurn(Random& random) {
    const dvec3 x = random.direction(), z = glm::normalize(glm::cross(x, random.direction()));
    return {x, glm::cross(z, x), z};
}

constexpr size_t kCount = 20000;

class QuadricSideTest : public render::test::RenderTest {
  protected:
    Subject subject() const { return {&device(), {}}; }
    // Counts the rays along each side that leave it exactly and hit it again, and those that go in by a
    // hundredth and do not hit it, or not 2 B / A away. make(quadric, i) completes a turned quadric and
    // returns a point of its side, measured from its own.
    void expectToLeave(const char* what, Random& random,
                       const std::function<dvec3(shared::Quadric&, size_t)>& make) const {
        std::vector<shared::Quadric> quadrics;
        std::vector<dvec3> points;
        for (size_t i = 0; i < kCount; ++i) {
            const dmat3 toLocal = anyTurn(random);
            shared::Quadric& q = quadrics.emplace_back(quadricOf(toLocal));
            const dvec3 local = make(q, i);
            points.push_back(dvec3(q.point) + glm::transpose(toLocal) * local);
        }
        std::vector<FloatRay> rays(kCount);
        for (size_t i = 0; i < kCount; ++i) {
            const Exact exact(quadrics[i]);
            const dvec3 on = exact.moved(points[i]), normal = glm::normalize(exact.worldSlope(on));
            // Convex there, and along the side.
            dvec3 along;
            do along = glm::normalize(glm::cross(normal, random.direction()));
            while (curvature(exact, along) < 0.05);
            const double out = i % 2 == 0 ? std::ldexp(random.uniform(0.5, 1), -int(20 + i / 2 % 10)) : -0.01;
            rays[i].origin = vec3(on);
            rays[i].direction = vec3(random.uniform(0.5, 2) * (along + out * normal));
            rays[i].source = shared::kKindQuadric << shared::kPrimitiveKindShift | static_cast<uint32_t>(i) |
                             (i % 2 == 0 ? 0 : shared::kStartsInwards);
        }
        const std::vector<Answer> answers = probe(subject(), rays, quadrics);
        size_t leave = 0, again = 0, goIn = 0, lost = 0;
        for (size_t i = 0; i < kCount; ++i) {
            const Exact exact(quadrics[i]);
            const Vector d = exact.turned(Vector(rays[i].direction));
            const long double b = glm::dot(exact.slope(exact.local(Vector(rays[i].origin))), d),
                              a = glm::dot(d, exact.image(d));
            if (b > 0) {
                ++leave;
                again += answers[i].hit;
            } else if (i % 2 == 1) {
                ++goIn;
                lost += !answers[i].hit || std::abs(answers[i].t * a / (-2 * b) - 1) > 1e-3L;
            }
        }
        std::cout << "[ measured ] " << what << ": of " << leave << " rays that leave " << again
                  << " meet it again; of " << goIn << " that go in " << lost << " are lost\n";
        EXPECT_GT(leave, kCount / 4);
        EXPECT_GT(goIn, kCount / 4);
        EXPECT_EQ(again, 0u) << what;
        EXPECT_EQ(lost, 0u) << what;
    }

  private:
    static double curvature(const Exact& exact, const dvec3& along) {
        const Vector d = exact.turned(Vector(along));
        return static_cast<double>(glm::dot(d, exact.image(d)));
    }
};

// Where a vertex lies at the origin of coordinates all that B errs by comes from the linear term.
TEST_F(QuadricSideTest, RaysLeaveAParaboloidNearItsVertex) {
    Random random(741);
    expectToLeave("paraboloid", random, [&](shared::Quadric& q, size_t i) {
        q.squares = {1, 1, 0};
        q.linear = {0, 0, i % 3 == 0 ? 0.5f : -0.5f};
        const double x = random.uniform(-0.1, 0.1), y = random.uniform(-0.1, 0.1);
        return dvec3(x, y, -(x * x + y * y) / (2 * q.linear.z));
    });
}

// x y = 1/2, or -1/2: nothing stands on the diagonal.
TEST_F(QuadricSideTest, RaysLeaveAHyperbolaBetweenTheAxes) {
    Random random(742);
    expectToLeave("hyperbola", random, [&](shared::Quadric& q, size_t i) {
        const float sign = i % 3 == 0 ? -1 : 1;
        q.products = {0, 0, -0.5f * sign};
        q.constant = 0.5f;
        if (i % 4 < 2) q.point = vec3(random.box(4));
        const double x = (random.below(2) == 0 ? 1 : -1) * random.uniform(0.3, 2);
        return dvec3(x, sign * 0.5 / x, random.uniform(-1, 1));
    });
}

// Near the side C is small, and if the numbers are so short that it is exact, t = C / q has all its digits:
// the middle between the roots, which the equation is set up at where a line nearly touches, would leave t
// with those of the way there. y, d and all coefficients are multiples of 2^-8 or coarser ones.
TEST_F(QuadricSideTest, NearHitsHaveAllTheirDigits) {
    Random random(743);
    const auto grid = [&](double half, double step) {
        return step * std::floor(random.uniform(-half, half) / step + 0.5);
    };
    const auto gridVector = [&](double half, double step) {
        return dvec3(grid(half, step), grid(half, step), grid(half, step));
    };
    std::vector<shared::Quadric> quadrics;
    std::vector<FloatRay> rays;
    std::vector<double> expected;
    while (rays.size() < kCount) {
        shared::Quadric q = quadricOf(dmat3(1));
        q.squares = vec3(gridVector(1, 0.25));
        q.products = rays.size() % 2 == 0 ? vec3(0) : vec3(gridVector(0.5, 0.25));
        q.linear = rays.size() % 4 < 2 ? vec3(0) : vec3(gridVector(1, 0.125));
        const dvec3 y = gridVector(1, 0x1p-6), d = gridVector(1, 0x1p-4);
        const double near = grid(0.01, 0x1p-14);
        q.constant = static_cast<float>(near - static_cast<double>(Exact(q).at(Vector(y))));
        const Exact exact(q);
        const auto a = static_cast<double>(glm::dot(Vector(d), exact.image(Vector(d))));
        const auto b = static_cast<double>(glm::dot(exact.slope(Vector(y)), Vector(d)));
        const double c = near, size = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
        // Ahead, and far from touching.
        if (size < 0.5 || b * c >= 0 || std::abs(b) < 0.1 || 4 * std::abs(a * c) > b * b) continue;
        const long double root = std::sqrt(static_cast<long double>(b) * b - static_cast<long double>(a) * c);
        quadrics.push_back(q);
        FloatRay& ray = rays.emplace_back();
        ray.origin = vec3(y);
        ray.direction = vec3(d);
        expected.push_back(static_cast<double>(c / -(b + (b < 0 ? -root : root))));
    }
    const std::vector<Answer> answers = probe(subject(), rays, quadrics);
    double worst = 0;
    size_t missed = 0;
    for (size_t i = 0; i < kCount; ++i) {
        missed += !answers[i].hit;
        worst = std::max(worst, std::abs(answers[i].t / expected[i] - 1) / kUnit);
    }
    std::cout << "[ measured ] near hits: " << missed << " missed, t within " << worst << " units\n";
    EXPECT_EQ(missed, 0u);
    // disc errs by three units, its root, q and the quotient by two and a half, Vulkan's quotient by five.
    EXPECT_LE(worst, 12);
}

// Ellipsoids, pipes and hyperboloids of one and of two sheets, clipped by boxes, half of them capped.
TEST_F(QuadricSideTest, IntervalsAreOpenBelowAndClosedAbove) {
    Random random(731);
    std::vector<FloatRay> rays(kCount);
    std::vector<shared::Quadric> quadrics;
    for (size_t i = 0; i < kCount; ++i) {
        const dvec3 origin = random.uniform(2, 5) * random.direction();
        rays[i].origin = vec3(origin);
        rays[i].direction = vec3(random.uniform(0.3, 3) * (random.box(0.4) - origin));
        shared::Quadric& q = quadrics.emplace_back(quadricOf(dmat3(1)));
        q.point = vec3(random.box(0.2));
        q.squares = {1, 1, random.uniform(-1, 1)};
        q.constant = static_cast<float>(random.uniform(-0.5, 0.1));
        q.lo = vec3(-1);
        q.hi = vec3(1);
        q.caps = i % 2 == 0 ? shared::kCapLower | shared::kCapUpper : 0;
    }
    const std::vector<Answer> hits = probe(subject(), rays, quadrics);
    EXPECT_GT(std::count_if(hits.begin(), hits.end(), [](const Answer& a) { return a.hit; }), kCount / 10.0);
    EXPECT_EQ(countWrongEnds(subject(), rays, hits, quadrics), 0u);
}

// From nearby, where the equation is measured from a point of the surface, in all octants: a ray from outside
// hits the outside, also where it is nearly tangent.
TEST_F(QuadricSideTest, WhoeverComesInSeesTheOutside) {
    for (uint32_t octant = 0; octant < 8; ++octant) {
        const dvec3 from = glm::normalize(dvec3((octant & 1) != 0 ? -1 : 1, (octant & 2) != 0 ? -0.8 : 0.8,
                                                (octant & 4) != 0 ? -0.6 : 0.6));
        const dvec3 across = glm::normalize(glm::cross(from, dvec3(0, 1, 0)));
        const std::pair<const char*, Shape> shapes[] = {
            {"ellipsoid", EllipsoidShape{dvec3(0), {1, 1, 1}}},
            {"cylinder", CylinderShape{{0.4, -2, 0.3}, {-0.4, 2, -0.3}, 1}},
            {"paraboloid", ParaboloidShape{-across, 3.0 * across, 1}},
        };
        for (const auto& [name, shape] : shapes) {
            const GrazingCount count = judgeGrazing(subject(), shape, from, kCount / 8, 744);
            std::cout << "[ measured ] " << name << ", octant " << octant << ": of " << count.hits
                      << " hits at limbs " << count.insides << " see the inside\n";
            EXPECT_GT(count.hits, kCount / 80);
            EXPECT_EQ(count.insides, 0u) << name << ", octant " << octant;
        }
    }
}

}  // namespace glint::stability::quadric_sides_test
