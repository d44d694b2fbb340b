// Files that `glint render` writes from a device.
#include <algorithm>
#include <cmath>

#include "core/image_io.h"
#include "support.h"

namespace glint::app::test::gpu_render_test {
using GpuRender = SmallSceneTest;

// The device takes the reference's samples in the same rounds; the images differ by rounding alone.
TEST_F(GpuRender, AnErrorIsReachedAsTheReferenceReachesIt) {
    const Words target = "--error 0.01 --within-depth --size 32x24 --aov color,samples";
    render(target + "-o device.pfm");
    render(target + "-o host.pfm --backend cpu");
    const Image a = readImage("device.pfm"), b = readImage("host.pfm");
    EXPECT_EQ(readBytes("device.samples.pfm"), readBytes("host.samples.pfm"));
    size_t differ = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i)
        differ += std::abs(a.pixels[i] - b.pixels[i]) > 1e-4f ? 1 : 0;
    EXPECT_LE(differ, a.pixels.size() / 100);  // samples at edges
    EXPECT_GT(readImage("device.samples.pfm").pixels[0], 1);
}

TEST_F(GpuRender, TraversalSaysItsNameAndChangesNoByte) {
    for (const std::string traversal : {"lane", "packet"}) {
        const Ran ran = runGlint({"render", "a.json", "--traversal", traversal, "--stats", "json", "-o",
                                  traversal + ".exr", "--aov", "color,depth,uv,primitive,bounces"});
        if (traversal == "packet" && !hasPackets()) {
            EXPECT_EQ(ran.code, 4);
            EXPECT_STARTS(ran.err, "glint: packets of rays need subgroups of 8 lanes");
            continue;
        }
        EXPECT_EQ(ran.code, 0) << ran.err;
        EXPECT_HAS(ran.out, "\"traversal\": \"" + traversal + "\"");
    }
    EXPECT_FALSE(readBytes("lane.exr").empty());
    if (hasPackets()) {
        EXPECT_EQ(readBytes("lane.exr"), readBytes("packet.exr"));
        EXPECT_EQ(jsonOf("render a.json --traversal packet --aov cost --stats json")["traversal"], "lane")
            << "packets do not count tests";
    }
}

TEST_F(GpuRender, DeviceThatDoesNotExist) {
    writeText("r.csv", "0,0,5,0,0,-1\n");
    for (const char* line :
         {"render a.json --device none", "render a.json --device 99", "render a.json --device -1",
          "trace a.json --rays r.csv --device none", "trace a.json --pixel 1,1 --device none"}) {
        const Ran ran = runGlint(line);
        EXPECT_EQ(ran.code, 4);
        EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
        EXPECT_STARTS(ran.err, "glint: no Vulkan device has ");
        EXPECT_HAS(ran.err, "; devices: 0 \"");
        EXPECT_EQ(ran.out, "");
    }
    EXPECT_EQ(names(), (std::set<std::string>{"a.json", "r.csv"}));
}

// Properties of lavapipe alone.
class Lavapipe : public GpuRender {};

TEST_F(Lavapipe, ByIndexAndName) {
    for (const char* selector : {"0", "llvmpipe", "LLVM"}) render({"--device", selector, "--size", "8x6"});
}

// One kernel for whole paths compiles sooner, packets trace faster: the command chooses by the number of
// rays. An image to a given error counts as one of many rays.
TEST_F(Lavapipe, PacketsAreForManyRays) {
    const auto walkOf = [](const Words& options) {
        const Words scene = {glint::test::sourcePath("scenes/knot.json")};
        return jsonOf("render -q --size 40x30 --stats json -o a.png" + scene + options)["traversal"];
    };
    EXPECT_EQ(walkOf({}), "lane");
    EXPECT_EQ(walkOf("--spp 1024"), "packet");
    EXPECT_EQ(walkOf("--error 0.5"), "packet");
}

TEST_F(Lavapipe, IsListedAsTheChosenOne) {
    const Ran ran = runGlint("devices");
    EXPECT_EQ(ran.code, 0);
    EXPECT_EQ(ran.err, "");
    EXPECT_STARTS(ran.out, "0  llvmpipe");
    EXPECT_HAS(ran.out, "\n   chosen: ");
    EXPECT_HAS(ran.out, "\n   arithmetic: correctly rounded: ");
    EXPECT_HAS(ran.out, "\ncpu\n   ");
}

TEST_F(GpuRender, EmptyImageComesWithAdviceToo) {
    writeText("b.json",
              sceneText(16, 12, R"("objects": [{"type": "sphere", "center": [0, 0, 20], "radius": 1}])"));
    EXPECT_EQ(runGlint("render b.json").err,
              "glint: warning: b.json: the image shows only background: the camera looks past the objects, "
              "or they are smaller than a pixel; check its eye and target (glint info prints the bounds)\n");
}

}  // namespace glint::app::test::gpu_render_test
