// Jitter finds what hangs on rounding, and only that.
#include <gtest/gtest.h>

#include <functional>

#include "support/packed_scene_maker.h"

namespace glint::reference::test::jitter_test {
using namespace glint::test;

using glm::dvec3;
using glm::vec3;

int countSeeds(const std::function<bool(uint64_t)>& holds) {
    int count = 0;
    for (uint64_t seed = 1; seed <= 64; ++seed) count += holds(seed);
    return count;
}

class ReferenceJitter : public testing::Test {
  protected:
    // A triangle over a mirror floor over a lamp; the ids of the whole path and the shadow identify the path.
    ReferenceJitter() {
        SceneMaker maker;
        const uint32_t mirror = maker.material(vec3(.5f), vec3(0), 1, vec3(.5f));
        maker.triangle({-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, mirror);
        maker.sphere({0, 0, 9}, 2);
        maker.light(shared::kLightPoint, {20, 0, 9});
        scene_ = maker.finish();
    }
    int differing(const Ray& ray, double ulps) const {
        const Tracer tracer(scene_);
        const uint32_t hash = tracer.trace(ray).pathHash;
        return countSeeds([&](uint64_t seed) { return tracer.trace(ray, {seed, ulps}).pathHash != hash; });
    }
    PackedScene scene_;
};

TEST_F(ReferenceJitter, NoneIsIdentical) {
    const Tracer tracer(scene_);
    const Ray ray = rayTowards({3, 1, 5}, {.1, .2, 0});
    EXPECT_EQ(tracer.trace(ray).color, tracer.trace(ray, {77, 0}).color);
    EXPECT_EQ(tracer.trace(ray, {77, 1}).color, tracer.trace(ray, {77, 1}).color);
    EXPECT_EQ(tracer.trace(ray, {77, 1}).hit, tracer.trace(ray, {77, 1}).hit);
    EXPECT_NE(tracer.trace(ray, {77, 1}).hit, tracer.trace(ray, {78, 1}).hit);
    EXPECT_NE(tracer.trace(ray, {77, 1}).hit, tracer.trace(ray).hit);
}

TEST_F(ReferenceJitter, InsideATriangleNothingChanges) {
    Random random(3);
    for (int i = 0; i < 50; ++i) {
        const dvec3 at(random.uniform(-.3, .3), random.uniform(-.5, 0), 0);
        EXPECT_EQ(differing(rayTowards({at.x + .1, at.y - .2, 5}, at), 4), 0);
    }
}

TEST_F(ReferenceJitter, AtAnEdgeItDoes) {
    const Ray ray = rayTowards({.5, -3, 5}, {0, -1, 0});
    const int count = differing(ray, 4);
    EXPECT_GT(count, 8) << "of 64; half of them are expected";
    EXPECT_LT(count, 56);
    EXPECT_EQ(differing(rayTowards({.5, -3, 5}, {0, -1 + 1e-5, 0}), 4), 0) << "40 times the jitter away";
}

// The shadow's outline on the triangle: exact to 1e-15 in the reference, not in fp32.
TEST_F(ReferenceJitter, FindsShadowEdges) {
    SceneMaker maker;
    maker.plane(vec3(0), {0, 1, 0});
    maker.triangle({0, 2, -50}, {0, 2, 50}, {100, 2, 0});  // its edge x = 0 lies above z axis
    maker.light(shared::kLightDirectional, {0, 1, 0});
    const SceneTracer tracer(maker);
    const auto shadowed = [&](double x) {
        const Ray ray = rayTowards({x - 1, 1, .3}, {x, 0, .3});
        return countSeeds([&](uint64_t seed) { return tracer.trace(ray, {seed, 4}).shadowBits != 0; });
    };
    EXPECT_EQ(shadowed(-1e-4), 0);
    EXPECT_EQ(shadowed(1e-4), 64);
    const int edge = shadowed(0);
    EXPECT_GT(edge, 8);
    EXPECT_LT(edge, 56);
}

// The greatest moves that any of many seeds makes, of camera rays and of the first ray that leaves a surface.
struct Moves {
    dvec3 origins{0}, directions{0}, spawned{0};

    Moves(const Tracer& tracer, const Ray& ray, double ulps) {
        for (uint64_t seed = 1; seed <= 400; ++seed) {
            const PixelRecord record = tracer.trace(ray, {seed, ulps}, true);
            EXPECT_EQ(record.path.size(), 2u);
            const Ray &first = record.path[0].ray, &second = record.path.at(1).ray;
            origins = glm::max(origins, glm::abs(first.origin - ray.origin));
            directions = glm::max(directions, glm::abs(first.direction - ray.direction));
            spawned = glm::max(spawned, glm::abs(second.origin - record.path[0].surface->position));
        }
    }
};

// Uniform moves come near to their bound on each axis. slack: the error of `moves` themselves.
void expectBound(const dvec3& moves, double bound, double slack = 1e-15) {
    for (int i = 0; i < 3; ++i) {
        EXPECT_LE(moves[i], bound + slack);
        EXPECT_GT(moves[i], .9 * bound);
    }
}

// The displacements are uniform in +- ulps 2^-24 scale, and no more.
TEST_F(ReferenceJitter, DisplacementsKeepTheirBounds) {
    const Moves moves(Tracer(scene_), makeRay({.3, -.4, 5}, {0, 0, -1}), 8);
    const double step = 8 * 0x1p-24;
    expectBound(moves.origins, 5 * step);  // scale 5: the origin's z
    expectBound(moves.directions, step);
    expectBound(moves.spawned, 5 * step, 5 * step * step + 1e-13);  // scale 5: the previous origin's z
}

// The point on a plane at z = -3 errs by gamma_7 of 3, along the normal.
TEST_F(ReferenceJitter, RaysLeaveAsFarAwayAsTheyDoInSinglePrecision) {
    SceneMaker maker;
    maker.triangle({-1, -1, -3}, {1, -1, -3}, {0, 1, -3}, maker.material(vec3(.5f), vec3(0), 1, vec3(.5f)));
    const SceneTracer tracer(maker);
    for (uint64_t seed = 1; seed <= 20; ++seed) {
        double height[2];
        for (const bool clears : {false, true}) {
            const Jitter jitter{.seed = seed, .ulps = 8, .clears = clears};
            const auto path = tracer.trace(makeRay({.3, -.4, 2}, {0, 0, -1}), jitter, true).path;
            height[clears] = (path[1].ray.origin.z - path[0].surface->position.z) / 8 * 0x1p24;
        }
        EXPECT_LE(std::abs(height[false]), 3) << "moves alone, of a unit of 3";
        EXPECT_NEAR(height[true] - height[false], 7 * 3, 1e-4);
    }
}

// A camera ray whose coordinates were sums of greater numbers moves with those.
TEST_F(ReferenceJitter, CameraRaysMoveWithWhatTheyWereComputedFrom) {
    Ray ray = makeRay({.3, -.4, 5}, {0, 0, -1});
    ray.originScale = 50;
    ray.directionScale = 3;
    const Moves moves(Tracer(scene_), ray, 1);
    expectBound(moves.origins, 50 * 0x1p-24);
    expectBound(moves.directions, 3 * 0x1p-24);
}

}  // namespace glint::reference::test::jitter_test
