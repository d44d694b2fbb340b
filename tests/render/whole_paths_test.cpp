// Pictures that one kernel draws: where, and that they have the bits of those drawn step by step, also where
// a path does not finish.
#include "render/kernel_choice.h"

#include "pack/pack_samples.h"
#include "pack/request_environment.h"
#include "render/path_limits.h"
#include "scene/transform.h"
#include "support.h"

namespace glint::render::test::whole_paths_test {
// ---- the rule ----

TEST(WholePathsRuleTest, RaysOfAPathAreOneAndOneToEachLightForEachHit) {
    SceneFeatures plain, mirrors;
    mirrors.mirrors = true;
    shared::Environment environment{};
    environment.maxDepth = 5;
    environment.lightCount = 3;
    EXPECT_EQ(mostRaysOfPath(plain, environment), 4u);
    EXPECT_EQ(mostRaysOfPath(mirrors, environment), 6u * 4u);
    // The loop of the lights is entered once where there are none.
    environment.lightCount = 0;
    EXPECT_EQ(mostRaysOfPath(plain, environment), 2u);
}

// Each ray may split, but few trees are as wide as that.
TEST(WholePathsRuleTest, TreesAreFollowedUpToALimit) {
    SceneFeatures glass;
    glass.transmission = true;
    shared::Environment environment{};
    EXPECT_EQ(mostRaysAfterFirst(glass, environment), 0u);
    environment.maxDepth = 2;
    EXPECT_EQ(mostRaysAfterFirst(glass, environment), 6u);
    for (const uint32_t depth : {7u, 40u, 1000u}) {
        environment.maxDepth = depth;
        EXPECT_EQ(mostRaysAfterFirst(glass, environment), 200u);
    }
}

TEST(WholePathsRuleTest, DataTakeAKernelForEachStep) {
    EXPECT_TRUE(wholePathsSupport({}));
    EXPECT_TRUE(wholePathsSupport({.ledger = true, .scattered = true, .adaptive = true}));
    EXPECT_FALSE(wholePathsSupport({.aovs = true}));
    EXPECT_FALSE(wholePathsSupport({.cost = true}));
    EXPECT_FALSE(wholePathsSupport({.tally = true}));
    EXPECT_FALSE(wholePathsSupport({.methods = {.triangles = TriangleMethod::Planar3d}}));
    EXPECT_FALSE(wholePathsSupport({.methods = {.spheres = SphereMethod::Algebraic}}));
    EXPECT_TRUE(wholePathsSupport({.methods = {.slabs = SlabPad::None}}));
}

TEST(WholePathsRuleTest, PacketsKeepPicturesOfManyRaysWithoutFurtherOnes) {
    gpu::DeviceInfo device;
    device.llvmpipe = true;
    const TraversalChoice lanes = {false, ""}, packets = {true, ""};
    for (const uint64_t rays : {uint64_t{0}, uint64_t{1} << 30}) {
        EXPECT_TRUE(wholePathsPay(device, lanes, {false, 3000, rays}));
        EXPECT_FALSE(wholePathsPay(device, packets, {false, 3000, rays}));
        EXPECT_TRUE(wholePathsPay(device, packets, {true, 3000, rays}));
    }
    EXPECT_TRUE(wholePathsPay(device, packets, {false, 3000, 1000})) << "too few for three kernels more";
    EXPECT_FALSE(wholePathsPay(device, lanes, {true, 100, 1000})) << "too few trips";
    device.llvmpipe = false;
    EXPECT_FALSE(wholePathsPay(device, lanes, {true, 3000, 1000}));
}

// The more rays may come, the fewer trips are left: what no lane counts is more.
TEST(WholePathsRuleTest, BudgetsShrinkWithTheRaysOfAPath) {
    gpu::DeviceInfo device;
    device.llvmpipe = true;
    device.limits.subgroupSize = 8;
    SceneFeatures mirrors;
    mirrors.mirrors = mirrors.triangles = true;
    shared::Environment environment{};
    environment.lightCount = environment.planeCount = 1;
    uint32_t before = UINT32_MAX;
    for (const uint32_t depth : {0u, 10u, 100u, 1000u}) {
        environment.maxDepth = depth;
        const uint32_t budget = wholeTripBudget(device, mirrors, 0, environment);
        EXPECT_LT(budget, before);
        before = budget;
    }
    environment.lightCount = 1000;
    EXPECT_EQ(wholeTripBudget(device, mirrors, 0, environment), 1u);
}

// ---- the same bits ----

class WholePathsTest : public RenderTest {
  protected:
    static Request requestOf(const Case& c) {
        auto request = sized<Request>(c);
        request.ledger = true;
        return request;
    }
    static void expectSame(const Case& c, const Request& request, const Options& options = {}) {
        const Drawn off = drawn(c, request, WholePaths::Off, options);
        const Drawn on = drawn(c, request, WholePaths::On, options);
        EXPECT_FALSE(off.whole());
        EXPECT_TRUE(on.whole());
        EXPECT_FALSE(on.stepByStep());
        expectEqual(on, off);
    }
    static void expectEqual(const Drawn& a, const Drawn& b) {
        EXPECT_TRUE(sameBits(a.picture, b.picture));
        EXPECT_TRUE(sameLosses(a.picture, b.picture));
        EXPECT_EQ(a.picture.samples, b.picture.samples);
        EXPECT_EQ(a.times.pathRays, b.times.pathRays);
    }
    // One kernel that does not finish, and then step by step.
    static void expectDrawnAgain(const Case& c, const Request& request, const Options& options = {}) {
        const Drawn again = drawn(c, request, WholePaths::On, options);
        EXPECT_TRUE(again.whole());
        EXPECT_TRUE(again.stepByStep());
        expectEqual(again, drawn(c, request, WholePaths::Off));
    }
};

class WholePathsSceneTest : public WholePathsTest, public testing::WithParamInterface<std::string> {};

TEST_P(WholePathsSceneTest, DrawsTheSame) {
    const Case c = fileCase(GetParam(), 45, 29);
    expectSame(c, requestOf(c));
}

INSTANTIATE_TEST_SUITE_P(All, WholePathsSceneTest, testing::ValuesIn(sceneNames()), sceneName);

TEST_F(WholePathsTest, OtherWaysToReadArraysDrawTheSame) {
    for (const char* name : {"showcase", "textures"}) {
        const Case c = fileCase(name, 24, 16);
        expectSame(c, requestOf(c), {.access = gpu::Access::StorageBuffer});
    }
}

TEST_F(WholePathsTest, SamplesOfAllKindsDrawTheSame) {
    for (const char* name : {"glass", "lens"}) {
        const Case c = fileCase(name, 24, 16);
        Request request = requestOf(c);
        request.samples = PackedSamples::fixed({{0.25, 0.25}, {0.75, 0.25}, {0.25, 0.75}, {0.75, 0.75}});
        expectSame(c, request);
        for (const bool adaptive : {false, true}) {
            ImageSettings image = {.samplesPerPixel = 4, .sampler = Sampler::LowDiscrepancy};
            if (adaptive) image.adaptive = AdaptiveSampling{12, 0.05};
            request.samples = packSamples(image, c.camera);
            expectSame(c, request);
        }
    }
}

TEST_F(WholePathsTest, WithoutShadowsOrLightsDrawsTheSame) {
    const Case c = fileCase("lights", 45, 29);
    Request request = requestOf(c);
    request.shadows = false;
    expectSame(c, request);
    request.shadows = true;
    request.lighting = Lighting{.lights = {c.packed.lights.front()}};
    expectSame(c, request);
    request.lighting->lights.clear();
    expectSame(c, request);
}

// Packets take three kernels more, which a few rays do not pay.
TEST_F(WholePathsTest, FewRaysTakeOneKernelInsteadOfPackets) {
    const Case c = fileCase("knot", 40, 30);
    const Request request = requestOf(c);
    const Options few = {.cameraRays = cameraRaysOf(request)};
    EXPECT_EQ(few.cameraRays, 1200u);
    const Drawn once = drawn(c, request, WholePaths::Auto, few), often = drawn(c, request, WholePaths::Auto);
    const bool knowsOne = device().info().llvmpipe;
    EXPECT_EQ(once.whole(), knowsOne);
    EXPECT_EQ(once.stepByStep(), !knowsOne);
    EXPECT_TRUE(often.stepByStep());
    EXPECT_FALSE(often.whole());
    EXPECT_TRUE(sameBits(once.picture, often.picture));
}

// A shadow ray that has ended in an instance leaves nothing of it to the next ray. A mirror shows a plane,
// the lower id, and in the same place an instance of a sheet; another one stands before the light. The sheet
// is moved by whole numbers across the rays, so that most of them find both at the same t. (The mirror is
// matt, too: where a light would add nothing no ray goes to it.)
TEST_F(WholePathsTest, AfterAShadowInAnInstanceTheWorldsIdsAreItsOwn) {
    Scene scene = emptyScene();
    const uint32_t mirror = addMaterial(scene, Color(0.25), Color(1)),
                   red = addMaterial(scene, Color(1, 0, 0)), blue = addMaterial(scene, Color(0, 0, 1));
    addPlane(scene, {0, 0, 8}, {0, 0, -1}, red);
    addTriangle(scene, {-100, -100, 0}, {300, -100, 0}, {-100, 300, 0}, mirror);
    const MeshShape sheet{glint::test::gridMesh(48, {-64, 0, 8})};
    scene.objects.push_back({"", sheet, blue, translation({64, 0, 0})});
    scene.objects.push_back({"", sheet, blue, translation({128, 0, -4})});
    scene.ambient = Color(1);
    scene.maxDepth = 1;
    scene.lights.push_back(PointLight{{150, 24, 7.5}, Color(1)});
    scene.camera.projection = Projection::Orthographic;
    aim(scene.camera, {24.25, 24.125, 5}, {24.25, 24.125, 0});
    scene.camera.height = 8;
    const Case c = makeCase(scene, 8, 8);
    ASSERT_EQ(c.packed.instances.size(), 2u);
    expectSame(c, requestOf(c));
    const Picture picture = drawn(c, requestOf(c), WholePaths::On).picture;
    int planes = 0;
    for (int i = 0; i < 64; ++i) planes += picture.color.at(i % 8, i / 8, 0) > 0.5f;
    EXPECT_GT(planes, 32);
}

// ---- where a path does not finish ----

// A picture whose paths have too few trips is drawn again from the first sample on, step by step.
TEST_F(WholePathsTest, PathsWithoutTripsAreDrawnStepByStep) {
    for (const char* name : {"triangles", "corridor", "glass", "instances"}) {
        const Case c = fileCase(name, 24, 16);
        Request request = requestOf(c);
        request.samples = PackedSamples::fixed({{0.25, 0.75}, {0.75, 0.25}});
        for (const uint32_t budget : {1u, 6u}) {
            SCOPED_TRACE(name + std::string(", budget ") + std::to_string(budget));
            expectDrawnAgain(c, request, {.tripBudget = budget});
        }
    }
}

// Balls at the lower edge of the sky: the slices before them finish, theirs does not.
TEST_F(WholePathsTest, ASliceInTheMiddleOfThePictureIsDrawnAgain) {
    Scene scene = emptyScene();
    const uint32_t mirror = addMaterial(scene, Color(0.4), Color(0.5));
    for (int i = 0; i < 40; ++i) addSphere(scene, {0.1 * i - 2.0, -1.6, -5.0 - 0.1 * (i % 7)}, 0.1, mirror);
    const Case c = makeCase(scene, 64, 64);
    Request request = requestOf(c);
    request.samples = PackedSamples::fixed({{0.25, 0.75}, {0.75, 0.25}, {0.5, 0.5}});
    double last = 0;
    request.progress = [&](double done) {
        EXPECT_GE(done, last) << "progress goes backwards";
        last = done;
    };
    const Drawn again = drawn(c, request, WholePaths::On, {.maxSlicePixels = 16 * 64, .tripBudget = 3});
    EXPECT_EQ(last, 1.0);
    last = 0;
    const Drawn expected = drawn(c, request, WholePaths::Off);
    EXPECT_TRUE(again.whole());
    EXPECT_TRUE(again.stepByStep());
    expectEqual(again, expected);
}

TEST_F(WholePathsTest, AdaptivePicturesAreDrawnAgainFromTheFirstSample) {
    const Case c = fileCase("corridor", 24, 16);
    ImageSettings image = {.samplesPerPixel = 4, .sampler = Sampler::LowDiscrepancy};
    image.adaptive = AdaptiveSampling{12, 0.05};
    Request request = requestOf(c);
    request.samples = packSamples(image, c.camera);
    expectDrawnAgain(c, request, {.tripBudget = 6});
}

// More branches than the kernel follows.
TEST_F(WholePathsTest, TreesWithTooManyBranchesAreDrawnStepByStep) {
    Case c = fileCase("glass", 24, 16);
    c.packed.environment.maxDepth = 12;
    expectDrawnAgain(c, requestOf(c));
}

TEST_F(WholePathsTest, CancelledPicturesAreIncomplete) {
    const Case c = fileCase("spheres", 64, 64);
    Request request = requestOf(c);
    request.cancelled = [] { return true; };
    EXPECT_FALSE(drawn(c, request, WholePaths::On).picture.complete);
}

}  // namespace glint::render::test::whole_paths_test
