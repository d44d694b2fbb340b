// What must not change a picture by a single bit: leaving features out, how arrays are read, how the picture
// is cut into slices and regions, who else has rendered before.
#include <algorithm>

#include "reference/render.h"
#include "support.h"

namespace glint::render::test::variants_test {
class VariantTest : public RenderTest, public testing::WithParamInterface<std::string> {
  protected:
    Case case_ = fileCase(GetParam(), 96, 72);
};

TEST_P(VariantTest, PrunedAndFullPipelineDrawTheSame) {
    EXPECT_TRUE(sameBits(draw(device(), case_), draw(device(), case_, {.leaveOut = false})));
}

TEST_P(VariantTest, BothAccessesDrawTheSame) {
    EXPECT_TRUE(sameBits(draw(device(), case_, {.access = gpu::Access::StorageBuffer}),
                         draw(device(), case_, {.access = gpu::Access::TexelBuffer})));
}

INSTANTIATE_TEST_SUITE_P(All, VariantTest, testing::ValuesIn(sceneNames()),
                         [](const auto& p) { return p.param; });

class PictureTest : public RenderTest {};

TEST_F(PictureTest, SlicesAndRepetitionDrawTheSame) {
    const Case c = fileCase("showcase", 96, 72);
    Renderer renderer(device(), c.packed);
    const Picture picture = draw(renderer, c);
    EXPECT_TRUE(sameBits(picture, draw(renderer, c))) << "second picture of the same renderer";
    Renderer sliced(device(), c.packed, {.maxSlicePixels = 1024});
    EXPECT_TRUE(sameBits(picture, draw(sliced, c)));
    EXPECT_GT(sliced.times().slices, 5u);  // 108 tiles of 64 pixels
}

TEST_F(PictureTest, OddSizesAgreeWithTheReference) {
    for (const glm::ivec2 size : {glm::ivec2(1, 1), glm::ivec2(7, 5), glm::ivec2(65, 63)}) {
        const Case c = fileCase("spheres", size.x, size.y);
        const Picture picture = draw(device(), c);
        ASSERT_TRUE(picture.complete);
        ASSERT_EQ(picture.data.size(), static_cast<size_t>(size.x) * size.y);
        EXPECT_EQ(std::count(picture.done.begin(), picture.done.end(), 1), size.x * size.y);
        const Picture expected = reference::render(c.packed, c.camera, wholeWithData(c));
        int differing = 0;
        for (int y = 0; y < size.y; ++y) {
            for (int x = 0; x < size.x; ++x)
                differing += picture.at(x, y).pathHash != expected.at(x, y).pathHash;
        }
        EXPECT_LE(differing, size.x * size.y / 200) << size.x << "x" << size.y;
    }
}

TEST_F(PictureTest, RegionsAreCutFromTheWholePicture) {
    const Case c = fileCase("lights", 65, 63);
    Renderer renderer(device(), c.packed);
    const Picture whole = draw(renderer, c);
    for (const Region region :
         {Region{0, 0, 8, 8}, Region{13, 11, 14, 12}, Region{5, 7, 62, 29}, Region{64, 0, 65, 63}}) {
        auto settings = sized<Request>(c);
        settings.region = region;
        settings.data = true;
        const Picture part = renderer.render(c.camera, settings);
        Picture cut;
        cut.region = region;
        cut.color = Image(region.width(), region.height(), 4);
        cut.done.assign(static_cast<size_t>(region.width()) * region.height(), 1);
        for (int y = region.y0; y < region.y1; ++y) {
            for (int x = region.x0; x < region.x1; ++x) {
                for (int i = 0; i < 4; ++i)
                    cut.color.at(x - region.x0, y - region.y0, i) = whole.color.at(x, y, i);
                cut.data.push_back(whole.at(x, y));
            }
        }
        EXPECT_TRUE(sameBits(part, cut)) << region.x0 << "," << region.y0;
    }
}

TEST_F(PictureTest, CostIsCountedAndChangesNothing) {
    const Case c = fileCase("knot", 64, 48);
    auto settings = sized<Request>(c);
    settings.cost = true;
    Renderer renderer(device(), c.packed);
    Picture counted = renderer.render(c.camera, settings);
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
    Picture part = renderer.render(c.camera, settings);
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
    EXPECT_TRUE(sameBits(renderer.render(c.camera, settings), whole));
    EXPECT_EQ(progress, 1.0);
}

}  // namespace glint::render::test::variants_test
