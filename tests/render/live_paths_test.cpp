// Kernels over the list of live paths: the rule, the saving, and equal bits.
#include "render/path_state.h"

#include "render/path_limits.h"
#include "support.h"

namespace glint::render::test::live_paths_test {
TEST(PathRowsTest, ScenesWithoutBouncesHaveNoLists) {
    SceneFeatures plain, mirrors, glass;
    mirrors.mirrors = true;
    glass.transmission = true;
    EXPECT_EQ(pathRows(plain, {}, {}), shared::kPathRows);
    EXPECT_EQ(pathRows(mirrors, {}, {}), shared::kPathRows + shared::kListRows);
    EXPECT_EQ(firstTreeRow(glass, {}), shared::kPathRows + shared::kListRows);
}

// Kernels are first run over these, and lanes follow their numbers: none may be left from earlier contents of
// the memory.
TEST_F(RenderTest, EndedPathsHaveNoNumberToFollow) {
    constexpr uint32_t kRows = shared::kPathRows + 6, kGroup = shared::kWorkgroupSize;
    const PathState state(device(), gpu::Access::TexelBuffer, 100, kRows);
    RowEntry garbage;
    std::fill_n(garbage.u, 4, 0x05050505u);
    for (uint32_t row = 0; row < kRows; ++row) state.writeRow(row, std::vector<RowEntry>(100, garbage));
    state.writeEnded();
    const std::vector<RowEntry> found = state.readRow(0, kRows * kGroup);
    for (uint32_t row = 0; row < kRows; ++row) {
        for (uint32_t path = 0; path < kGroup; ++path) {
            const RowEntry& entry = found[row * kGroup + path];
            for (uint32_t word = 0; word < 4; ++word) {
                if (row == shared::kRowDirection && word == 3)
                    EXPECT_EQ(entry.f[word], shared::kInfinity) << path;
                else
                    EXPECT_EQ(entry.u[word], row == shared::kRowHit && word == 3 ? shared::kNone : 0u)
                        << row << ' ' << path;
            }
        }
    }
}

// ---- the same bits ----

Request settingsOf(const Case& c) {
    auto settings = sized<Request>(c);
    settings.data = settings.cost = settings.ledger = settings.tally = true;
    return settings;
}

class LivePathsImageTest : public RenderTest {
  protected:
    // With a kernel for each step: whole.comp keeps no lists.
    static Drawn drawn(const Case& c, const Request& settings, const Options& options = {}) {
        return RenderTest::drawn(c, settings, WholePaths::Off, options);
    }
};

// Rays that are finished by resume dispatches, over lists and over packets that were given up.
TEST_F(LivePathsImageTest, UnfinishedRaysOfListedPathsAreResumed) {
    for (const char* name : {"glass", "instances", "showcase", "quadrics", "textures"}) {
        const Case c = fileCase(name, 24, 16);
        const Picture expected = drawn(c, settingsOf(c)).picture;
        for (const bool data : {true, false}) {
            Request settings = settingsOf(c);
            settings.data = settings.cost = settings.ledger = data;
            for (const uint32_t budget : {1u, 6u}) {
                const Drawn listed = drawn(c, settings, {.tripBudget = budget});
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

TEST_F(LivePathsImageTest, SlicesOfRegionsDrawTheSame) {
    const Case c = fileCase("showcase", 65, 63);
    Request settings = settingsOf(c);
    settings.region = {3, 5, 61, 44};
    const Drawn one = drawn(c, settings), many = drawn(c, settings, {.maxSlicePixels = 512});
    EXPECT_GT(many.times.slices, 2u);
    EXPECT_TRUE(sameBits(many.picture, one.picture));
    EXPECT_TRUE(sameLosses(many.picture, one.picture));
    EXPECT_EQ(many.times.pathRays, one.times.pathRays);
    EXPECT_EQ(many.rays.shadow, one.rays.shadow);
    EXPECT_EQ(many.rays.mirrored, one.rays.mirrored);
}

// Branches that bring too little end, so fewer paths go on; the account of them must not change.
TEST_F(LivePathsImageTest, LeastContributionsAreAccountedForTheSame) {
    for (const char* name : {"corridor", "glass"}) {
        const Case c = fileCase(name, 32, 24);
        Request settings = settingsOf(c);
        settings.limits.minContribution = 0.5;
        settings.data = settings.cost = settings.tally = false;
        const Drawn listed = drawn(c, settings), whole = RenderTest::drawn(c, settings, WholePaths::On);
        EXPECT_GT(listed.picture.losses.cut.count, 0u) << name;
        EXPECT_GT(whole.times.kernels.whole, 0) << name;
        EXPECT_TRUE(sameBits(listed.picture, whole.picture)) << name;
        EXPECT_TRUE(sameLosses(listed.picture, whole.picture)) << name;
        EXPECT_EQ(listed.times.pathRays, whole.times.pathRays) << name;
    }
}

// Rays by class are traced in dispatches of their own, over one list.
TEST_F(LivePathsImageTest, RaysCountedByClassDrawTheSame) {
    for (const char* name : {"glass", "inside_glass"}) {
        const Case c = fileCase(name, 32, 24);
        Request settings = settingsOf(c);
        const Drawn counted = drawn(c, settings);
        EXPECT_GT(counted.rays.refracted, 0u) << name;
        settings.tally = false;
        EXPECT_TRUE(sameBits(drawn(c, settings).picture, counted.picture)) << name;
    }
}

// ---- the saving ----

// A parallel camera with pixels of size 1 looks along -z at a mirror that covers the left column of 64 x 64
// pixels. The mirror shows a second mirror behind the camera, which shows the first one, and so on. The
// column's 64 paths, one from each of 8 rows of 8 tiles, fill one workgroup.
TEST_F(LivePathsImageTest, ScatteredPathsShareAWorkgroup) {
    constexpr uint32_t kDepth = 3, kAll = 64 * 64;
    Scene scene = emptyScene();
    const uint32_t mirror = addMaterial(scene, Color(0.1), Color(0.5));
    for (const double z : {0.0, 10.0}) {
        addTriangle(scene, {-40, -40, z}, {-31, -40, z}, {-31, 40, z}, mirror);
        addTriangle(scene, {-40, -40, z}, {-31, 40, z}, {-40, 40, z}, mirror);
    }
    scene.maxDepth = kDepth;
    scene.camera.projection = Projection::Orthographic;
    aim(scene.camera, {0, 0, 5}, {0, 0, 0}, {0, 1, 0});
    scene.camera.height = 64;
    const Case c = makeCase(scene, 64, 64);
    const Drawn found = drawn(c, settingsOf(c));
    EXPECT_EQ(found.times.pathRays, kAll + kDepth * 64);
    EXPECT_EQ(found.times.invocations, kAll + kDepth * 64);
}

}  // namespace glint::render::test::live_paths_test
