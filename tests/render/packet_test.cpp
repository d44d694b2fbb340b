// All traversals (with a stack, without one, packets) find the same hits, to the bit; where packets are
// chosen.
#include <cmath>

#include "render/path_limits.h"
#include "support.h"
#include "support/support.h"

namespace glint::render::test::packet_test {
using glm::dvec3;
using glm::vec3;

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

// Packets are the default, and loops converge, on the same devices.
TEST(TraversalRule, PacketsOnLlvmpipeWithEightLanesThatShuffle) {
    const PackedScene scene = sceneOf(1000);
    const gpu::DeviceInfo best = deviceOf(true, 8, true), fast = deviceOf(false, 8, true);
    EXPECT_TRUE(chooseTraversal(Traversal::Auto, best, scene).packets);
    EXPECT_TRUE(loopsConverge(best));
    for (const gpu::DeviceInfo& device : {deviceOf(true, 16, true), deviceOf(true, 4, true),
                                          deviceOf(true, 8, false), deviceOf(false, 32, true), fast}) {
        SCOPED_TRACE(testing::Message()
                     << "llvmpipe " << device.llvmpipe << ", lanes " << device.limits.subgroupSize
                     << ", shuffle " << device.limits.subgroupShuffle);
        EXPECT_FALSE(chooseTraversal(Traversal::Auto, device, scene).packets);
        EXPECT_FALSE(loopsConverge(device));
    }
    EXPECT_FALSE(chooseTraversal(Traversal::Lane, best, scene).packets);
    EXPECT_TRUE(chooseTraversal(Traversal::Packet, fast, scene).packets);
    EXPECT_FALSE(chooseTraversal(Traversal::Packet, best, scene, {.slabs = SlabPad::None}).packets);
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
    const std::string error = glint::test::errorOf(ErrorKind::Device, [] {
        chooseTraversal(Traversal::Packet, deviceOf(false, 32, true), sceneOf(1000));
    });
    EXPECT_HAS(error, "\"a device\" has 32 lanes");
}

// packet/packet.glsl: a packet makes at most 40 trips beyond its budget, one for each of 24 groups, and one
// to look for the next; before, each of a lane's rays tests all planes.
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
    EXPECT_HAS(chooseTraversal(Traversal::Auto, device, discs).reason, "discs");
    EXPECT_FALSE(chooseTraversal(Traversal::Packet, device, discs).packets);
    EXPECT_FALSE(chooseTraversal(Traversal::Auto, device, polygons).packets);
    EXPECT_FALSE(chooseTraversal(Traversal::Auto, device, full).packets);
    EXPECT_TRUE(chooseTraversal(Traversal::Auto, device, spheres).packets);
    EXPECT_FALSE(chooseTraversal(Traversal::Auto, device, PackedScene()).packets);
}

// ---- scenes and rays that try a traversal ----

struct RayCase {
    PackedScene scene;
    std::vector<RayInput> rays = {};
};

// A crowd of triangles and spheres over a plane, and rays of all octants and axes, from everywhere.
RayCase crowdedCase(uint32_t triangles, size_t rays, uint32_t seed) {
    Scene scene = emptyScene();
    Random random(7);
    for (uint32_t i = 0; i < triangles; ++i) {
        const dvec3 at = random.box(2);
        addTriangle(scene, at, at + random.box(0.5), at + random.box(0.5));
        if (i % 4 == 0) addSphere(scene, random.box(2), random.uniform(0.02, 0.3));
    }
    addPlane(scene, {0, -2, 0}, {0.1, 1, 0.2});
    RayCase result{packScene(scene)};
    Random directions(seed);
    while (result.rays.size() < rays) result.rays.push_back(rayTowards(directions.box(3), directions.box(2)));
    return result;
}

// Along axes and diagonals, where signs, inverses and the largest component are in doubt; from points that
// many boxes have sides in; and intervals that hold nothing.
RayCase axisCase() {
    Scene scene = emptyScene();
    addGrid(scene, 24);
    addGrid(scene, 24, {0, 0, -0.25});
    addSphere(scene, {0.5, 0.5, 0.25}, 0.25);
    RayCase result{packScene(scene)};
    std::vector<RayInput>& rays = result.rays;
    for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
            for (int z = -1; z <= 1; ++z) {
                for (int i = 0; i < 49; ++i) {
                    const vec3 from(static_cast<float>(i % 7) / 6.0f, static_cast<float>(i / 7) / 6.0f, 0.5f);
                    rays.push_back(rayOf(from - vec3(x, y, z), vec3(x, y, z)));
                    rays.push_back(rayOf(from, vec3(x, y, -0.0f)));
                    if (i % 5 == 0) rays.back().tMax = 0;
                    if (i % 9 == 0) rays.back().tMin = 0.75f;
                }
            }
        }
    }
    return result;
}

