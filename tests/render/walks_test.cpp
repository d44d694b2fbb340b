// Rays that walk by themselves, in every format of nodes and with either stack: where which is chosen, and
// that all find what the binary tree's find, to the bit.
#include <algorithm>
#include <bit>
#include <cmath>

#include "core/error.h"
#include "hard_rays.h"
#include "mutant_kernels.h"
#include "verify/verify.h"

namespace glint::render::test::walks_test {
namespace {

using glm::dvec3;

// ---- the rule ----

gpu::DeviceInfo deviceOf(const std::string& type, bool llvmpipe = false) {
    gpu::DeviceInfo info;
    info.name = "a device";
    info.type = type;
    info.llvmpipe = llvmpipe;
    info.limits.subgroupSize = llvmpipe ? 8 : 32;
    info.limits.subgroupShuffle = true;
    return info;
}

PackedScene sceneOf(size_t triangles) {
    PackedScene scene;
    scene.triangles.resize(triangles);
    scene.nodes.resize(triangles > 0 ? 1 : 0);
    scene.features.triangles = triangles > 0;
    return scene;
}

PackedScene discsInInstances() {
    PackedScene scene;
    scene.nodes.resize(2);
    scene.discs.resize(1);
    scene.instances.resize(31);
    scene.features.discs = scene.features.instances = true;
    return scene;
}

TEST(LaneRule, IsThisTable) {
    using enum Traversal;
    const Methods plainSlabs = {.slabs = SlabPad::None};
    const struct {
        const char* type;
        bool llvmpipe;
        Traversal wanted;
        PackedScene scene;
        const char* expected;
        Methods methods = {};
    } rows[] = {
        {"discrete GPU", false, Auto, sceneOf(32), "cwbvh"},
        {"integrated GPU", false, Auto, sceneOf(32), "cwbvh"},
        {"virtual GPU", false, Auto, sceneOf(32), "cwbvh"},
        {"other", false, Auto, sceneOf(32), "lane"},
        {"CPU", false, Auto, sceneOf(32), "lane"},
        {"CPU", true, Auto, sceneOf(32), "packet"},
        {"discrete GPU", false, Auto, sceneOf(31), "lane"},
        {"discrete GPU", false, Auto, discsInInstances(), "cwbvh"},
        {"discrete GPU", false, Auto, sceneOf(0), "lane"},
        {"discrete GPU", false, Auto, sceneOf(1000), "lane", plainSlabs},
        {"discrete GPU", false, Lane, sceneOf(1000), "lane"},
        {"discrete GPU", false, Bvh4, sceneOf(1), "bvh4"},
        {"discrete GPU", false, Cwbvh, sceneOf(1), "cwbvh"},
        {"CPU", true, Bvh4, sceneOf(1000), "bvh4"},
        {"CPU", true, Cwbvh, sceneOf(1000), "cwbvh"},
        {"CPU", true, Cwbvh, discsInInstances(), "cwbvh"},
        {"CPU", true, Cwbvh, sceneOf(0), "lane"},
        {"CPU", true, Bvh4, sceneOf(1000), "lane", plainSlabs},
    };
    for (const auto& row : rows) {
        const TraversalChoice choice =
            chooseTraversal(row.wanted, deviceOf(row.type, row.llvmpipe), row.scene, row.methods);
        EXPECT_EQ(nameOf(choice), row.expected)
            << row.type << ", wanted " << static_cast<int>(row.wanted) << ", " << row.scene.triangles.size()
            << " triangles: " << choice.reason;
        EXPECT_FALSE(choice.reason.empty());
    }
}

// Many rays that walk by themselves, on llvmpipe alone, and only where a picture is large for its scene.
TEST(LaneRule, TakesNodesOfFourForManyRays) {
    const gpu::DeviceInfo llvmpipe = deviceOf("CPU", true);
    PackedScene scene = sceneOf(5000);
    scene.nodes.resize(kFewestForFour);
    const auto nodesOf = [&](uint64_t rays, const gpu::DeviceInfo& device, const Methods& methods = {},
                             Traversal wanted = Traversal::Auto) {
        return chooseTraversal(wanted, device, scene, methods, rays).nodes;
    };
    scene.features.mirrors = true;
    EXPECT_EQ(nodesOf(kFewestOfPictureForFour, llvmpipe), NodeFormat::Four);
    EXPECT_TRUE(chooseTraversal(Traversal::Auto, llvmpipe, scene, {}, kFewestOfPictureForFour).packets);
    EXPECT_EQ(nodesOf(kFewestOfPictureForFour - 1, llvmpipe), NodeFormat::Two);
    EXPECT_EQ(nodesOf(0, llvmpipe), NodeFormat::Two);
    EXPECT_EQ(nodesOf(kFewestOfPictureForFour, deviceOf("CPU")), NodeFormat::Two);
    EXPECT_EQ(nodesOf(kFewestOfPictureForFour, llvmpipe, {.slabs = SlabPad::None}), NodeFormat::Two);
    EXPECT_EQ(nodesOf(kFewestOfPictureForFour, llvmpipe, {}, Traversal::Lane), NodeFormat::Two);
    EXPECT_EQ(nodesOf(kFewestOfPictureForFour, llvmpipe, {}, Traversal::Packet), NodeFormat::Two);
    scene.features.mirrors = false;  // packets trace all
    EXPECT_EQ(nodesOf(kFewestOfPictureForFour, llvmpipe), NodeFormat::Two);
    scene.features.discs = true;  // none
    EXPECT_EQ(nodesOf(kFewestOfPictureForFour, llvmpipe), NodeFormat::Four);
    scene.features.coloredShadows = true;  // whose last bits are the walk's
    EXPECT_EQ(nodesOf(kFewestOfPictureForFour, llvmpipe), NodeFormat::Two);
    scene.features.coloredShadows = false;
    scene.nodes.pop_back();
    EXPECT_EQ(nodesOf(kFewestOfPictureForFour, llvmpipe), NodeFormat::Two);
    scene.nodes.resize(kMostFourNodes + 1);
    EXPECT_EQ(nodesOf(uint64_t{1} << 40, llvmpipe), NodeFormat::Two);
    EXPECT_NE(chooseTraversal(Traversal::Bvh4, llvmpipe, scene).reason.find("number"), std::string::npos);
    scene = sceneOf(kFewestOfPictureForFour / kPictureRaysOfPrimitiveForFour + 1);
    scene.nodes.resize(kFewestForFour);
    scene.features.discs = true;
    EXPECT_EQ(nodesOf(kFewestOfPictureForFour, llvmpipe), NodeFormat::Two);
}

TEST(LaneRule, LoopsConvergeOnLlvmpipeWithEightLanesThatShuffleAndAStackOfTheirOwn) {
    const gpu::DeviceInfo llvmpipe = deviceOf("CPU", true);
    for (const NodeFormat nodes : {NodeFormat::Two, NodeFormat::Four}) {
        EXPECT_TRUE(walksConverge(llvmpipe, nodes, StackPlace::Private));
        EXPECT_FALSE(walksConverge(llvmpipe, nodes, StackPlace::Shared));
        gpu::DeviceInfo other = llvmpipe;
        other.llvmpipe = false;
        EXPECT_FALSE(walksConverge(other, nodes, StackPlace::Private));
        other = llvmpipe;
        other.limits.subgroupSize = 16;
        EXPECT_FALSE(walksConverge(other, nodes, StackPlace::Private));
        other = llvmpipe;
        other.limits.subgroupShuffle = false;
        EXPECT_FALSE(walksConverge(other, nodes, StackPlace::Private));
    }
    EXPECT_FALSE(walksConverge(llvmpipe, NodeFormat::Compressed, StackPlace::Private));
}

TEST(LaneRule, SaysWhyNotWhatWasAskedFor) {
    const gpu::DeviceInfo device = deviceOf("discrete GPU");
    EXPECT_NE(chooseTraversal(Traversal::Cwbvh, device, sceneOf(0)).reason.find("no tree"),
              std::string::npos);
    const Methods plainSlabs = {.slabs = SlabPad::None};
    EXPECT_NE(chooseTraversal(Traversal::Bvh4, device, sceneOf(9), plainSlabs).reason.find("padding"),
              std::string::npos);
    try {
        chooseTraversal(Traversal::Packet, device, sceneOf(1000));
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::Device);
    }
}

TEST_F(RenderTest, ATreeThatNothingWalksIsNotThere) {
    const Case c = fileCase("knot", 8, 8);
    const auto bytes = [&](Traversal traversal) {
        Options options;
        options.traversal = traversal;
        return Renderer(device(), c.packed, options).deviceBytes();
    };
    const uint64_t lane = bytes(Traversal::Lane);
    EXPECT_EQ(bytes(Traversal::Bvh4) - lane,
              wideTree(c.packed.nodes, NodeFormat::Four).rows.size() * sizeof(shared::WideRow));
    EXPECT_EQ(bytes(Traversal::Cwbvh) - lane,
              wideTree(c.packed.nodes, NodeFormat::Compressed).rows.size() * sizeof(shared::WideRow));
}

// ---- the same bits ----

struct Walk {
    const char* name;
    Traversal traversal;
    StackPlace stack = StackPlace::Private;
};
const Walk kWalks[] = {{"bvh4", Traversal::Bvh4},
                       {"cwbvh", Traversal::Cwbvh},
                       {"laneShared", Traversal::Lane, StackPlace::Shared},
                       {"bvh4Shared", Traversal::Bvh4, StackPlace::Shared},
                       {"cwbvhShared", Traversal::Cwbvh, StackPlace::Shared}};

void PrintTo(const Walk& walk, std::ostream* out) {
    *out << walk.name;
}

Options with(const Walk& walk) {
    Options options;
    options.traversal = walk.traversal;
    options.stack = walk.stack;
    return options;
}
const Walk kBinary = {"lane", Traversal::Lane};

class WalkTest : public RenderTest, public testing::WithParamInterface<Walk> {
  protected:
    static Options options() { return with(GetParam()); }
    static Renderer rendererOf(const Case& c) { return Renderer(device(), c.packed, options()); }
    static void expectSameTrace(const Case& c, const std::vector<RayInput>& rays, uint32_t tripBudget = 0) {
        Options walking = options();
        walking.tripBudget = tripBudget;
        Renderer binary(device(), c.packed, with(kBinary)), walk(device(), c.packed, walking);
        EXPECT_TRUE(sameBits(walk.trace(rays, false), binary.trace(rays, false), rays));
        const std::vector<RayHit> a = walk.trace(rays, true), b = binary.trace(rays, true);
        for (size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(a[i].hit, b[i].hit) << text(rays[i]);
        EXPECT_TRUE(tripBudget == 0 || walk.times().resumes > 0);
    }
    static void expectLowestId(const RayCase& tied) {
        const std::vector<RayHit> hits = rendererOf(tied.c).trace(tied.rays, false);
        for (size_t i = 0; i < hits.size(); ++i) {
            ASSERT_TRUE(hits[i].hit) << text(tied.rays[i]);
            EXPECT_EQ(hits[i].data.object, 0u) << text(tied.rays[i]);
        }
        expectSameTrace(tied.c, tied.rays);
    }
};

INSTANTIATE_TEST_SUITE_P(All, WalkTest, testing::ValuesIn(kWalks),
                         [](const auto& p) { return p.param.name; });

TEST_P(WalkTest, FindsTheSameForAnyRays) {
    const RayCase crowd = crowdedCase(3000, 5000, 11);
    expectSameTrace(crowd.c, crowd.rays);
}

TEST_P(WalkTest, FindsTheSameForSpecialRays) {
    const RayCase special = axisCase();
    expectSameTrace(special.c, special.rays);
}

// Boxes around the origin are entered at -0, whose bits are those of no float above zero.
TEST_P(WalkTest, AnIntervalMayBeginAtMinusZero) {
    RayCase crowd = crowdedCase(3000, 3000, 13);
    for (RayInput& ray : crowd.rays) {
        ray.origin *= 0.3f;
        ray.tMin = -0.0f;
    }
    expectSameTrace(crowd.c, crowd.rays);
}

TEST_P(WalkTest, RaysThatRunOutOfTripsLoseNothing) {
    const RayCase crowd = crowdedCase(1000, 1000, 17);
    for (const uint32_t budget : {1u, 2u, 3u, 9u, 20u}) expectSameTrace(crowd.c, crowd.rays, budget);
}

// A node of several children lets one entry wait for a level, for which there is room here; see below.
TEST_P(WalkTest, RaysThatRunOutOfStackLoseNothing) {
    const RayCase nested = nestedCase();
    Renderer renderer = rendererOf(nested.c);
    for (const RayHit& hit : renderer.trace(nested.rays, false)) EXPECT_EQ(hit.data.object, kNestedCount - 1);
    if (GetParam().stack == StackPlace::Shared && GetParam().traversal == Traversal::Lane) {
        EXPECT_GT(renderer.times().resumes, 0u) << "no ray ran out of stack: the test shows nothing";
    }
    expectSameTrace(nested.c, nested.rays);
}

// More levels at which something waits than a workgroup's stack has entries.
TEST_P(WalkTest, RaysThatRunOutOfLevelsLoseNothing) {
    const RayCase outward = outwardCase(130);
    if (GetParam().stack == StackPlace::Shared && GetParam().traversal == Traversal::Cwbvh) {
        Renderer renderer = rendererOf(outward.c);
        renderer.trace(outward.rays, false);
        EXPECT_GT(renderer.times().resumes, 0u) << "no ray ran out of stack: the test shows nothing";
    }
    expectSameTrace(outward.c, outward.rays);
}

TEST_P(WalkTest, TiesFromInsideGoToTheLowestId) {
    expectLowestId(concentricCase());
}

TEST_P(WalkTest, TiesGoToTheLowestId) {
    expectLowestId(tiedCase());
}

// Where children that a node of four has not would stand if they had boxes: in one corner of its grid.
std::vector<dvec3> cornersWithNoChild(const PackedScene& scene) {
    const std::vector<shared::WideRow> rows = wideTree(scene.nodes, NodeFormat::Four).rows;
    std::vector<dvec3> corners;
    for (size_t node = 0; node + shared::kFourRows <= rows.size(); node += shared::kFourRows) {
        if (rows[node + 3].w != shared::kNone) continue;
        const shared::WideRow& head = rows[node];
        const auto along = [&](uint32_t origin, uint32_t exponent) {
            return std::bit_cast<float>(origin) + std::ldexp(1.0, static_cast<int>(exponent & 0xff) - 127);
        };
        corners.emplace_back(along(head.x, head.w), along(head.y, head.w >> 8), along(head.z, head.w >> 16));
    }
    return corners;
}

TEST_P(WalkTest, ChildrenThatAreNotThereAreNotMet) {
    const RayCase crowd = crowdedCase(1000, 0, 37);
    const std::vector<dvec3> corners = cornersWithNoChild(crowd.c.packed);
    EXPECT_GT(corners.size(), 30u);
    Random random(37);
    std::vector<RayInput> rays;
    for (const dvec3& corner : corners)
        for (int i = 0; i < 20; ++i) rays.push_back(rayTowards(corner - random.box(2), corner));
    expectSameTrace(crowd.c, rays);
}

// Leaves that are the root, and none.
TEST_P(WalkTest, SmallestTrees) {
    for (const uint32_t triangles : {0u, 1u, 2u, 9u}) {
        const RayCase small = crowdedCase(triangles, 300, 19);
        expectSameTrace(small.c, small.rays);
    }
}

// Also with budgets that end within them.
TEST_P(WalkTest, FindsTheSameInInstances) {
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

TEST_P(WalkTest, VerifyPasses) {
    for (const char* name : {"knot", "showcase", "instances"}) {
        const Case c = fileCase(name, 64, 48);
        Renderer renderer = rendererOf(c);
        verify::Options verifying;
        verifying.width = c.width;
        verifying.height = c.height;
        const verify::Report report = verify::verify(renderer, c.packed, c.camera, verifying);
        EXPECT_EQ(report.unexplained, 0u) << name;
        EXPECT_TRUE(report.passed()) << name;
    }
}

// Light that passes dielectrics loses a sum over their surfaces, in the order that they are met.
void allowOrderOfSums(const Case& c, Picture& a, const Picture& b) {
    if (!c.packed.features.coloredShadows) return;
    ASSERT_EQ(a.color.pixels.size(), b.color.pixels.size());
    for (size_t i = 0; i < a.color.pixels.size(); ++i) {
        const float x = a.color.pixels[i], y = b.color.pixels[i];
        ASSERT_LE(std::abs(x - y), 1e-5f * std::max(1.0f, std::abs(y)));
    }
    a.color.pixels = b.color.pixels;
}

class WalkSceneTest : public RenderTest, public testing::WithParamInterface<std::string> {
  protected:
    static void expectSamePicture(const Case& c, const std::vector<Options>& walks) {
        const Picture binary = draw(device(), c, with(kBinary));
        for (const Options& options : walks) {
            SCOPED_TRACE(static_cast<int>(options.traversal));
            Picture picture = draw(device(), c, options);
            allowOrderOfSums(c, picture, binary);
            EXPECT_TRUE(sameBits(picture, binary));
        }
    }
};

INSTANTIATE_TEST_SUITE_P(All, WalkSceneTest, testing::ValuesIn(sceneNames()),
                         [](const auto& p) { return p.param; });

TEST_P(WalkSceneTest, DrawsWhatTheBinaryTreeDraws) {
    expectSamePicture(fileCase(GetParam(), 80, 60), {with(kWalks[0]), with(kWalks[1])});
}

// Sizes that leave tiles part empty, storage buffers, and the stack that a workgroup shares. Scenes that
// differ in what is walked, not in how it is shaded: kernels of textures take a minute to compile for all
// these.
class WalkStackTest : public WalkSceneTest {};

INSTANTIATE_TEST_SUITE_P(All, WalkStackTest,
                         testing::Values("arcade", "discs", "far_away", "glass", "instances", "panes",
                                         "polygons", "quadrics", "showcase", "spheres"),
                         [](const auto& p) { return p.param; });

TEST_P(WalkStackTest, DrawsTheSameThroughStorageBuffersAndSharedStacks) {
    std::vector<Options> walks = {with(kWalks[2]), with(kWalks[3]), with(kWalks[4])};
    for (Options& options : walks) options.access = gpu::Access::StorageBuffer;
    expectSamePicture(fileCase(GetParam(), 33, 23), walks);
}

// ---- kernels with defects ----

class WalkMutantTest : public RenderTest {
  protected:
    static std::vector<RayHit> hitsOf(const RayCase& rays, Traversal traversal, const KernelCode& code,
                                      uint64_t* resumes = nullptr, StackPlace stack = StackPlace::Private) {
        Options options;
        options.stack = stack;
        options.access = gpu::Access::TexelBuffer;
        options.traversal = traversal;
        options.kernels = &code;
        Renderer renderer(device(), rays.c.packed, options);
        std::vector<RayHit> hits = renderer.trace(rays.rays, false);
        if (resumes) *resumes = renderer.times().resumes;
        return hits;
    }
};

// A stack of six words, in either place: whoever needs more is started again, and loses nothing.
TEST_F(WalkMutantTest, SmallStack) {
    const RayCase crowd = crowdedCase(3000, 2000, 29);
    const std::vector<RayHit> expected = hitsOf(crowd, Traversal::Lane, embeddedKernels());
    for (const StackPlace stack : {StackPlace::Private, StackPlace::Shared}) {
        const KernelCode small = mutantKernels(stack == StackPlace::Private ? "small_stack" : "small_group");
        for (const Traversal traversal : {Traversal::Bvh4, Traversal::Cwbvh}) {
            uint64_t resumes = 0;
            const std::vector<RayHit> hits = hitsOf(crowd, traversal, small, &resumes, stack);
            EXPECT_GT(resumes, 0u) << "no ray ran out of stack: the test shows nothing";
            EXPECT_TRUE(sameBits(hits, expected, crowd.rays));
        }
    }
}

// Defects of each format are seen: what is compared above walks the nodes that it says.
TEST_F(WalkMutantTest, DefectsShow) {
    const RayCase crowd = crowdedCase(3000, 2000, 31);
    const KernelCode sound = embeddedKernels();
    const std::vector<RayHit> expected = hitsOf(crowd, Traversal::Lane, sound);
    const struct {
        const char* mutant;
        Traversal traversal;
    } defects[] = {{"wide_three", Traversal::Bvh4},   {"four_forgets", Traversal::Bvh4},
                   {"four_narrow", Traversal::Bvh4},  {"wide_turned", Traversal::Cwbvh},
                   {"wide_narrow", Traversal::Cwbvh}, {"wide_leaf_word", Traversal::Cwbvh}};
    for (const auto& defect : defects) {
        SCOPED_TRACE(defect.mutant);
        const KernelCode broken = mutantKernels(defect.mutant);
        EXPECT_TRUE(sameBits(hitsOf(crowd, Traversal::Lane, broken), expected, crowd.rays));
        EXPECT_FALSE(sameBits(hitsOf(crowd, defect.traversal, broken), expected, crowd.rays));
    }
}

}  // namespace
}  // namespace glint::render::test::walks_test
