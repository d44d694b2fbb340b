// All traversals (with a stack, without one, packets) find the same hits, to the bit.
#include "hard_rays.h"

namespace glint::render::test::walks_test {
using glm::dvec3;

class WalkTest : public RenderTest {
  protected:
    // The stack traversal against the stackless one, which finishes rays from the budget on, and packets.
    static void expectSameTrace(const Case& c, const std::vector<RayInput>& rays, uint32_t tripBudget = 1) {
        RayTracer lane(device(), c.packed, {.traversal = Traversal::Lane});
        RayTracer resumed(device(), c.packed, {.tripBudget = tripBudget, .traversal = Traversal::Lane});
        const std::vector<RayHit> expected = lane.trace(rays, false), any = lane.trace(rays, true);
        const auto expectSame = [&](RayTracer& other) {
            EXPECT_TRUE(sameBits(other.trace(rays, false), expected, rays));
            const std::vector<RayHit> found = other.trace(rays, true);
            for (size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(found[i].hit, any[i].hit) << text(rays[i]);
        };
        for (size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(expected[i].hit, any[i].hit) << text(rays[i]);
        expectSame(resumed);
        EXPECT_TRUE(c.packed.nodes.size() < 2 || resumed.resumes() > 0);
        if (!runsPackets(device().info())) return;
        RayTracer packets(device(), c.packed, {.traversal = Traversal::Packet});
        expectSame(packets);
    }
    static void expectLowestId(const RayCase& tied) {
        const std::vector<RayHit> hits = hitsOf(tied.c.packed, tied.rays, {.traversal = Traversal::Lane});
        for (size_t i = 0; i < hits.size(); ++i) {
            ASSERT_TRUE(hits[i].hit) << text(tied.rays[i]);
            EXPECT_EQ(hits[i].data.object, 0u) << text(tied.rays[i]);
        }
        expectSameTrace(tied.c, tied.rays);
    }
};

TEST_F(WalkTest, FindsTheSameForAnyRays) {
    const RayCase crowd = crowdedCase(3000, 5000, 11);
    expectSameTrace(crowd.c, crowd.rays);
}

TEST_F(WalkTest, FindsTheSameForSpecialRays) {
    const RayCase special = axisCase();
    expectSameTrace(special.c, special.rays);
}

// Boxes around the origin are entered at -0, whose bits are those of no float above zero.
TEST_F(WalkTest, AnIntervalMayBeginAtMinusZero) {
    RayCase crowd = crowdedCase(3000, 3000, 13);
    for (RayInput& ray : crowd.rays) {
        ray.origin *= 0.3f;
        ray.tMin = -0.0f;
    }
    expectSameTrace(crowd.c, crowd.rays);
}

TEST_F(WalkTest, RaysThatRunOutOfTripsLoseNothing) {
    const RayCase crowd = crowdedCase(1000, 1000, 17);
    for (const uint32_t budget : {1u, 2u, 3u, 9u, 20u}) expectSameTrace(crowd.c, crowd.rays, budget);
}

TEST_F(WalkTest, TiesFromInsideGoToTheLowestId) {
    expectLowestId(concentricCase());
}

TEST_F(WalkTest, TiesGoToTheLowestId) {
    expectLowestId(tiedCase());
}

// Leaves that are the root, and none.
TEST_F(WalkTest, SmallestTrees) {
    for (const uint32_t triangles : {0u, 1u, 9u}) {
        const RayCase small = crowdedCase(triangles, 300, 19);
        expectSameTrace(small.c, small.rays);
    }
}

// Also with budgets that end within them.
TEST_F(WalkTest, FindsTheSameInInstances) {
    const Case c = fileCase("instances", 8, 8);
    ASSERT_GT(c.packed.instances.size(), 1u);
    Random random(23);
    std::vector<RayInput> rays;
    const dvec3 lo(c.packed.boundsLo), size = dvec3(c.packed.boundsHi) - lo;
    const auto inside = [&] { return lo + size * (0.5 + 0.5 * random.box(1)); };
    for (int i = 0; i < 3000; ++i) rays.push_back(rayTowards(inside(), inside()));
    expectSameTrace(c, rays);
    for (const uint32_t budget : {5u, 30u}) expectSameTrace(c, rays, budget);
}

}  // namespace glint::render::test::walks_test