// Triangles and spheres in turn across the x axis at 1, 1/2, 1/4...: a node holds the largest and all that is
// smaller, which is entered first, while the others wait; two kinds, as a leaf holds one. The rays start
// inside the smallest, which is object kNestedCount - 1 and hit by all.
constexpr uint32_t kNestedCount = 60;
RayCase nestedCase() {
    Scene scene = emptyScene();
    for (uint32_t i = 0; i < kNestedCount; ++i) {
        const double s = std::ldexp(1.0, -static_cast<int>(i));
        if (i % 2 == 0)
            addTriangle(scene, {s, -s, -s}, {s, s, -s}, {s, 0, s});
        else
            addSphere(scene, {s, 0, 0}, 0.3 * s);
    }
    RayCase result{packScene(scene)};
    for (int i = 0; i < 64; ++i)
        result.rays.push_back(
            rayOf(vec3(0), {1, 0.01f * static_cast<float>(i % 8), 0.01f * static_cast<float>(i / 8)}));
    return result;
}

// Clusters of small spheres on the diagonal, smaller and smaller towards the origin. The nearest subtree
// holds all clusters but seven, so that some wait on every level.
PackedScene outwardScene(int clusters) {
    Scene scene = emptyScene();
    Random random(23);
    for (int k = 0; k < clusters; ++k) {
        const double s = std::pow(0.8, k);
        for (int i = 0; i < 8; ++i) addSphere(scene, dvec3(s) + random.box(0.04 * s), 1e-4 * s);
    }
    return packScene(scene);
}

// Concentric spheres by the same numbers, more than a leaf holds, and rays of all directions that start in
// their middle: whichever leaf comes first, they hit object 0.
RayCase concentricCase() {
    Scene scene = emptyScene();
    for (int i = 0; i < 40; ++i) addSphere(scene, {0.5, 0.25, -0.5}, 0.75);
    RayCase result{packScene(scene)};
    Random random(37);
    while (result.rays.size() < 512) {
        const dvec3 from = dvec3(0.5, 0.25, -0.5) + random.box(0.2);
        result.rays.push_back(rayTowards(from, from + random.box(1)));
    }
    return result;
}

// Five meshes in the same place. All rays hit object 0, as the lowest id wins.
RayCase tiedCase() {
    Scene scene = emptyScene();
    for (int i = 0; i < 5; ++i) addGrid(scene, 16);
    RayCase result{packScene(scene)};
    for (int i = 0; i < 1024; ++i) {
        const vec3 at((static_cast<float>(i % 32) + 0.5f) / 32.0f,
                      (static_cast<float>(i / 32) + 0.37f) / 32.0f, 1);
        result.rays.push_back(rayOf(at, {0, 0, -1}));
    }
    return result;
}

// ---- the same hits ----

