// Packets of rays: where they are chosen, and that they find what lanes find, to the bit.
#include <cstdio>

#include "core/error.h"
#include "hard_rays.h"
#include "render/path_limits.h"

namespace glint::render::test::packet_test {
using glm::dvec3;

// ---- the rule ----

gpu::DeviceInfo deviceOf(bool llvmpipe, uint32_t lanes, bool shuffle) {
    gpu::DeviceInfo info;
    info.name = "a device";
    info.llvmpipe = llvmpipe;
    info.limits.subgroupSize = lanes;
    info.limits.subgroupShuffle = shuffle;
    return info;
}

PackedScene sceneOf(size_t triangles) {
    PackedScene scene;
    scene.triangles.resize(triangles);
    scene.features.triangles = scene.features.planes = scene.features.mirrors = scene.features.vertexNormals =
        true;
    return scene;
}

TEST(TraversalRule, PacketsOnLlvmpipeWithEightLanesThatShuffle) {
    const PackedScene scene = sceneOf(1000);
    EXPECT_TRUE(chooseTraversal(Traversal::Auto, deviceOf(true, 8, true), scene).packets);
    EXPECT_FALSE(chooseTraversal(Traversal::Auto, deviceOf(true, 16, true), scene).packets);
    EXPECT_FALSE(chooseTraversal(Traversal::Auto, deviceOf(true, 4, true), scene).packets);
    EXPECT_FALSE(chooseTraversal(Traversal::Auto, deviceOf(true, 8, false), scene).packets);
    EXPECT_FALSE(chooseTraversal(Traversal::Auto, deviceOf(false, 32, true), scene).packets);
    EXPECT_FALSE(chooseTraversal(Traversal::Auto, deviceOf(false, 8, true), scene).packets);
    EXPECT_FALSE(chooseTraversal(Traversal::Lane, deviceOf(true, 8, true), scene).packets);
    EXPECT_TRUE(chooseTraversal(Traversal::Packet, deviceOf(false, 8, true), scene).packets);
    const Methods plainSlabs = {.slabs = SlabPad::None};
    EXPECT_FALSE(chooseTraversal(Traversal::Packet, deviceOf(true, 8, true), scene, plainSlabs).packets);
}

TEST(TraversalRule, LoopsConvergeOnLlvmpipeWithEightLanesThatShuffle) {
    EXPECT_TRUE(loopsConverge(deviceOf(true, 8, true)));
    EXPECT_FALSE(loopsConverge(deviceOf(false, 8, true)));
    EXPECT_FALSE(loopsConverge(deviceOf(true, 16, true)));
    EXPECT_FALSE(loopsConverge(deviceOf(true, 8, false)));
}

TEST(TraversalRule, FewPrimitivesAreTracedByLanesUnlessAskedOtherwise) {
    const gpu::DeviceInfo device = deviceOf(true, 8, true);
    EXPECT_FALSE(chooseTraversal(Traversal::Auto, device, sceneOf(31)).packets);
    EXPECT_TRUE(chooseTraversal(Traversal::Auto, device, sceneOf(32)).packets);
    EXPECT_TRUE(chooseTraversal(Traversal::Packet, device, sceneOf(1)).packets);
    PackedScene mixed = sceneOf(16);
    mixed.spheres.resize(16);
    EXPECT_TRUE(chooseTraversal(Traversal::Auto, device, mixed).packets);
}

TEST(TraversalRule, PacketsAreRefusedWhereTheDeviceCannot) {
    try {
        chooseTraversal(Traversal::Packet, deviceOf(false, 32, true), sceneOf(1000));
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::Device);
        EXPECT_NE(std::string(e.what()).find("\"a device\" has 32 lanes"), std::string::npos) << e.what();
    }
}

// packet/traverse.glsl: a packet makes no more than 40 trips beyond its budget, one for each of 24 groups,
// and one to look for the next; before, each of a lane's rays meets all planes.
TEST(TraversalRule, PacketsInTurnStayBelowTheDriversTrips) {
    const uint32_t walk = deriveTripBudget(deviceOf(true, 8, true), SceneFeatures()) + 40 + 24 + 1;
    EXPECT_LT(shared::kPacketTurns * (walk + shared::kPacketRays * (shared::kMaxPlanes + 1)), 65535u);
}

