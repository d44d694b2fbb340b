// Dielectrics of the reference against closed forms: Snell, Fresnel, total reflection, slabs, lists of media.
#include "reference/scatter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "reference/tracer.h"
#include "support/packed_scene_maker.h"

namespace glint::reference::test::optics_test {
using namespace glint::test;

using glm::dvec3;

// Meets the plane z = 0 from above at the angle of this cosine.
Split meet(double cosine, double ratio) {
    const dvec3 up(0, 0, 1);
    return splitAt({std::sqrt((1 - cosine) * (1 + cosine)), 0, -cosine}, up, up, ratio);
}

TEST(OpticsTest, ReflectanceIsTheSameBothWays) {
    for (double cosine = 0.02; cosine < 1; cosine += 0.07) {
        const Split in = meet(cosine, 1 / 1.5);
        const double behind = -in.refracted.z;
        EXPECT_NEAR(meet(behind, 1.5).reflectance, in.reflectance, 1e-12) << cosine;
        // Snell: n sin.
        EXPECT_NEAR(1.5 * in.refracted.x, std::sqrt(1 - cosine * cosine), 8e-15) << cosine;
    }
}

// tests/stability/cases.md T86: the two floats on either side of the critical cosine sqrt(1 - 1/1.5^2).
TEST(OpticsTest, TotalReflectionBeginsAtTheCriticalAngle) {
    EXPECT_TRUE(meet(double(0.74535596f), 1.5).total);
    EXPECT_FALSE(meet(double(std::nextafter(0.74535596f, 1.0f)), 1.5).total);
    EXPECT_EQ(meet(0.7, 1.5).reflectance, 1);
    const double degree = std::numbers::pi / 180;
    struct Critical {
        double ior, angle;
    };
    for (const Critical& c :
         {Critical{1.5, 41.8103148957786}, Critical{1.33, 48.7534666313}, Critical{2.417, 24.4397438659}}) {
        EXPECT_FALSE(meet(std::cos((c.angle - 1e-8) * degree), c.ior).total);
        EXPECT_TRUE(meet(std::cos((c.angle + 1e-8) * degree), c.ior).total);
    }
}

// The shading normal leans so far that the refracted ray would come out in front.
TEST(OpticsTest, GeometricNormalWhereTheShadingNormalFails) {
    const dvec3 n(0, 0, 1), d = glm::normalize(dvec3(1, 0, -0.05)), s = glm::normalize(dvec3(1, 0, 0.04));
    const Split leaning = splitAt(d, n, s, 1 / 1.5), flat = splitAt(d, n, n, 1 / 1.5);
    EXPECT_EQ(leaning.refracted, flat.refracted);
    EXPECT_EQ(leaning.reflectance, flat.reflectance);
}

uint32_t addGlass(PackedScene& scene, uint32_t material, float ior, int priority, const glm::vec3& sigma) {
    shared::Optics optics;
    optics.transmission = glm::vec3(1);
    optics.ior = ior;
    optics.attenuation = sigma;
    optics.rank = shared::kRankOfZero + static_cast<uint32_t>(priority);
    scene.optics.push_back(optics);
    const auto medium = static_cast<uint32_t>(scene.optics.size());
    if (material < scene.materials.size()) scene.materials[material].medium = medium;
    scene.features.transmission = true;
    return medium;
}

// At the critical angle of so weak a glass a unit in the ray's direction is a 70th of a unit in the sine. The
// formula's own rounding, 7 units of the sine's square, decides.
TEST(OpticsTest, RoundingDecidesWhereTotalReflectionBegins) {
    SceneMaker maker;
    maker.plane({0, 0, 0}, {0, 0, 1});
    PackedScene scene = maker.finish();
    addGlass(scene, 0, 1.0001f, 0, glm::vec3(0));
    const Tracer tracer(std::make_shared<const Model>(widened(scene)), {.limits = {.depth = 1}}, 1);
    // units: by which the square of the refracted angle's sine exceeds 1
    const auto totalOf100 = [&](double units) {
        const double sine = std::sqrt(1 + units * 0x1p-24) / double{1.0001f};
        const Ray ray = makeRay({0, 0, -1}, {sine, 0, std::sqrt(1 - sine * sine)});
        int total = 0;
        for (uint64_t seed = 1; seed <= 100; ++seed)
            total += tracer.trace(ray, {.seed = seed, .ulps = 1}).bounces == 1;
        return total;
    };
    EXPECT_EQ(totalOf100(-8), 0);
    EXPECT_NEAR(totalOf100(0), 50, 30);
    EXPECT_GT(totalOf100(-4), 0);
    EXPECT_LT(totalOf100(4), 100);
    EXPECT_EQ(totalOf100(8), 100);
}

// One ray follows either way, and misses: of a split the weak reflection is cut.
TEST(OpticsTest, KindsOfRaysAreDecisions) {
    SceneMaker maker;
    maker.plane({0, 0, 0}, {0, 0, 1});
    PackedScene scene = maker.finish();
    addGlass(scene, 0, 1.5f, 0, glm::vec3(0));
    const Tracer tracer(std::make_shared<const Model>(widened(scene)),
                        {.limits = {.depth = 1, .minContribution = 0.2}}, 1);
    const auto fromBelow = [&](double cosine) {
        return tracer.trace(makeRay({0, 0, -1}, {std::sqrt(1 - cosine * cosine), 0, cosine}));
    };
    const PixelRecord total = fromBelow(0.7), split = fromBelow(0.8);
    EXPECT_EQ(total.bounces, 1u);
    EXPECT_EQ(split.bounces, 1u);
    EXPECT_EQ(total.pathHash, split.pathHash);
    EXPECT_EQ(total.decisions, fromBelow(0.71).decisions);
    EXPECT_NE(total.decisions, split.decisions);
}

// A certificate must not mix the near side of a glass ball with its far side, where other rays follow.
TEST(OpticsTest, SidesOfSurfacesAreDecisions) {
    SceneMaker maker;
    maker.sphere({0, 0, 0}, 1);
    const PackedScene scene = maker.finish();
    const Tracer tracer(scene);
    const PixelRecord near = tracer.trace(makeRay({0.1, 0.2, 3}, {0, 0, -1}));
    const PixelRecord far = tracer.trace(makeRay({0.1, 0.2, 0}, {0, 0, -1}));
    EXPECT_EQ(near.pathHash, far.pathHash);
    EXPECT_NE(near.decisions, far.decisions);
}

TEST(OpticsTest, GreatestPriorityRules) {
    PackedScene packed;
    const uint32_t water = addGlass(packed, 9, 1.33f, 0, glm::vec3(0));
    const uint32_t glass = addGlass(packed, 9, 1.5f, 1, glm::vec3(0));
    const uint32_t oil = addGlass(packed, 9, 1.4f, 0, glm::vec3(0));
    const Model scene = widened(packed);
    EXPECT_EQ(rulingMedium(scene, {}), 0u);
    EXPECT_EQ(rulingMedium(scene, {glass, water}), glass);
    EXPECT_EQ(rulingMedium(scene, {water, oil}), oil);
    EXPECT_EQ(rulingMedium(scene, {oil, water}), water);
    // Water inside of glass is not noticed until the glass is left.
    EXPECT_FALSE(crossingAt(scene, {glass}, water, true).counts);
    const Crossing out = crossingAt(scene, {glass, water}, glass, false);
    EXPECT_TRUE(out.counts);
    EXPECT_EQ(out.mediumBefore, glass);
    EXPECT_EQ(out.mediumAfter, water);
    // What is left without having been entered was there from the start.
    const Crossing unknown = crossingAt(scene, {}, glass, false);
    EXPECT_EQ(unknown.mediumBefore, glass);
    EXPECT_EQ(unknown.mediumAfter, 0u);
    // Two of a kind are one.
    EXPECT_FALSE(crossingAt(scene, {glass}, glass, true).counts);
    EXPECT_FALSE(crossingAt(scene, {glass, glass}, glass, false).counts);
    EXPECT_EQ(crossingAt(scene, {glass, water, oil, glass}, glass, false).after, (Media{glass, water, oil}));
    const Crossing crowded = crossingAt(scene, {water, water, oil, oil}, glass, true);
    EXPECT_TRUE(crowded.crowded);
    EXPECT_FALSE(crowded.counts);
}

// A ball of radius 1 in front of a white background, looked at through its middle: each way through it is 2
// long and R = 0.04. The series of ever more inner reflections in closed form, up to the depth.
TEST(OpticsTest, FadingThroughABall) {
    SceneMaker maker;
    maker.sphere({0, 0, 0}, 1);
    maker.environment.maxDepth = 30;
    maker.environment.background = glm::vec3(1);
    PackedScene scene = maker.finish();
    addGlass(scene, 0, 1.5f, 0, {0.1f, 1, 0});
    const PixelRecord record = Tracer(scene).trace(makeRay({0, 0, 5}, {0, 0, -1}));
    for (int c = 0; c < 3; ++c) {
        const double way = std::exp(-2.0 * static_cast<double>(scene.optics[0].attenuation[c]));
        const double r = 0.04, expected = r + (1 - r) * (1 - r) * way / (1 - r * way);
        EXPECT_NEAR(record.color[c], expected, 1e-9) << c;
    }
    EXPECT_EQ(record.lost.depth.count, 2u);  // both branches of the last inner ray
}

}  // namespace glint::reference::test::optics_test