class WalkTest : public RenderTest {
  protected:
    // Other traversals find the hits of the stack traversal. Those with a budget must resume rays.
    static void expectSame(const PackedScene& packed, const std::vector<RayInput>& rays,
                           const std::vector<Options>& others) {
        RayTracer lane(device(), packed, {.traversal = Traversal::Lane});
        const std::vector<RayHit> expected = lane.trace(rays, false), any = lane.trace(rays, true);
        for (size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(expected[i].hit, any[i].hit) << text(rays[i]);
        for (const Options& options : others) {
            if (options.traversal == Traversal::Packet && !runsPackets(device().info())) continue;
            RayTracer other(device(), packed, options);
            EXPECT_TRUE(sameBits(other.trace(rays, false), expected, rays));
            const std::vector<RayHit> found = other.trace(rays, true);
            for (size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(found[i].hit, any[i].hit) << text(rays[i]);
            EXPECT_TRUE(options.tripBudget == 0 || packed.nodes.size() < 2 || other.resumes() > 0);
        }
    }
    // Lanes that finish by the stackless traversal from the budget on, packets, and packets that lanes
    // finish.
    static void expectSame(const RayCase& rays, uint32_t budget = 1) {
        expectSame(rays.scene, rays.rays,
                   {{.tripBudget = budget, .traversal = Traversal::Lane},
                    {.traversal = Traversal::Packet},
                    {.tripBudget = budget, .traversal = Traversal::Packet}});
    }
};

TEST_F(WalkTest, FindsTheSameForAnyRays) {
    expectSame(crowdedCase(3000, 5000, 11));
}

TEST_F(WalkTest, FindsTheSameForSpecialRays) {
    expectSame(axisCase());
}

// Boxes around the origin are entered at -0, whose bits are those of no float above zero.
TEST_F(WalkTest, AnIntervalMayBeginAtMinusZero) {
    RayCase crowd = crowdedCase(3000, 3000, 13);
    for (RayInput& ray : crowd.rays) {
        ray.origin *= 0.3f;
        ray.tMin = -0.0f;
    }
    expectSame(crowd);
}

TEST_F(WalkTest, RaysThatRunOutOfTripsLoseNothing) {
    const RayCase crowd = crowdedCase(1000, 1000, 17);
    for (const uint32_t budget : {1u, 2u, 3u, 9u, 20u}) expectSame(crowd, budget);
}

TEST_F(WalkTest, TiesGoToTheLowestIdAlsoFromInside) {
    for (const auto& [name, tied] :
         {std::pair("from above", tiedCase()), std::pair("from inside", concentricCase())}) {
        SCOPED_TRACE(name);
        const std::vector<RayHit> hits = hitsOf(tied.scene, tied.rays, {.traversal = Traversal::Lane});
        for (size_t i = 0; i < hits.size(); ++i) {
            ASSERT_TRUE(hits[i].hit) << text(tied.rays[i]);
            EXPECT_EQ(hits[i].data.object, 0u) << text(tied.rays[i]);
        }
        expectSame(tied);
    }
}

// Leaves that are the root, and none.
TEST_F(WalkTest, SmallestTrees) {
    for (const uint32_t triangles : {0u, 1u, 9u}) expectSame(crowdedCase(triangles, 300, 19));
}

// The budgets end within instances, too.
TEST_F(WalkTest, FindsTheSameInInstances) {
    RayCase inside{fileCase("instances", 8, 8).packed};
    const PackedScene& packed = inside.scene;
    ASSERT_GT(packed.instances.size(), 1u);
    Random random(23);
    const dvec3 lo(packed.boundsLo), size = dvec3(packed.boundsHi) - lo;
    const auto point = [&] { return lo + size * (0.5 + 0.5 * random.box(1)); };
    for (int i = 0; i < 3000; ++i) inside.rays.push_back(rayTowards(point(), point()));
    for (const uint32_t budget : {1u, 5u, 30u}) expectSame(inside, budget);
}

// ---- packets alone ----

class PacketTest : public WalkTest {
  protected:
    void SetUp() override {
        const gpu::DeviceLimits& limits = device().info().limits;
        if (!device().info().llvmpipe && limits.subgroupSize != shared::kPacketWidth)
            GTEST_SKIP() << "packets are " << shared::kPacketWidth << " lanes wide";
        ASSERT_EQ(limits.subgroupSize, shared::kPacketWidth)
            << "lavapipe on a machine without 256-bit vectors";
        ASSERT_TRUE(limits.subgroupShuffle);
    }
    static void expectSameByPackets(const PackedScene& packed, const std::vector<RayInput>& rays,
                                    uint32_t tripBudget = 0) {
        ASSERT_TRUE(RayTracer(device(), packed, {.traversal = Traversal::Packet}).traversal().packets);
        expectSame(packed, rays, {{.tripBudget = tripBudget, .traversal = Traversal::Packet}});
    }
    static void expectSamePicture(const Case& c) {
        EXPECT_TRUE(sameBits(draw(device(), c, {.traversal = Traversal::Packet}),
                             draw(device(), c, {.traversal = Traversal::Lane})));
    }
};

TEST_F(PacketTest, PacketsAndTilesMayBePartEmpty) {
    for (const glm::ivec2 size : {glm::ivec2(65, 23), glm::ivec2(1, 1)})
        expectSamePicture(fileCase("showcase", size.x, size.y));
}

// The picture of one ray in a packet whose others have nothing to do.
TEST_F(PacketTest, FindsTheSameForAnyNumberOfRays) {
    RayCase crowd = crowdedCase(200, 257, 13);
    for (const size_t count : {257u, 65u, 64u, 33u, 32u, 31u, 9u, 8u, 7u, 1u}) {
        crowd.rays.resize(count);
        expectSameByPackets(crowd.scene, crowd.rays);
    }
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
    // Without split triangles: kernels may report either copy.
    const PackedScene packed = packScene(scene, {BuildQuality::Fast});
    std::vector<RayInput> rays;
    for (int i = 0; i < 2048; ++i) rays.push_back(rayTowards(up + random.box(1), inPlane(), true));
    for (const uint32_t budget : {1u, 60u, 300u}) expectSameByPackets(packed, rays, budget);
}

// More waits than the stack's 32 entries can hold; 60 primitives take too few trips to give up for those.
TEST_F(PacketTest, PacketsThatRunOutOfStackLoseNothing) {
    const RayCase nested = nestedCase();
    RayTracer packet(device(), nested.scene, {.traversal = Traversal::Packet});
    const std::vector<RayHit> hits = packet.trace(nested.rays, false);
    EXPECT_GT(packet.resumes(), 0u) << "no packet ran out of stack: the test shows nothing";
    for (const RayHit& hit : hits) EXPECT_EQ(hit.data.object, kNestedCount - 1);
    expectSameByPackets(nested.scene, nested.rays);
}

// A subgroup takes several packets of any-hit rays in turn, and passes over those without any.
TEST_F(PacketTest, PacketsWithoutRaysArePassedOver) {
    const PackedScene packed = crowdedCase(200, 0, 19).scene;
    Random random(19);
    for (const unsigned kept : {1u, 5u, 10u, 77u, 128u, 255u}) {
        std::vector<RayInput> rays;
        for (unsigned i = 0; i < 1000; ++i) {
            rays.push_back(rayTowards(random.box(3), random.box(2)));
            // Packets of a batch of eight by the bits of `kept`; in one of them a single ray.
            const unsigned packet = i / 32 % 8;
            if ((kept >> packet & 1u) == 0 || (packet == 2 && i % 32 != 17)) rays.back().tMax = 0;
        }
        expectSameByPackets(packed, rays);
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
    // Without split triangles: kernels may report either copy.
    const PackedScene packed = packScene(scene, {BuildQuality::Fast});
    std::vector<RayInput> rays;
    for (int i = 0; i < 2048; ++i) {
        rays.push_back(rayTowards(random.box(2), random.box(2), true));
        rays.back().tMax = i % 3 == 0 ? 0.02f : 30.0f;
    }
    expectSameByPackets(packed, rays);
}

// From far out most rays hit nothing, and the farthest child is visited first, which holds all clusters but
// the nearest: up to seven more clusters wait on the stack for every level.
TEST_F(PacketTest, AnyHitPacketsThatRunOutOfStackLoseNothing) {
    Random random(29);
    std::vector<RayInput> rays;
    for (int i = 0; i < 1024; ++i)
        rays.push_back(rayTowards(dvec3(2) + random.box(0.02), random.box(1e-15), true));
    for (RayInput& ray : rays) ray.tMax = 10;
    const auto resumesOf = [&](const PackedScene& scene) {
        // More than all loops make here: not trips run out.
        RayTracer packet(device(), scene, {.tripBudget = 7000, .traversal = Traversal::Packet});
        packet.trace(rays, true);
        return packet.resumes();
    };
    const PackedScene few = outwardScene(20), many = outwardScene(130);
    EXPECT_EQ(resumesOf(few), 0u);
    EXPECT_GT(resumesOf(many), 0u) << "no packet ran out of stack: the test shows nothing";
    expectSameByPackets(few, rays);
    expectSameByPackets(many, rays);
}

TEST_F(PacketTest, ImagesWithCostsTraceSingleRays) {
    Scene scene = emptyScene();
    addSphere(scene, {0, 0, 0}, 1);
    aim(scene.camera, {0.5, 0, 5}, {0.5, 0, 0});
    scene.lights.push_back(DirectionalLight{{0, 0, -1}, Color(1)});
    const Case c = makeCase(scene, 1, 1);
    auto request = sized<Request>(c);
    request.data = request.cost = true;
    Renderer packets(device(), c.packed, {.traversal = Traversal::Packet});
    Renderer lanes(device(), c.packed, {.traversal = Traversal::Lane});
    const uint32_t cost = lanes.render(request).at(0, 0).cost;
    EXPECT_GT(cost, 0u);
    EXPECT_EQ(packets.render(request).at(0, 0).cost, cost);
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
