// What `glint render` writes from a device.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/image_io.h"
#include "import/load.h"
#include "pack/packed_scene.h"
#include "reference/render.h"
#include "render_cases.h"

namespace glint::app::test::render_cases {
INSTANTIATE_TEST_SUITE_P(Gpu, RenderEither, ::testing::Values("gpu"));

}  // namespace glint::app::test::render_cases

namespace glint::app::test::gpu_render_test {
class GpuRender : public FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        writeSmallScene("a.json");
    }

    static void render(std::vector<std::string> options) {
        const Ran ran = runGlint({"render", "a.json", "-q"}, options);
        EXPECT_EQ(ran.code, 0);
        EXPECT_EQ(ran.out + ran.err, "");
    }
};

// The same samples of the same pixels, so the same rounds, and the picture of the reference but for rounding.
TEST_F(GpuRender, AnErrorIsReachedAsTheReferenceReachesIt) {
    const std::vector<std::string> target = {"--error", "0.01",  "--within-depth", "--size",
                                             "32x24",   "--aov", "color,samples"};
    std::vector<std::string> device = target, host = target;
    device.insert(device.end(), {"-o", "device.pfm"});
    host.insert(host.end(), {"-o", "host.pfm", "--backend", "cpu"});
    render(device);
    render(host);
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
            EXPECT_TRUE(ran.err.starts_with("glint: packets of rays need subgroups of 8 lanes")) << ran.err;
            continue;
        }
        EXPECT_EQ(ran.code, 0) << ran.err;
        EXPECT_HAS(ran.out, "\"traversal\": \"" + traversal + "\"");
    }
    EXPECT_FALSE(readBytes("lane.exr").empty());
    if (hasPackets()) {
        EXPECT_EQ(readBytes("lane.exr"), readBytes("packet.exr"));
    }
}

// The object under each pixel's centre moved by (dx, dy) pixels, as the reference sees it.
std::vector<int> objectsAt(double dx, double dy) {
    const Scene scene = loadScene("a.json");
    const PackedScene packed = packScene(scene);
    Request request;
    request.width = scene.image.width;
    request.height = scene.image.height;
    request.samples = PackedSamples::fixed({{0.5 + dx, 0.5 + dy}});
    request.data = true;
    const shared::Camera camera =
        packCamera(scene.camera, scene.image.width, scene.image.height, packed.origin);
    std::vector<int> objects;
    for (const PixelData& pixel : reference::render(packed, camera, request).data)
        objects.push_back(static_cast<int>(pixel.object));
    return objects;
}

// No outline of this scene passes within a thousandth of a pixel of a pixel's centre, which is checked first;
// fp32 moves it by a hundred-thousandth (2^-24 times some units, in pixels of 1/5 unit). So both backends
// must see the same objects.
TEST_F(GpuRender, IndicesEqualTheReferences) {
    for (const double d : {-1e-3, 1e-3}) {
        ASSERT_EQ(objectsAt(0, 0), objectsAt(d, d));
        ASSERT_EQ(objectsAt(0, 0), objectsAt(d, -d));
    }
    const std::string layers = "color,object,primitive,material,bounces,alpha";
    render({"-o", "gpu.pfm", "--aov", layers});
    render({"-o", "cpu.pfm", "--aov", layers, "--backend", "cpu"});
    for (const char* layer : {"object", "primitive", "material", "bounces", "alpha"}) {
        EXPECT_EQ(readBytes(std::string("gpu.") + layer + ".pfm"),
                  readBytes(std::string("cpu.") + layer + ".pfm"))
            << layer;
    }
    const Image ids = readImage("gpu.object.pfm");
    std::set<float> seen(ids.pixels.begin(), ids.pixels.end());
    EXPECT_EQ(seen, (std::set<float>{-1, 0, 1, 2}));
    EXPECT_EQ(runGlint({"diff", "gpu.pfm", "cpu.pfm", "--tolerance", "0.001"}).code, 0);
}

