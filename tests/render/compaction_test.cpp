// Kernels that run over the list of paths that go on: the rule, what it saves, and that the picture stays the
// same to the bit.
#include <algorithm>

#include "pack/pack_samples.h"
#include "render/live_paths.h"
#include "render/path_limits.h"
#include "support.h"

namespace glint::render::test::compaction_test {
namespace {

// ---- the rule ----

shared::Dispatch told(const LivePaths& live) {
    shared::Dispatch dispatch;
    live.writeTo(dispatch);
    return dispatch;
}

TEST(LivePathsTest, AllPathsOfTheSliceAtFirst) {
    const LivePaths live(Compaction::On, 640);
    EXPECT_EQ(live.groups(), 10u);
    EXPECT_EQ(told(live).listed, 0u);
}

TEST(LivePathsTest, AutoGoesByTheListOnceAPathHasEnded) {
    LivePaths live(Compaction::Auto, 640);
    live.bounced(640);
    EXPECT_EQ(told(live).listed, 0u) << "no path has ended";
    EXPECT_EQ(live.groups(), 10u);
    live.bounced(639);
    EXPECT_EQ(told(live).listed, 639u);
    EXPECT_EQ(live.groups(), 10u);
    live.bounced(129);
    EXPECT_EQ(told(live).listed, 129u);
    EXPECT_EQ(live.groups(), 3u);
}

TEST(LivePathsTest, OnGoesByTheListThoughNoPathHasEnded) {
    LivePaths live(Compaction::On, 64);
    live.bounced(64);
    EXPECT_EQ(told(live).listed, 64u);
    EXPECT_EQ(live.groups(), 1u);
}

TEST(LivePathsTest, OffNever) {
    LivePaths live(Compaction::Off, 640);
    live.bounced(1);
    EXPECT_EQ(told(live).listed, 0u);
    EXPECT_EQ(live.groups(), 10u);
}

// The list that a bounce wrote (the one that is not read) is read until another one is taken up.
TEST(LivePathsTest, AListIsReadUntilAnotherIsTakenUp) {
    LivePaths live(Compaction::Auto, 640);
    const uint32_t first = told(live).listRead ^ 1u;
    live.bounced(100);
    EXPECT_EQ(told(live).listRead, first);
    live.bounced(100);
    EXPECT_EQ(told(live).listRead, first) << "as many go on as before: the list at hand holds them";
    EXPECT_EQ(told(live).listed, 100u);
    live.bounced(99);
    EXPECT_NE(told(live).listRead, first);
}

TEST(PathRowsTest, ScenesWithoutBouncesHaveNoLists) {
    SceneFeatures plain, mirrors, glass;
    mirrors.mirrors = true;
    glass.transmission = true;
    EXPECT_EQ(pathRows(plain, {}, 5), shared::kPathRows);
    EXPECT_EQ(pathRows(mirrors, {}, 5), shared::kPathRows + shared::kListRows);
    EXPECT_EQ(firstTreeRow(glass, {}), shared::kPathRows + shared::kListRows);
}

// ---- the same bits ----

Request settingsOf(const Case& c) {
    Request settings;
    settings.width = c.width;
    settings.height = c.height;
    settings.data = settings.cost = settings.ledger = settings.tally = true;
    return settings;
}

class CompactionTest : public RenderTest {
  protected:
    struct Drawn {
        Picture picture;
        StageTimes times;
        RayCounts rays;
    };
    static Drawn drawn(const Case& c, const Request& settings, Compaction compaction, Options options = {}) {
        options.compaction = compaction;
        Renderer renderer(device(), c.packed, options);
        Drawn result;
        result.picture = renderer.render(c.camera, settings);
        result.times = renderer.times();
        result.rays = renderer.rays();
        return result;
    }
    static void expectSame(const Case& c, const Request& settings, const Options& options = {},
                           const std::vector<Compaction>& others = {Compaction::On}) {
        const Drawn off = drawn(c, settings, Compaction::Off, options);
        for (const Compaction compaction : others) {
            const Drawn other = drawn(c, settings, compaction, options);
            EXPECT_TRUE(sameBits(other.picture, off.picture));
            EXPECT_TRUE(sameLosses(other.picture, off.picture));
            EXPECT_EQ(other.picture.samples, off.picture.samples);
            EXPECT_EQ(other.times.pathRays, off.times.pathRays);
            EXPECT_EQ(other.rays.shadow, off.rays.shadow);
            EXPECT_EQ(other.rays.mirrored, off.rays.mirrored);
            EXPECT_EQ(other.rays.refracted, off.rays.refracted);
            EXPECT_LE(other.times.invocations, off.times.invocations);
        }
    }
};

class CompactionSceneTest : public CompactionTest, public testing::WithParamInterface<std::string> {};

// With every layer, the cost, and the account of what is not followed. 45 x 29 leaves tiles part empty.
TEST_P(CompactionSceneTest, DrawsTheSame) {
    const Case c = fileCase(GetParam(), 45, 29);
    expectSame(c, settingsOf(c), {}, {Compaction::On, Compaction::Auto});
}

// As a picture without data: fewer rows are read and written.
TEST_P(CompactionSceneTest, DrawsTheSameColoursWithoutData) {
    const Case c = fileCase(GetParam(), 45, 29);
    Request settings = settingsOf(c);
    const Picture withData = drawn(c, settings, Compaction::On).picture;
    settings.data = settings.cost = settings.ledger = false;
    for (const Compaction compaction : {Compaction::Off, Compaction::On})
        EXPECT_EQ(drawn(c, settings, compaction).picture.color.pixels, withData.color.pixels);
}

INSTANTIATE_TEST_SUITE_P(All, CompactionSceneTest, testing::ValuesIn(sceneNames()),
                         [](const auto& p) { return p.param; });

// Scenes that differ in the rows of their paths, not in how they are shaded.
class CompactionStorageTest : public CompactionSceneTest {};

INSTANTIATE_TEST_SUITE_P(All, CompactionStorageTest,
                         testing::Values("corridor", "glass", "instances", "showcase", "spheres"),
                         [](const auto& p) { return p.param; });

TEST_P(CompactionStorageTest, DrawsTheSameThroughStorageBuffers) {
    const Case c = fileCase(GetParam(), 24, 16);
    Options storage;
    storage.access = gpu::Access::StorageBuffer;
    expectSame(c, settingsOf(c), storage);
}

// Rays that are finished by resume dispatches, over lists and over packets that were given up.
TEST_F(CompactionTest, UnfinishedRaysOfListedPathsAreResumed) {
    for (const char* name : {"triangles", "glass", "instances", "orthographic", "showcase", "quadrics"}) {
        const Case c = fileCase(name, 24, 16);
        const Picture expected = drawn(c, settingsOf(c), Compaction::Off).picture;
        for (const bool data : {true, false}) {
            Request settings = settingsOf(c);
            settings.data = settings.cost = settings.ledger = data;
            for (const uint32_t budget : {1u, 6u}) {
                Options tight;
                tight.tripBudget = budget;
                const Drawn listed = drawn(c, settings, Compaction::On, tight);
                EXPECT_EQ(listed.picture.color.pixels, expected.color.pixels)
                    << name << ", budget " << budget;
                EXPECT_GT(listed.times.resumes, 0u) << name;
                if (!data) continue;
                // Boxes that a resumed ray passes on its way back are counted again.
                Picture picture = listed.picture, plain = expected;
                for (PixelData& pixel : picture.data) pixel.cost = 0;
                for (PixelData& pixel : plain.data) pixel.cost = 0;
                EXPECT_TRUE(sameBits(picture, plain)) << name << ", budget " << budget;
                EXPECT_TRUE(sameLosses(picture, plain)) << name << ", budget " << budget;
            }
        }
    }
}

TEST_F(CompactionTest, SlicesAndRegionsDrawTheSame) {
    const Case c = fileCase("spheres", 65, 63);
    Request settings = settingsOf(c);
    settings.region = {3, 5, 61, 44};
    Options sliced;
    sliced.maxSlicePixels = 512;
    expectSame(c, settings);
    expectSame(c, settings, sliced);
    EXPECT_TRUE(sameBits(drawn(c, settings, Compaction::On).picture,
                         drawn(c, settings, Compaction::On, sliced).picture));
}

TEST_F(CompactionTest, SamplesOfAllKindsDrawTheSame) {
    for (const char* name : {"corridor", "lens", "glass"}) {
        const Case c = fileCase(name, 24, 16);
        for (const bool adaptive : {false, true}) {
            ImageSettings image;
            image.sampler = Sampler::LowDiscrepancy;
            image.samplesPerPixel = 4;
            if (adaptive) image.adaptive = AdaptiveSampling{12, 0.05};
            Request settings = settingsOf(c);
            settings.samples = packSamples(image, c.scene.camera.lensRadius > 0);
            expectSame(c, settings);
        }
    }
}

// Branches that bring too little end, so fewer paths go on; the account of them must not change.
TEST_F(CompactionTest, LeastContributionsAreAccountedForTheSame) {
    for (const char* name : {"corridor", "glass"}) {
        const Case c = fileCase(name, 32, 24);
        Request settings = settingsOf(c);
        settings.minContribution = 0.5;
        const Drawn listed = drawn(c, settings, Compaction::On);
        EXPECT_GT(listed.picture.losses.cut.count, 0u) << name;
        expectSame(c, settings);
    }
}

// Rays by class are traced in dispatches of their own, over one list.
TEST_F(CompactionTest, RaysAreCountedTheSame) {
    for (const char* name : {"glass", "inside_glass"}) {
        const Case c = fileCase(name, 32, 24);
        Request settings = settingsOf(c);
        settings.tally = true;
        EXPECT_GT(drawn(c, settings, Compaction::On).rays.refracted, 0u) << name;
        expectSame(c, settings);
    }
}

// ---- what it saves ----

// A parallel camera, a pixel a unit, looks along -z at a mirror that covers the left `columns` of 64 x 64
// pixels; what it shows is another mirror behind the camera, which shows the first one, and so on.
Case mirrorsFor(int columns, uint32_t depth) {
    Scene scene = emptyScene();
    const uint32_t mirror = addMaterial(scene, Color(0.1), Color(0.5));
    const double right = -32 + columns, z[] = {0, 10};
    for (const double at : z) {
        addTriangle(scene, {-40, -40, at}, {right, -40, at}, {right, 40, at}, mirror);
        addTriangle(scene, {-40, -40, at}, {right, 40, at}, {-40, 40, at}, mirror);
    }
    scene.maxDepth = static_cast<int>(depth);
    scene.camera.projection = Projection::Orthographic;
    scene.camera.eye = {0, 0, 5};
    scene.camera.target = {0, 0, 0};
    scene.camera.up = {0, 1, 0};
    scene.camera.height = 64;
    return makeCase(scene, 64, 64);
}

// Eight columns of 64 pixels go on for `depth` rays: so many whole tiles, and nothing of the others.
TEST_F(CompactionTest, KernelsRunOverThePathsThatGoOn) {
    const uint32_t depth = 6, all = 64 * 64, mirrored = 8 * 64;
    const Case c = mirrorsFor(8, depth);
    Request settings = settingsOf(c);
    const Drawn off = drawn(c, settings, Compaction::Off), on = drawn(c, settings, Compaction::Auto);
    EXPECT_EQ(off.times.pathRays, all + depth * mirrored);
    EXPECT_EQ(off.times.invocations, (depth + 1) * all);
    EXPECT_EQ(on.times.invocations, all + depth * mirrored);
    EXPECT_TRUE(sameBits(on.picture, off.picture));
}

// One column: 64 paths, one from each of 8 rows of 8 tiles, which fill one workgroup.
TEST_F(CompactionTest, ScatteredPathsShareAWorkgroup) {
    const uint32_t depth = 3, all = 64 * 64;
    const Case c = mirrorsFor(1, depth);
    const Drawn on = drawn(c, settingsOf(c), Compaction::Auto);
    EXPECT_EQ(on.times.pathRays, all + depth * 64);
    EXPECT_EQ(on.times.invocations, all + depth * 64);
}

}  // namespace
}  // namespace glint::render::test::compaction_test