// Features of geometry that the packets' kernel has no code for go to lanes.
TEST(TraversalRule, ScenesThatPacketsDoNotKnowAreTracedByLanes) {
    const gpu::DeviceInfo device = deviceOf(true, 8, true);
    PackedScene discs = sceneOf(1000), polygons = sceneOf(1000), full = sceneOf(1000), spheres;
    discs.features.discs = true;
    polygons.features.polygons = true;
    full.features = allFeatures();
    spheres.spheres.resize(1000);
    spheres.features.spheres = true;
    EXPECT_NE(chooseTraversal(Traversal::Auto, device, discs).reason.find("discs"), std::string::npos);
    EXPECT_FALSE(chooseTraversal(Traversal::Packet, device, discs).packets);
    EXPECT_FALSE(chooseTraversal(Traversal::Auto, device, polygons).packets);
    EXPECT_FALSE(chooseTraversal(Traversal::Auto, device, full).packets);
    EXPECT_TRUE(chooseTraversal(Traversal::Auto, device, spheres).packets);
    EXPECT_FALSE(chooseTraversal(Traversal::Auto, device, PackedScene()).packets);
}

// ---- the same bits ----

Options with(Traversal traversal) {
    return {.traversal = traversal};
}

class PacketTest : public RenderTest {
  protected:
    void SetUp() override {
        const gpu::DeviceLimits& limits = device().info().limits;
        std::printf("    subgroups of %u lanes\n", limits.subgroupSize);
        if (!device().info().llvmpipe && limits.subgroupSize != shared::kPacketWidth)
            GTEST_SKIP() << "packets are " << shared::kPacketWidth << " lanes wide";
        ASSERT_EQ(limits.subgroupSize, shared::kPacketWidth)
            << "lavapipe on a machine without 256-bit vectors";
        ASSERT_TRUE(limits.subgroupShuffle);
    }
    static void expectSameTrace(const PackedScene& packed, const std::vector<RayInput>& rays,
                                uint32_t tripBudget = 0) {
        RayTracer lane(device(), packed, with(Traversal::Lane)),
            packet(device(), packed, {.tripBudget = tripBudget, .traversal = Traversal::Packet});
        ASSERT_TRUE(packet.traversal().packets);
        EXPECT_TRUE(sameBits(packet.trace(rays, false), lane.trace(rays, false), rays));
        const std::vector<RayHit> a = packet.trace(rays, true), b = lane.trace(rays, true);
        for (size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(a[i].hit, b[i].hit) << text(rays[i]);
        EXPECT_TRUE(tripBudget == 0 || packet.resumes() > 0);
    }
    static void expectSamePicture(const Case& c) {
        EXPECT_TRUE(
            sameBits(draw(device(), c, with(Traversal::Packet)), draw(device(), c, with(Traversal::Lane))));
    }
};

class PacketSceneTest : public PacketTest, public testing::WithParamInterface<std::string> {};

TEST_P(PacketSceneTest, DrawsWhatLanesDraw) {
    expectSamePicture(fileCase(GetParam(), 96, 72));
}

INSTANTIATE_TEST_SUITE_P(All, PacketSceneTest, testing::ValuesIn(sceneNames()),
                         [](const auto& p) { return p.param; });

TEST_F(PacketTest, PacketsAndTilesMayBePartEmpty) {
    for (const glm::ivec2 size : {glm::ivec2(65, 23), glm::ivec2(1, 1)})
        expectSamePicture(fileCase("showcase", size.x, size.y));
}

// The picture of one ray in a packet whose others have nothing to do.
TEST_F(PacketTest, FindsTheSameForAnyNumberOfRays) {
    RayCase crowd = crowdedCase(200, 257, 13);
    for (const size_t count : {257u, 65u, 64u, 33u, 32u, 31u, 9u, 8u, 7u, 1u}) {
        crowd.rays.resize(count);
        expectSameTrace(crowd.c.packed, crowd.rays);
    }
}

// Packets that run out of trips are finished by lanes.
TEST_F(PacketTest, PacketsThatGiveUpLoseNothing) {
    const RayCase crowd = crowdedCase(1000, 1000, 17);
    for (const uint32_t budget : {1u, 9u, 60u}) expectSameTrace(crowd.c.packed, crowd.rays, budget);
}

// In one plane, whose triangles have t that differ by rounding: the lowest id that the packet knew is still
// hit, and so is a lower one that lanes find.
TEST_F(PacketTest, PacketsThatGiveUpKeepTheOrderOfCoincidentSurfaces) {
    Scene scene = emptyScene();
    Random random(23);
    const dvec3 across(2.0 / 3, 1.0 / 3, -2.0 / 3), along(2.0 / 3, -2.0 / 3, 1.0 / 3), up(1, 2, 2);
    const auto inPlane = [&] {
        const dvec3 p = random.box(2);
        return p.x * across + p.y * along;
    };
    for (int i = 0; i < 300; ++i) {
        const dvec3 a = inPlane(), b = inPlane(), c = inPlane();
        addTriangle(scene, a, b, c);
    }
    // Without split triangles, of which either place may be the one that is named.
    const Case c = makeCase(scene, 8, 8, BuildQuality::Fast);
    std::vector<RayInput> rays;
    for (int i = 0; i < 2048; ++i) rays.push_back(rayTowards(up + random.box(1), inPlane(), true));
    for (const uint32_t budget : {1u, 60u, 300u}) expectSameTrace(c.packed, rays, budget);
}

// More waits than the stack's 32 entries can hold; 60 primitives take too few trips to give up for those.
TEST_F(PacketTest, PacketsThatRunOutOfStackLoseNothing) {
    const RayCase nested = nestedCase();
    RayTracer packet(device(), nested.c.packed, with(Traversal::Packet));
    const std::vector<RayHit> hits = packet.trace(nested.rays, false);
    EXPECT_GT(packet.resumes(), 0u) << "no packet ran out of stack: the test shows nothing";
    for (const RayHit& hit : hits) EXPECT_EQ(hit.data.object, kNestedCount - 1);
    expectSameTrace(nested.c.packed, nested.rays);
}

// A subgroup takes several packets of any-hit rays in turn, and passes over those without any.
TEST_F(PacketTest, PacketsWithoutRaysArePassedOver) {
    const Case c = crowdedCase(200, 0, 19).c;
    Random random(19);
    for (const unsigned kept : {1u, 5u, 10u, 77u, 128u, 255u}) {
        std::vector<RayInput> rays;
        for (unsigned i = 0; i < 1000; ++i) {
            rays.push_back(rayTowards(random.box(3), random.box(2)));
            // Packets of a batch of eight by the bits of `kept`; in one of them a single ray.
            const unsigned packet = i / 32 % 8;
            if ((kept >> packet & 1u) == 0 || (packet == 2 && i % 32 != 17)) rays.back().tMax = 0;
        }
        expectSameTrace(c.packed, rays);
    }
}

// As many planes as there may be, rays of all octants, and a pile that takes all the trips there are: a
// subgroup's eight packets together stay below what the driver allows.
TEST_F(PacketTest, ManyTripsOfAllKindsLoseNothing) {
    Scene scene = emptyScene();
    Random random(31);
    for (int i = 0; i < 4000; ++i) {
        const dvec3 at = 0.01 * random.box(1);
        addTriangle(scene, at + random.box(2), at + random.box(2), at + random.box(2));
    }
    for (uint32_t i = 0; i < shared::kMaxPlanes; ++i) addPlane(scene, {0, -40.0 - 0.01 * i, 0}, {0, 1, 0});
    // Without split triangles, of which either place may be the one that is named.
    const Case c = makeCase(scene, 8, 8, BuildQuality::Fast);
    std::vector<RayInput> rays;
    for (int i = 0; i < 2048; ++i) {
        rays.push_back(rayTowards(random.box(2), random.box(2), true));
        rays.back().tMax = i % 3 == 0 ? 0.02f : 30.0f;
    }
    expectSameTrace(c.packed, rays);
}

// From far out most rays hit nothing, and the farthest child is visited first, which holds all clusters but
// the nearest: up to seven more clusters wait on the stack for every level.
TEST_F(PacketTest, AnyHitPacketsThatRunOutOfStackLoseNothing) {
    Random random(29);
    std::vector<RayInput> rays;
    for (int i = 0; i < 1024; ++i)
        rays.push_back(rayTowards(dvec3(2) + random.box(0.02), random.box(1e-15), true));
    for (RayInput& ray : rays) ray.tMax = 10;
    const auto resumesOf = [&](const Case& c) {
        // More than all loops make here: not trips run out.
        RayTracer packet(device(), c.packed, {.tripBudget = 7000, .traversal = Traversal::Packet});
        packet.trace(rays, true);
        return packet.resumes();
    };
    const Case few = outwardCase(20).c, many = outwardCase(130).c;
    EXPECT_EQ(resumesOf(few), 0u);
    EXPECT_GT(resumesOf(many), 0u) << "no packet ran out of stack: the test shows nothing";
    expectSameTrace(few.packed, rays);
    expectSameTrace(many.packed, rays);
}

TEST_F(PacketTest, ImagesWithCostsTraceSingleRays) {
    Scene scene = emptyScene();
    addSphere(scene, {0, 0, 0}, 1);
    aim(scene.camera, {0.5, 0, 5}, {0.5, 0, 0});
    scene.lights.push_back(DirectionalLight{{0, 0, -1}, Color(1)});
    Request request;
    request.width = request.height = 1;
    request.data = request.cost = true;
    const Case c = makeCase(scene, 1, 1);
    Renderer packets(device(), c.packed, with(Traversal::Packet));
    Renderer lanes(device(), c.packed, with(Traversal::Lane));
    const uint32_t cost = lanes.render(c.camera, request).at(0, 0).cost;
    EXPECT_GT(cost, 0u);
    EXPECT_EQ(packets.render(c.camera, request).at(0, 0).cost, cost);
}

// Two needles of 20 by 0.005 close above each other, and a wall before the light, which shades both.
Case needlesBehindAWall() {
    Scene scene = emptyScene();
    const dvec3 u = glm::normalize(dvec3(0.38, -0.46, -0.8)),
                v = glm::normalize(glm::cross(u, dvec3(1, 2, 0.3))), w = glm::cross(u, v), middle(7, -9, 5);
    const auto at = [&](double x, double y, double z) { return middle + x * u + y * v + z * w; };
    const auto addQuad = [&](const dvec3& a, const dvec3& b, const dvec3& c) {
        addTriangle(scene, a, b, c);
        addTriangle(scene, a, c, a + (c - b));
    };
    for (const double y : {0.0, -1e-5}) addQuad(at(-10, y, -0.0025), at(10, y, -0.0025), at(10, y, 0.0025));
    for (int i = 0; i < 8; ++i)
        for (int k = 0; k < 8; ++k)
            addQuad(at(14, -1 + 0.5 * i, k - 4), at(14, -1 + 0.5 * i, k - 3), at(14, -0.5 + 0.5 * i, k - 3));
    aim(scene.camera, at(0.3, 0.3, 0), at(0.3, 0, 0), w);
    scene.camera.fovY = 1;
    scene.lights.push_back(DirectionalLight{-u - 0.0175 * v - 0.5 * w, Color(1)});
    return makeCase(std::move(scene), 64, 48);
}

TEST_F(PacketTest, RaysThatLeaveANeedleReachTheWall) {
    const Case c = needlesBehindAWall();
    ASSERT_TRUE(c.packed.features.slivers);
    expectSamePicture(c);
}

}  // namespace glint::render::test::packet_test
