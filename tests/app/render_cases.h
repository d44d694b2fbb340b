// Tests of `glint render` for both backends; render_test.cpp and gpu_render_test.cpp include them.
#pragma once

#include "core/image_io.h"
#include "support.h"

namespace glint::app::test::render_cases {
namespace {

class RenderEither : public SmallSceneTest, public ::testing::WithParamInterface<std::string> {
  protected:
    static void render(Words options) {
        const Ran ran = runGlint({"render", "a.json", "--backend", GetParam(), "-q"}, options);
        EXPECT_EQ(ran.code, 0);
        EXPECT_EQ(ran.out + ran.err, "");
    }
};

TEST_P(RenderEither, SameBytesOnEveryRun) {
    render("-o 1.png");
    render("-o 2.png");
    render("-o 1.exr --aov color,depth,cost --spp 3");
    render("-o 2.exr --aov color,depth,cost --spp 3");
    EXPECT_FALSE(readBytes("1.png").empty());
    EXPECT_EQ(readBytes("1.png"), readBytes("2.png"));
    EXPECT_EQ(readBytes("1.exr"), readBytes("2.exr"));
}

TEST_P(RenderEither, CropIsThePartOfTheWhole) {
    render("-o whole.pfm");
    render("-o part.pfm --crop 5,7,41,32");
    const Image whole = readImage("whole.pfm"), part = readImage("part.pfm");
    ASSERT_EQ(std::pair(part.width, part.height), std::pair(36, 25));
    int different = 0;
    for (int y = 0; y < part.height; ++y) {
        for (int x = 0; x < part.width; ++x) {
            for (int c = 0; c < 3; ++c) different += part.at(x, y, c) == whole.at(x + 5, y + 7, c) ? 0 : 1;
        }
    }
    EXPECT_EQ(different, 0);
}

// Wishes are in the request: an image has the bits of the image of a file that says the same, even if its own
// file has no reflections.
TEST_P(RenderEither, OptionsHaveTheBitsOfTheFile) {
    const std::string rest = R"("background": [0.2, 0.4, 0.6], "ambient": 0.2,
        "materials": {"m": {"diffuse": 0.2, "mirror": 0.7}},
        "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "m"},
                    {"type": "sphere", "center": [1.5, 0.5, 1], "radius": 0.7, "material": "m"}])";
    writeText("a.json", sceneText(16, 12, R"("maxDepth": 0, )" + rest));
    std::string text = sceneText(24, 18, R"("maxDepth": 3, )" + rest);
    text.replace(text.find("\"width\""), 0, R"("samplesPerPixel": 4, "sampler": "jittered", "seed": 9, )");
    writeText("b.json", text);
    const auto draw = [](Words args) {
        args.insert(args.begin(), "render");
        args.insert(args.end(), {"--backend", GetParam(), "-q"});
        const Ran ran = runGlint(args);
        EXPECT_EQ(ran.code, 0) << ran.err;
    };
    draw("b.json -o b.pfm");
    draw("a.json -o a.pfm --size 24x18 --max-depth 3 --spp 4 --sampler jittered --seed 9");
    EXPECT_EQ(readBytes("a.pfm"), readBytes("b.pfm"));
    draw("b.json -o c.pfm --max-depth 0");
    EXPECT_NE(readBytes("c.pfm"), readBytes("b.pfm"));
}

}  // namespace
}  // namespace glint::app::test::render_cases
