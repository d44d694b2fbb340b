// Batches of world-space rays: a ray's hit does not depend on the rest of the batch or the position of the
// scene.
#include "trace/ray_batch.h"

#include <cmath>
#include <limits>

#include "app/trace_batch.h"
#include "reference/render.h"
#include "support.h"

namespace glint::render::test::ray_batch_test {
using glm::dvec3;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class RayBatchTest : public RenderTest {};

bool same(const WorldHit& a, const WorldHit& b) {
    return a.hit == b.hit && a.t == b.t && a.u == b.u && a.v == b.v && a.point == b.point &&
           a.normal == b.normal && a.object == b.object && a.face == b.face && a.material == b.material &&
           a.packed == b.packed;
}

RayBatch raysInto(const Case& c, size_t count, uint32_t seed) {
    Random random(seed);
    const dvec3 lo = c.packed.origin + dvec3(c.packed.boundsLo),
                hi = c.packed.origin + dvec3(c.packed.boundsHi);
    const dvec3 middle = 0.5 * (lo + hi);
    const double reach = 0.5 * glm::length(hi - lo);
    RayBatch batch;
    for (size_t i = 0; i < count; ++i) {
        const dvec3 from = middle + 1.5 * reach * random.direction();
        const dvec3 to = middle + random.box(0.5 * reach);
        WorldRay ray = {from, (to - from) * std::ldexp(1.0, static_cast<int>(i % 5) * 20 - 40)};
        if (i % 7 == 0) ray.tMin = 0.9 / std::ldexp(1.0, static_cast<int>(i % 5) * 20 - 40);
        if (i % 11 == 0) ray.tMax = 0;
        batch.rays.push_back(ray);
    }
    return batch;
}

class RayBatchScenes : public RayBatchTest, public testing::WithParamInterface<const char*> {};

INSTANTIATE_TEST_SUITE_P(Scenes, RayBatchScenes,
                         testing::Values("knot", "glass", "instances", "quadrics", "far_away", "textures"),
                         [](const auto& p) { return std::string(p.param); });

TEST_P(RayBatchScenes, ABatchIsItsSingleRays) {
    const Case c = fileCase(GetParam(), 16, 12);
    RayQueries queries(device(), c.packed);
    const RayBatch batch = raysInto(c, 300, 1);
    const std::vector<WorldHit> together = app::traceBatch(queries, c.packed, batch),
                                host = reference::trace(c.packed, batch);
    ASSERT_EQ(together.size(), batch.rays.size());
    size_t hits = 0;
    for (size_t i = 0; i < batch.rays.size(); ++i) {
        RayBatch one = batch;
        one.rays = {batch.rays[i]};
        if (i % 3 == 0) {
            EXPECT_TRUE(same(app::traceBatch(queries, c.packed, one)[0], together[i])) << i;
        }
        EXPECT_TRUE(same(reference::trace(c.packed, one)[0], host[i])) << i;
        hits += host[i].hit;
        if (i % 11 == 0) {
            EXPECT_FALSE(together[i].hit || host[i].hit) << "an empty interval";
        }
    }
    EXPECT_GT(hits, 50u);
    EXPECT_EQ(app::traceBatch(queries, c.packed, RayBatch{}).size(), 0u);
}

// The device and the reference agree on random rays, but for the rounding of fp32.
TEST_P(RayBatchScenes, BothTracersMeetTheSame) {
    const Case c = fileCase(GetParam(), 16, 12);
    RayQueries queries(device(), c.packed);
    const RayBatch batch = raysInto(c, 2000, 2);
    const std::vector<WorldHit> device = app::traceBatch(queries, c.packed, batch),
                                host = reference::trace(c.packed, batch);
    size_t agree = 0;
    for (size_t i = 0; i < host.size(); ++i) {
        if (device[i].hit != host[i].hit || device[i].object != host[i].object ||
            device[i].face != host[i].face)
            continue;
        ++agree;
        if (!host[i].hit) continue;
        EXPECT_EQ(device[i].material, host[i].material);
        EXPECT_NEAR(device[i].t, host[i].t, 1e-4 * host[i].t);
        const double way = glm::length(batch.rays[i].direction) * host[i].t;
        EXPECT_LE(glm::length(device[i].point - host[i].point), 1e-3 * way);
        EXPECT_LE(glm::length(device[i].normal - host[i].normal), 5e-2);
        EXPECT_NEAR(glm::length(host[i].normal), 1, 1e-12);
    }
    EXPECT_GT(agree, host.size() * 98 / 100);
}

TEST_F(RayBatchTest, DetailsAreAsManyAsAskedFor) {
    const Case c = fileCase("knot", 16, 12);
    RayQueries queries(device(), c.packed);
    RayBatch batch = raysInto(c, 500, 3);
    const std::vector<WorldHit> full = app::traceBatch(queries, c.packed, batch),
                                host = reference::trace(c.packed, batch);
    batch.detail = HitDetail::Nearest;
    const std::vector<WorldHit> nearest = app::traceBatch(queries, c.packed, batch),
                                hostNearest = reference::trace(c.packed, batch);
    batch.detail = HitDetail::Any;
    BatchTimes times;
    const std::vector<WorldHit> any = app::traceBatch(queries, c.packed, batch, false, &times),
                                hostAny = reference::trace(c.packed, batch);
    EXPECT_GT(times.wall, 0);
    EXPECT_GT(times.processor, 0);
    for (size_t i = 0; i < batch.rays.size(); ++i) {
        EXPECT_EQ(nearest[i].hit, full[i].hit);
        EXPECT_EQ(nearest[i].t, full[i].t);
        EXPECT_EQ(nearest[i].packed, full[i].packed);
        EXPECT_EQ(nearest[i].object, PixelData::kNoIndex);
        EXPECT_GT(hostNearest[i].cost, i % 11 == 0 ? -1.0 : 0.0);
        EXPECT_EQ(hostNearest[i].t, host[i].t);
        EXPECT_EQ(hostNearest[i].packed, host[i].packed);
        EXPECT_EQ(any[i].hit, full[i].hit);
        EXPECT_EQ(any[i].t, kInfinity);
        EXPECT_EQ(hostAny[i].hit, host[i].hit);
        if (!nearest[i].hit) {
            EXPECT_TRUE(same(nearest[i], WorldHit()));
        }
    }
}

TEST(LocalRay, IsScaledExactlyAndOnlyWhereItMustBe) {
    const LocalRay plain = localRay({{3, 4, 5}, {0, 0, -1000}, 1, 7}, {1, 1, 1});
    EXPECT_EQ(plain.origin, dvec3(2, 3, 4));
    EXPECT_EQ(plain.exponent, 0);
    EXPECT_EQ(plain.worldT(3), 3);
    const double huge = std::ldexp(1.5, 100);
    const LocalRay scaled = localRay({{0, 0, 0}, {0, huge, 0}, std::ldexp(1.0, -100), kInfinity}, {0, 0, 0});
    EXPECT_EQ(scaled.direction, dvec3(0, 1.5, 0));
    EXPECT_EQ(scaled.tMin, 1);
    EXPECT_EQ(scaled.tMax, kInfinity);
    EXPECT_EQ(scaled.worldT(2), std::ldexp(2.0, -100));
    EXPECT_EQ(localRay({{0, 0, 0}, {0, 0, 0}}, {0, 0, 0}).exponent, 0);
    EXPECT_EQ(localRay({{0, 0, 0}, {kInfinity, 0, 0}}, {0, 0, 0}).exponent, 0);
}

}  // namespace glint::render::test::ray_batch_test
