// Jitter finds what hangs on rounding, and only that.
#include <gtest/gtest.h>

#include "support/packed_scene_maker.h"

namespace glint::reference::test::jitter_test {
using namespace glint::test;

using glm::dvec3;
using glm::vec3;

class ReferenceJitter : public testing::Test {
  protected:
    // A triangle over a mirror floor over a lamp; the ids of the whole path and the shadow tell.
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
        int count = 0;
        for (uint64_t seed = 1; seed <= 64; ++seed) count += tracer.trace(ray, {seed, ulps}).pathHash != hash;
        return count;
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

// The shadow's outline on the triangle: the reference knows it to 1e-15, fp32 does not.
TEST_F(ReferenceJitter, FindsShadowEdges) {
    SceneMaker maker;
    maker.plane(vec3(0), {0, 1, 0});
    maker.triangle({0, 2, -50}, {0, 2, 50}, {100, 2, 0});  // its edge x = 0 lies above z axis
    maker.light(shared::kLightDirectional, {0, 1, 0});
    const SceneTracer tracer(maker);
    const auto shadowed = [&](double x) {
        int count = 0;
        for (uint64_t seed = 1; seed <= 64; ++seed)
            count += tracer.trace(rayTowards({x - 1, 1, .3}, {x, 0, .3}), {seed, 4}).shadowBits != 0;
        return count;
    };
    EXPECT_EQ(shadowed(-1e-4), 0);
    EXPECT_EQ(shadowed(1e-4), 64);
    const int edge = shadowed(0);
    EXPECT_GT(edge, 8);
    EXPECT_LT(edge, 56);
}

// The displacements are uniform in +- ulps 2^-24 scale, and no more.
TEST_F(ReferenceJitter, DisplacementsKeepTheirBounds) {
    const Tracer tracer(scene_);
    const dvec3 origin(.3, -.4, 5);
    const Ray ray = makeRay(origin, {0, 0, -1});
    const double ulps = 8, step = ulps * 0x1p-24;
    dvec3 origins(0), directions(0), spawned(0);
    for (uint64_t seed = 1; seed <= 400; ++seed) {
        const PixelRecord record = tracer.trace(ray, {seed, ulps}, true);
        ASSERT_EQ(record.path.size(), 2u);
        const Ray& first = record.path[0].ray;
        const Ray& second = record.path[1].ray;
        origins = glm::max(origins, glm::abs(first.origin - origin));
        directions = glm::max(directions, glm::abs(first.direction - ray.direction));
        spawned = glm::max(spawned, glm::abs(second.origin - record.path[0].surface->position));
    }
    for (int i = 0; i < 3; ++i) {
        EXPECT_LE(origins[i], 5 * step + 1e-15) << "scale 5: the origin's z";
        EXPECT_GT(origins[i], .9 * 5 * step);
        EXPECT_LE(directions[i], step + 1e-15);
        EXPECT_GT(directions[i], .9 * step);
        EXPECT_LE(spawned[i], 5 * (1 + step) * step + 1e-13) << "scale 5: the previous origin's z";
        EXPECT_GT(spawned[i], .9 * 5 * step);
    }
}

// Of a plane at z = -3 the point errs by gamma_7 of that, along the normal.
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
    const Tracer tracer(scene_);
    Ray ray = makeRay({.3, -.4, 5}, {0, 0, -1});
    ray.originScale = 50;
    ray.directionScale = 3;
    const double step = 0x1p-24;
    dvec3 origins(0), directions(0);
    for (uint64_t seed = 1; seed <= 400; ++seed) {
        const Ray moved = tracer.trace(ray, {seed, 1}, true).path[0].ray;
        origins = glm::max(origins, glm::abs(moved.origin - ray.origin));
        directions = glm::max(directions, glm::abs(moved.direction - ray.direction));
    }
    for (int i = 0; i < 3; ++i) {
        EXPECT_LE(origins[i], 50 * step + 1e-15);
        EXPECT_GT(origins[i], .9 * 50 * step);
        EXPECT_LE(directions[i], 3 * step + 1e-15);
        EXPECT_GT(directions[i], .9 * 3 * step);
    }
}

}  // namespace glint::reference::test::jitter_test
