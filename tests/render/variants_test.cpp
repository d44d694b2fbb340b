// Images keep every bit with any features left out, any access to arrays, any traversal and any number of
// threads.
#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "support.h"
#include "support/support.h"

namespace glint::render::test::variants_test {
class VariantTest : public RenderTest, public testing::WithParamInterface<std::string> {};

TEST_P(VariantTest, DrawsTheSame) {
    const Case c = fileCase(GetParam(), 96, 72);
    const Picture picture = draw(device(), c, {.traversal = Traversal::Lane});
    EXPECT_TRUE(sameBits(picture, draw(device(), c, {.leaveOut = false})));
    EXPECT_TRUE(sameBits(picture, draw(device(), c, {.access = gpu::Access::StorageBuffer})));
    EXPECT_TRUE(sameBits(picture, draw(device(), c, {.access = gpu::Access::TexelBuffer})));
    if (runsPackets(device().info())) {
        EXPECT_TRUE(sameBits(picture, draw(device(), c, {.traversal = Traversal::Packet})));
    }
}

INSTANTIATE_TEST_SUITE_P(All, VariantTest, testing::ValuesIn(sceneNames()), sceneName);

class PictureTest : public RenderTest {};

TEST_F(PictureTest, CostIsCountedAndChangesNothing) {
    const Case c = fileCase("knot", 64, 48);
    auto settings = sized<Request>(c);
    settings.cost = true;
    Renderer renderer(device(), c.packed);
    Picture counted = renderer.render(settings);
    uint64_t sum = 0;
    for (PixelData& data : counted.data) {
        sum += data.cost;
        EXPECT_GE(data.cost, 2u);  // the two boxes of the root
        data.cost = 0;
    }
    EXPECT_LT(sum, counted.data.size() * c.packed.triangles.size());  // else the tree would be of no use
    EXPECT_TRUE(sameBits(counted, draw(renderer, c)));
}

TEST_F(PictureTest, CancelledRenderKeepsFinishedSlices) {
    const Case c = fileCase("triangles", 160, 120);
    Renderer renderer(device(), c.packed, {.maxSlicePixels = 1024});
    const Picture whole = draw(renderer, c);
    auto settings = sized<Request>(c);
    settings.data = true;
    double progress = 0;
    settings.progress = [&](double fraction) {
        EXPECT_GE(fraction, progress);
        progress = fraction;
    };
    settings.cancelled = [&] { return progress > 0.5; };
    Picture part = renderer.render(settings);
    EXPECT_FALSE(part.complete);
    EXPECT_LT(progress, 1.0);
    const auto done = std::count(part.done.begin(), part.done.end(), 1);
    EXPECT_GE(done, 160 * 120 / 4);
    EXPECT_LT(done, 160 * 120);
    for (size_t i = 0; i < part.done.size(); ++i) {
        if (!part.done[i]) continue;
        for (size_t k = 4 * i; k < 4 * i + 4; ++k) ASSERT_EQ(part.color.pixels[k], whole.color.pixels[k]);
        ASSERT_EQ(part.data[i].pathHash, whole.data[i].pathHash);
    }
    settings.cancelled = nullptr;
    progress = 0;
    EXPECT_TRUE(sameBits(renderer.render(settings), whole));
    EXPECT_EQ(progress, 1.0);
}

// llvmpipe reads LP_NUM_THREADS once a process, so this runs the program itself.
TEST(Threads, PicturesDoNotDependOnTheirNumber) {
    const glint::test::TemporaryFolder folder;
    const auto renderedWith = [&](int threads, const std::string& scene) {
        const std::filesystem::path out = folder.path() / (scene + std::to_string(threads) + ".exr");
        std::ostringstream command;
        command << "LP_NUM_THREADS=" << threads << " \"" << GLINT_PROGRAM << "\" render \""
                << glint::test::sourcePath("scenes/" + scene + ".json")
                << "\" -q --size 96x72 --spp 2 --aov "
                   "color,alpha,depth,position,normal,uv,object,primitive,bounces -o "
                << out;
        EXPECT_EQ(std::system(command.str().c_str()), 0) << command.str();
        return glint::test::readBytes(out);
    };
    for (const std::string scene : {"spheres", "triangles", "knot"}) {
        const std::vector<uint8_t> one = renderedWith(1, scene);
        EXPECT_GT(one.size(), 1000u) << scene;
        EXPECT_TRUE(one == renderedWith(8, scene)) << scene;
    }
}

}  // namespace glint::render::test::variants_test