TEST_F(GpuRender, CostIsCountedAndChangesNothingElse) {
    render({"-o", "with.pfm", "--aov", "color,cost,alpha"});
    render({"-o", "without.pfm"});
    EXPECT_EQ(readBytes("with.pfm"), readBytes("without.pfm"));
    const Image cost = readImage("with.cost.pfm"), alpha = readImage("with.alpha.pfm");
    ASSERT_EQ(alpha.pixels.size(), cost.pixels.size());
    for (size_t i = 0; i < alpha.pixels.size(); ++i) {
        const float least = alpha.pixels[i] > 0 ? 1.0f : 0.0f;  // the primitive that was hit
        ASSERT_GE(cost.pixels[i], least) << i;
    }
}

TEST_F(GpuRender, MaxDepthZeroRemovesReflections) {
    render({"-o", "p.pfm", "--aov", "bounces,color"});
    render({"-o", "q.pfm", "--aov", "bounces,color", "--max-depth", "0"});
    const Image with = readImage("p.bounces.pfm"), without = readImage("q.bounces.pfm");
    EXPECT_GT(*std::max_element(with.pixels.begin(), with.pixels.end()), 0.0f);
    EXPECT_EQ(*std::max_element(without.pixels.begin(), without.pixels.end()), 0.0f);
    EXPECT_NE(readBytes("p.pfm"), readBytes("q.pfm"));
}

TEST_F(GpuRender, DeviceThatDoesNotExist) {
    for (const char* selector : {"none", "99", "-1"}) {
        const Ran ran = runGlint({"render", "a.json", "--device", selector});
        EXPECT_EQ(ran.code, 4);
        EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
        EXPECT_TRUE(ran.err.starts_with("glint: no Vulkan device has ")) << ran.err;
        EXPECT_HAS(ran.err, "; there is 0 \"");
        EXPECT_EQ(ran.out, "");
    }
    EXPECT_EQ(names(), std::set<std::string>{"a.json"});
}

// What is true of lavapipe alone.
class Lavapipe : public GpuRender {};

TEST_F(Lavapipe, ByIndexAndName) {
    for (const char* selector : {"0", "llvmpipe", "LLVM"}) render({"--device", selector, "--size", "8x6"});
}

// One kernel for whole paths is there sooner, packets are faster: the command counts the picture's rays. What
// is sampled until an error is reached counts as many.
TEST_F(Lavapipe, PacketsAreForManyRays) {
    const auto walkOf = [](std::vector<std::string> options) {
        const Ran ran = runGlint({"render", glint::test::sourcePath("scenes/knot.json"), "-q", "--size",
                                  "40x30", "--stats", "json", "-o", "a.png"},
                                 options);
        EXPECT_EQ(ran.code, 0) << ran.err;
        const size_t at = ran.out.find("\"traversal\": \"");
        return at == std::string::npos ? ran.out : ran.out.substr(at + 14, 4);
    };
    EXPECT_EQ(walkOf({}), "lane");
    EXPECT_EQ(walkOf({"--spp", "1024"}), "pack");
    EXPECT_EQ(walkOf({"--error", "0.5"}), "pack");
}

TEST_F(Lavapipe, IsListedAsTheChosenOne) {
    const Ran ran = runGlint({"devices"});
    EXPECT_EQ(ran.code, 0);
    EXPECT_EQ(ran.err, "");
    EXPECT_TRUE(ran.out.starts_with("0  llvmpipe")) << ran.out;
    EXPECT_HAS(ran.out, "\n   chosen: ");
    EXPECT_HAS(ran.out, "\n   arithmetic: correctly rounded: ");
}

TEST_F(GpuRender, BlackPictureComesWithAdviceToo) {
    writeText("b.json",
              sceneText(16, 12, R"("objects": [{"type": "sphere", "center": [0, 0, 20], "radius": 1}])"));
    EXPECT_EQ(runGlint({"render", "b.json"}).err,
              "glint: warning: b.json: the image shows only background: everything lies behind the camera; "
              "check its eye and target\n");
}

TEST_F(GpuRender, EmptyScene) {
    writeText("b.json", "{\"image\": {\"width\": 9, \"height\": 7}, \"background\": 0.5}");
    EXPECT_EQ(runGlint({"render", "b.json", "-o", "b.pfm", "-q"}).code, 0);
    const Image image = readImage("b.pfm");
    for (const float sample : image.pixels) ASSERT_EQ(sample, 0.5f);
}

}  // namespace glint::app::test::gpu_render_test
