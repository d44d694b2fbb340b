// `glint render --part` and `glint merge`, on a device.
#include "support.h"

namespace glint::app::test::gpu_part_test {
using GpuPart = FolderTest;

// Packets too, whose rays are counted together: parts begin where tiles do.
TEST_F(GpuPart, EveryLayerHasTheBitsOfOneRun) {
    writeSmallScene("a.json");
    const std::string layers =
        "color,alpha,depth,position,normal,uv,object,primitive,material,bounces,cost,samples";
    expectPartsAreTheWhole("a.json", {"--aov", layers, "--traversal", hasPackets() ? "packet" : "lane"}, 3);
    expectPartsAreTheWhole("a.json", "--spp 5 --sampler jittered --adaptive 20,0.05 --aov " + layers, 4);
}

TEST_F(GpuPart, GlassAndInstances) {
    for (const char* scene : {"scenes/glass.json", "scenes/instances.json", "scenes/lens.json"})
        expectPartsAreTheWhole(glint::test::sourcePath(scene), "--size 80x60", 3);
}

// Frames keep kernels, arrays and trees of the frames before them, and have the bits of their moments alone.
TEST_F(GpuPart, FramesHaveTheBitsOfTheirMoments) {
    const std::string scene = glint::test::sourcePath("scenes/turntable.json");
    const Words size = "--size 48x30 -q";
    ASSERT_EQ(runGlint({"render", scene, "--frames", "0:47", "--fps", "24", "-o", "f.##.pfm"}, size).code, 0);
    // At multiples of 1/8 s, which the six digits of to_string hold.
    for (const int frame : {0, 9, 30, 45}) {
        ASSERT_EQ(
            runGlint({"render", scene, "-o", "one.pfm", "--time", std::to_string(frame / 24.0)}, size).code,
            0);
        const std::string name = std::string("f.") + (frame < 10 ? "0" : "") + std::to_string(frame) + ".pfm";
        EXPECT_EQ(readBytes("one.pfm"), readBytes(name)) << frame;
    }
}

}  // namespace glint::app::test::gpu_part_test
