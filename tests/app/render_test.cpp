// What `glint render --backend cpu` writes.
#include <cmath>

#include "core/image_io.h"
#include "support.h"

namespace glint::app::test::render_test {
class Render : public SmallSceneTest {
  protected:
    static void render(const Words& options) { SmallSceneTest::render("--backend cpu" + options); }
};

TEST_F(Render, DefaultNameIsTheScenesInTheCurrentFolder) {
    std::filesystem::create_directory("scenes");
    std::filesystem::rename("a.json", "scenes/my scene.v2.json");
    const Ran ran = runGlint({"render", "scenes/my scene.v2.json", "--backend", "cpu", "-q"});
    EXPECT_EQ(ran.code, 0);
    EXPECT_EQ(names(), (std::set<std::string>{"scenes", "my scene.v2.png"}));
}

// A stranger's file may be called anything; what is written keeps the name.
TEST_F(Render, NamesDoNotReachTheTerminalUnchanged) {
    const std::string name = "steer\x1b]0;title\a";
    std::filesystem::rename("a.json", name + ".json");
    Ran ran = runGlint({"render", name + ".json", "--backend", "cpu"});
    EXPECT_EQ(ran.code, 0);
    EXPECT_EQ(ran.out.substr(0, ran.out.find('(')), "wrote steer?]0;title?.png ");
    EXPECT_TRUE(std::filesystem::exists(name + ".png"));
    ran = runGlint({"info", name + ".json"});
    EXPECT_EQ(ran.out.substr(0, ran.out.find('\n')), "steer?]0;title?.json");
    ran = runGlint({"diff", name + ".png", name + ".png", "-o", name + ".exr"});
    EXPECT_EQ(ran.out.find('\x1b'), std::string::npos) << ran.out;
    EXPECT_HAS(ran.out, "wrote steer?]0;title?.exr");
}

TEST_F(Render, LayersAreSeparateFilesButForExr) {
    const std::string all = "color,alpha,depth,position,normal,uv,object,primitive,material,bounces,cost";
    render({"-o", "p.pfm", "--aov", all});
    render({"-o", "p.png", "--aov", all});
    render({"-o", "p.exr", "--aov", all});
    std::set<std::string> expected = {"a.json", "p.pfm", "p.alpha.pfm", "p.png", "p.exr"};
    for (const char* layer :
         {"depth", "position", "normal", "uv", "object", "primitive", "material", "bounces", "cost"}) {
        expected.insert(std::string("p.") + layer + ".pfm");
        expected.insert(std::string("p.") + layer + ".png");
    }
    EXPECT_EQ(names(), expected);
    EXPECT_EQ(readImage("p.png").channels, 4) << "alpha is the PNG's own";
    const std::vector<uint8_t> exr = readBytes("p.exr");
    const std::string text(exr.begin(), exr.end());
    for (const char* channel : {"R", "G", "B", "A", "depth.Y", "position.X", "normal.Z", "uv.U", "uv.V",
                                "object.Y", "primitive.Y", "material.Y", "bounces.Y", "cost.Y"}) {
        EXPECT_HAS(text, std::string(channel) + '\0' + std::string("\2\0\0\0", 4)) << channel;  // 2: FLOAT
    }
}

// The middle pixel of 3 x 3 looks along -z at the unit sphere round the origin; the corner one sees nothing.
TEST_F(Render, LayersHoldWhatTheirNamesSay) {
    writeText("a.json", sceneText(3, 3, R"("ambient": 1, "objects": [
        {"type": "plane", "point": [0, 0, 50], "normal": [0, 0, 1]}, {"type": "sphere", "center": [0, 0, 0], "radius": 1}])"));
    render("-o p.pfm --aov color,alpha,depth,position,normal,object,primitive,material,bounces,cost");
    const auto pixel = [](const char* layer, int x, int y) {
        const Image image = readImage(std::string("p.") + layer + ".pfm");
        std::vector<float> samples;
        for (int c = 0; c < image.channels; ++c) samples.push_back(image.at(x, y, c));
        return samples;
    };
    using Samples = std::vector<float>;
    EXPECT_EQ(pixel("alpha", 1, 1)[0], 1.0f);
    EXPECT_EQ(pixel("depth", 1, 1)[0], 4.0f);
    EXPECT_EQ(pixel("position", 1, 1), (Samples{0, 0, 1}));
    EXPECT_EQ(pixel("normal", 1, 1), (Samples{0, 0, 1}));
    EXPECT_EQ(pixel("object", 1, 1)[0], 1.0f);
    EXPECT_EQ(pixel("primitive", 1, 1)[0], 0.0f);
    EXPECT_EQ(pixel("bounces", 1, 1)[0], 0.0f);
    EXPECT_GT(pixel("cost", 1, 1)[0], 0.0f);
    EXPECT_EQ(pixel("alpha", 0, 0)[0], 0.0f);
    EXPECT_TRUE(std::isinf(pixel("depth", 0, 0)[0]));
    EXPECT_EQ(pixel("object", 0, 0)[0], -1.0f);
    EXPECT_EQ(pixel("material", 0, 0)[0], -1.0f);
    EXPECT_EQ(pixel("position", 0, 0), (Samples{0, 0, 0}));
}

TEST_F(Render, SingleDataLayerIsAFileOfItsOwn) {
    const Ran ran = runGlint("render a.json --backend cpu --aov depth -o p.png");
    EXPECT_EQ(names(), (std::set<std::string>{"a.json", "p.depth.png"}));
    EXPECT_STARTS(ran.out, "wrote p.depth.png (64x48)\n");
}

// The samples of the PNG are those of radiance times 2^STOPS; alpha stays.
TEST_F(Render, ExposureScalesTheColoursOfPngFiles) {
    render("-o linear.pfm");
    Image image = readImage("linear.pfm");
    for (float& sample : image.pixels) sample *= 2;
    writeImage("twice.png", image);
    for (const Words way : {"", "--band-rows 8", "--frames 0"}) {
        Words args = "-o new/ --exposure 1 --overwrite";
        if (way.empty() || way[0] != "--frames") args.pop_back();
        args += way;
        render(args);
        EXPECT_EQ(readImage("new/a.png").pixels, readImage("twice.png").pixels);
        std::filesystem::remove("new/a.png");
    }
    for (const std::string output : {"a.exr", "a.pfm", "a.hdr"})
        expectError("render a.json --exposure 1 -o " + output, 2,
                    "--exposure: " + output + " holds linear floats, which need none; use .png");
}

// A wedge that is flat along z, and the same model lying down: x' = x, y' = -z, z' = y for z up.
TEST_F(Render, UpTurnsModelsThatLieDown) {
    writeText("y.obj", "v 0 0 0\nv 3 0 0\nv 0 2 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    writeText("z.obj", "v 0 0 0\nv 3 0 0\nv 0 0 2\nv 0 -1 0\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    writeText("x.obj", "v 0 0 0\nv 0 0 3\nv 2 0 0\nv 0 1 0\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    for (const char* options : {"y.obj --up y -o y.pfm", "z.obj --up z -o z.pfm", "x.obj --up x -o x.pfm",
                                "z.obj --up y -o down.pfm"})
        ASSERT_EQ(runGlint("render --backend cpu -q --size 64x48", options).code, 0) << options;
    EXPECT_EQ(runGlint("diff y.pfm z.pfm --tolerance 1e-5").code, 0);
    EXPECT_EQ(runGlint("diff y.pfm x.pfm --tolerance 1e-5").code, 0);
    EXPECT_EQ(runGlint("diff y.pfm down.pfm --tolerance 0.1").code, 5);
    expectError("render a.json --up z", 2,
                "a.json: has a camera of its own, which decides what is up (--up)");
}

TEST_F(Render, ReplacesAnOldPicture) {
    writeText("a.png", "old");
    render({});
    EXPECT_EQ(readImage("a.png").width, 64);
    EXPECT_EQ(names(), (std::set<std::string>{"a.json", "a.png"}));
}

TEST_F(Render, ItsOwnTextureIsNotReplaced) {
    std::filesystem::create_directory("sub");
    writeText("sub/m.obj", "mtllib m.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    writeText("sub/m.mtl", "newmtl a\nmap_Kd m.png\n");
    writeImage("sub/m.png", Image(2, 2, 3));
    const auto texture = readBytes("sub/m.png");
    std::filesystem::create_symlink("sub/m.png", "link.png");
    const Words render = "render sub/m.obj --backend cpu -q --size 8x8";
    for (const std::string output : {"sub/m.png", "sub/../sub/m.png", "link.png"})
        for (const char* options : {"-o ", "--checkpoint c -o "})
            expectError(render + (options + output), 2,
                        output + ": is read by the scene; name another file with --output");
    expectError(render + "--frames 0:0 --overwrite -o sub/m.png", 2,
                "sub/m.png: is read by the scene; name another file with --output");
    EXPECT_EQ(readBytes("sub/m.png"), texture);
    EXPECT_EQ(runGlint(render).code, 0);
    std::filesystem::current_path("sub");
    EXPECT_EQ(runGlint("render m.obj --backend cpu -q --size 8x8").code, 0);
    EXPECT_EQ(readImage("m.render.png").width, 8);
    EXPECT_EQ(runGlint("render m.obj --backend cpu -q --size 8x8 --part 1/1 -o p.part").code, 0);
    EXPECT_STARTS(runGlint("merge p.part").out, "wrote m.render.png");
    std::filesystem::current_path("..");
    EXPECT_EQ(readBytes("sub/m.png"), texture);
    EXPECT_EQ(names(), (std::set<std::string>{"a.json", "link.png", "m.png", "sub"}));
}

}  // namespace glint::app::test::render_test
