// T85: between convex mirrors every bounce multiplies the error of a ray by a factor that follows from their
// curvature.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>

#include "../render/support.h"
#include "reference/render.h"

namespace glint::stability::growth_test {
using glm::dvec2;
using glm::dvec3;
using namespace render::test;

constexpr double kUnit = 0x1p-24;
constexpr int kSide = 16;  // pixels

// Three mirrors of radius 1 with their centres `side` apart in the plane z = 0, and a ray from (side / 2,
// 0.2) at `angle`, which stays between them for more than `bounces` (tests/stability/cases.md T85). growth:
// what the catalogue measured for a bounce.
struct Trap {
    double side, angle;
    int bounces;
    double growth;
};

class GrowthTest : public RenderTest, public testing::WithParamInterface<Trap> {};

struct Step {
    double azimuth;  // of the normal
    double error;    // of it, for errors of one unit at every step so far
};

// Follows the ray, and what becomes of its errors: a unit of direction at the eye, a unit of each point,
// along the mirror, and of each reflected direction, all of one sign. A point that is off by x turns the
// normal by x, radius 1, and the reflected direction by 2 x; after the way t the next point is off by the sum
// across the ray over the cosine there (docs/design/numerics.md 4: 1 + 2 t / cos for each bounce).
std::vector<Step> walk(const Trap& trap) {
    const dvec2 centers[] = {{0, 0}, {trap.side, 0}, {trap.side / 2, trap.side * std::sqrt(3.0) / 2}};
    dvec2 o(trap.side / 2, 0.2), d(std::cos(trap.angle), std::sin(trap.angle));
    double across = 0, turn = 1;  // error of the position across the ray, of the direction
    std::vector<Step> steps;
    for (int k = 0; k <= trap.bounces; ++k) {
        double t = 1e9;
        dvec2 center(0);
        for (const dvec2& c : centers) {
            const double b = glm::dot(o - c, d), disc = b * b - glm::dot(o - c, o - c) + 1;
            const double near = disc < 0 ? -1 : -b - std::sqrt(disc);
            if (near > 1e-9 && near < t) {
                t = near;
                center = c;
            }
        }
        if (t == 1e9) break;
        o += t * d;
        const dvec2 n = o - center;
        const double cosine = -glm::dot(n, d);
        across += t * turn;
        const double moved = across / cosine + 1;
        steps.push_back({std::atan2(n.y, n.x), moved});
        turn += 2 * moved + 1;
        d += 2 * cosine * n;
        across = moved * cosine;
    }
    return steps;
}

// The greatest derivative of a lit point's brightness by the azimuth of its normal, among three lights, which
// stand at `turned`, a quarter and five eighths of a turn from there.
constexpr double kElevation = 50 * std::numbers::pi / 180;  // clear of the other mirrors: 1.5 sin 50 > 1
constexpr double kBetween[] = {0, std::numbers::pi / 2, 1.25 * std::numbers::pi};

double slopeOf(double azimuth, double light) {
    const double along = std::cos(kElevation) * std::cos(azimuth - light);
    return along < 0.05 ? 0 : std::abs(std::cos(kElevation) * std::sin(azimuth - light));
}

int bestLight(double azimuth, double turned) {
    int best = 0;
    for (int i = 1; i < 3; ++i)
        if (slopeOf(azimuth, turned + kBetween[i]) > slopeOf(azimuth, turned + kBetween[best])) best = i;
    return best;
}

// The turn of the lights that maximizes the least of these derivatives.
double bestTurn(const std::vector<Step>& steps) {
    double best = 0, most = -1;
    for (int i = 0; i < 360; ++i) {
        const double turned = i * std::numbers::pi / 180;
        double least = 1;
        for (const Step& s : steps)
            least = std::min(least, slopeOf(s.azimuth, turned + kBetween[bestLight(s.azimuth, turned)]));
        if (least > most) {
            most = least;
            best = turned;
        }
    }
    return best;
}

Scene sceneOf(const Trap& trap, double turned) {
    Scene scene = emptyScene();
    scene.maxDepth = trap.bounces;
    const uint32_t mirror = addMaterial(scene, Color(1), Color(1));
    addSphere(scene, {0, 0, 0}, 1, mirror);
    addSphere(scene, {trap.side, 0, 0}, 1, mirror);
    addSphere(scene, {trap.side / 2, trap.side * std::sqrt(3.0) / 2, 0}, 1, mirror);
    for (int i = 0; i < 3; ++i) {
        const double azimuth = turned + kBetween[i];
        const dvec3 to(std::cos(kElevation) * std::cos(azimuth), std::cos(kElevation) * std::sin(azimuth),
                       std::sin(kElevation));
        Color color(0);
        color[i] = 1;
        scene.lights.push_back(DirectionalLight{-to, color});
    }
    scene.camera.eye = {trap.side / 2, 0.2, 0};
    scene.camera.target = scene.camera.eye + dvec3(std::cos(trap.angle), std::sin(trap.angle), 0);
    scene.camera.up = {0, 0, 1};
    // 16 pixels, an ulp or two of the direction apart: each its own rounding, all the same way.
    scene.camera.fovY = 1e-4;
    return scene;
}

// The k-th reflection adds what the picture of depth k has more than that of depth k - 1.
TEST_P(GrowthTest, ErrorGrowsAsTheCurvatureSays) {
    const Trap& trap = GetParam();
    const std::vector<Step> steps = walk(trap);
    ASSERT_EQ(steps.size(), trap.bounces + 1u);
    const double turned = bestTurn(steps);
    const Case c = makeCase(sceneOf(trap, turned), kSide, kSide);
    render::Renderer renderer(device(), c.packed);
    std::vector<float> before(3 * kSide * kSide, 0);
    std::vector<dvec3> truthBefore(kSide * kSide, dvec3(0));
    std::vector<double> measured;
    for (int k = 0; k <= trap.bounces; ++k) {
        auto settings = sized<Request>(c);
        settings.limits.depth = k;
        const Picture picture = renderer.render(settings);
        settings.exact = true;
        const Picture truth = reference::render(c.packed, settings);
        const int light = bestLight(steps[k].azimuth, turned);
        const double slope = slopeOf(steps[k].azimuth, turned + kBetween[light]);
        ASSERT_GT(slope, 0.1) << "the lights tell nothing about bounce " << k;
        double squares = 0;
        for (int i = 0; i < kSide * kSide; ++i) {
            const float now = picture.color.at(i % kSide, i / kSide, light);
            const double added = now - before[3 * i + light];
            const dvec3 exact = dvec3(truth.exact[i]) - truthBefore[i];
            EXPECT_GT(exact[light], 0.01) << "lit, at bounce " << k;
            squares += std::pow((added - exact[light]) / slope, 2);
        }
        for (int i = 0; i < kSide * kSide; ++i) {
            for (int channel = 0; channel < 3; ++channel)
                before[3 * i + channel] = picture.color.at(i % kSide, i / kSide, channel);
            truthBefore[i] = dvec3(truth.exact[i]);
        }
        measured.push_back(std::sqrt(squares / (kSide * kSide)));
        std::cout << "[ measured ] side " << trap.side << ", bounce " << k << ": normal off by "
                  << measured.back() << ", errors of a unit make " << kUnit * steps[k].error << '\n';
        // A hit takes some ten roundings, which do not all add up; the difference of the pictures k + 2 of
        // sums up to k + 1, over the slope.
        const double sums = (k + 2) * (k + 1) * kUnit / slope;
        EXPECT_LE(measured[k], 8 * kUnit * steps[k].error + sums) << "bounce " << k;
    }
    // Where the error is ten units and more, fresh roundings hardly count, and each bounce multiplies it.
    int judged = 0, first = -1;
    for (int k = 1; k <= trap.bounces; ++k) {
        if (measured[k - 1] < 10 * kUnit) continue;
        if (first < 0) first = k - 1;
        const double grown = measured[k] / measured[k - 1], expected = steps[k].error / steps[k - 1].error;
        EXPECT_NEAR(grown / expected, 1, 0.3) << "bounce " << k;
        ++judged;
    }
    EXPECT_GE(judged, 3);
    std::cout << "[ measured ] side " << trap.side << ": x "
              << std::pow(measured.back() / measured[first], 1.0 / (trap.bounces - first))
              << " for each bounce, by curvature "
              << std::pow(steps.back().error / steps[first].error, 1.0 / (trap.bounces - first))
              << ", tests/stability/cases.md T85 " << trap.growth << '\n';
}

INSTANTIATE_TEST_SUITE_P(Traps, GrowthTest,
                         testing::Values(Trap{2.5, 1.46708, 8, 3.5}, Trap{3, 1.68261, 7, 4.6},
                                         Trap{6, 0.13348, 4, 12}),
                         [](const auto& p) { return "bounces" + std::to_string(p.param.bounces); });

}  // namespace glint::stability::growth_test
