// Tests of the panel's settings (a scene file with the same values gives the same image), of reloading
// changed files, and of error targets.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/image_diff.h"
#include "core/image_io.h"
#include "core/quantize.h"
#include "support.h"
#include "view/display.h"

namespace glint::view::test::settings_test {
class Settings : public FolderTest {
  protected:
    // The view after `script` has the bytes of `scene` rendered.
    void expectLike(const std::string& script, const Json& scene) {
        view(script + "wait 2\nscreenshot shot.png\n");
        write("like.json", scene);
        expectRendered("shot.png", "like.json");
    }
};

TEST_F(Settings, LightsBackgroundAndDepth) {
    scene_["lights"][0]["intensity"] = 0.35;  // 0.7 / 2: exact in floats
    scene_["lights"].erase(1);
    scene_["background"] = {0.25, 0.5, 0.125};
    scene_["maxDepth"] = 1;
    expectLike("set light 0 0.5\nset light 1 0\nset background 0.25 0.5 0.125\nset depth 1\n", scene_);
}

TEST_F(Settings, NoLightAndNoReflections) {
    scene_["lights"].clear();
    scene_["maxDepth"] = 0;
    expectLike("set light 0 0\nset light 1 0\nset reflections off\n", scene_);
}

TEST_F(Settings, ShadowsOfGlass) {
    scene_["materials"]["one"] = {{"transmission", {0.9, 0.3, 0.3}}, {"ior", 1.5}};
    write("scene.json", scene_);
    scene_["transmissiveShadows"] = "full";
    expectLike("set samples 1\nset glass full\nsettle\n", scene_);
}

// A scene that is loaded without reflections has a pipeline that can still be asked for them.
TEST_F(Settings, ReflectionsInASceneOfDepthZero) {
    Json flat = scene_;
    flat["maxDepth"] = 0;
    write("scene.json", flat);
    expectLike("set depth 3\n", scene_);
}

// Exposure doubles linear values for each stop; the bytes of background 0.25 at +1 are those of 0.5.
TEST_F(Settings, Exposure) {
    view(
        "set background 0.25 0.25 0.25\nset exposure 1\nset samples 1\nkey H\nsettle\nwindow "
        "w.png\nscreenshot s.png\n");
    const int byte = srgbByte(0.5f);
    EXPECT_EQ(pixelOf(readImage("w.png"), 3, 3), (Rgb{byte, byte, byte}));
    EXPECT_EQ(pixelOf(readImage("s.png"), 3, 3), (Rgb{byte, byte, byte}));
}

// Without shadows no pixel is darker, the first sphere's shadow is lit, and what no shadow touches stays.
TEST_F(Settings, Shadows) {
    view("set shadows off\nwait 2\nscreenshot off.png\nset shadows on\nwait 2\nscreenshot on.png\n");
    expectRendered("on.png", "scene.json");
    const Image off = readImage("off.png"), on = readImage("on.png");
    int brighter = 0, darker = 0, same = 0;
    for (int y = 0; y < 180; ++y) {
        for (int x = 0; x < 240; ++x) {
            const Rgb a = pixelOf(off, x, y), b = pixelOf(on, x, y);
            brighter += a.g > b.g ? 1 : 0;
            darker += a.r < b.r || a.g < b.g || a.b < b.b ? 1 : 0;
            same += a == b ? 1 : 0;
        }
    }
    EXPECT_EQ(darker, 0);
    EXPECT_GT(brighter, 500);
    EXPECT_GT(same, 20000);
}

// ---- reloading changed files ----

class Reload : public FolderTest {};

std::string moved(const std::string& scene) {
    std::string text = scene;
    const std::string eye = "\"eye\": [0, 1.5, 7]";
    return text.replace(text.find(eye), eye.size(), "\"eye\": [3, 2.5, 6]");
}

// A camera that the user has moved stays, until R is pressed.
TEST_F(Reload, KeepsTheUsersCamera) {
    writeText("moved.json", moved(sceneText(0.1)));
    const Ran ran = view(
        "wait 2\nkey Left\nkey PageUp\nwait 1\nprint camera\ncopy moved.json scene.json\nreload\nprint "
        "camera\nkey R\nwait 2\nscreenshot reset.png\n");
    const size_t end = ran.out.find('\n');
    EXPECT_EQ(ran.out.substr(0, end), ran.out.substr(end + 1, ran.out.find('\n', end + 1) - end - 1));
    expectRendered("reset.png", "moved.json");
}

TEST_F(Reload, ABrokenSceneIsSaidAndTheOldOneStays) {
    writeText("broken.json", "{\"objects\": [}");
    writeText("good.json", sceneText());
    const Ran ran = view(
        "wait 2\ncopy broken.json scene.json\nreload\nexpect fault scene.json:1:\nscreenshot shot.png\ncopy "
        "good.json scene.json\nreload\nexpect fault none\n");
    expectRendered("shot.png", "good.json");
    EXPECT_HAS(ran.err, "scene.json:1:");
}

TEST_F(Reload, FollowsMeshesAndTheirMaterials) {
    const auto obj = [](double height) {
        return "mtllib part.mtl\nusemtl m\nv -1 0 0\nv 1 0 0\nv 0 " + std::to_string(height) +
               " 0\nf 1 2 3\n";
    };
    writeText("part.obj", obj(1));
    writeText("part.mtl", "newmtl m\nKd 1 0 0\n");
    writeText("tall.obj", obj(2));
    writeText("green.mtl", "newmtl m\nKd 0 1 0\n");
    writeText("scene.json",
              R"({"camera": {"type": "perspective", "eye": [0, 1, 5], "target": [0, 1, 0], "fovY": 45},
      "lights": [{"type": "directional", "direction": [0, 0, -1], "intensity": 1}],
      "meshes": {"part": {"file": "part.obj"}}, "objects": [{"type": "mesh", "mesh": "part"}]})");
    view(
        "wait 2\ncopy tall.obj part.obj\nreload\nscreenshot tall.png\ncopy green.mtl "
        "part.mtl\nreload\nscreenshot green.png\n");
    expectRendered("green.png", "scene.json");
    writeText("part.mtl", "newmtl m\nKd 1 0 0\n");
    expectRendered("tall.png", "scene.json");
    EXPECT_NE(readBytes("tall.png"), readBytes("green.png"));
}

// ---- until the error is small enough ----

class Until : public FolderTest {
  protected:
    const Words asked_ = "--error 0.01 --within-depth";
};

// Sums of floats are rounded in another order: a few units of 2^-24.
TEST_F(Until, StopsWhereRenderStops) {
    const Ran ran = view("settle\nprint error\nprint samples\nsave seen.exr\nidle 1\n", asked_);
    const Ran like =
        runGlint({"render", "scene.json", "--size", size_, "-o", "like.exr", "-q"}, asked_ + "--stats json");
    ASSERT_EQ(like.code, 0) << like.err;
    const std::string samples =
        std::to_string(Json::parse(like.out).at("error").at("samplesPerPixel").get<int>());
    EXPECT_EQ(printed(ran, "samples").at(0), samples);
    EXPECT_STARTS(printed(ran, "error").at(0), "error <= 0.0") << ran.out;
    EXPECT_HAS(printed(ran, "error").at(0), samples + " samples") << ran.out;
    EXPECT_LT(compareImages(readImage("seen.exr"), readImage("like.exr"), 0).max, 2e-6);
}

TEST_F(Until, IsSetInThePanelAndBeginsAnew) {
    size_ = "400x800";
    const Ran ran = view(
        "set samples 1\nset depth 0\nwait 3\npress lights\nwait 2\npress materials\nwait 2\npress "
        "tracing\nwait 2\nsettle\nexpect error none\npress until_error\nsettle\nprint error\nprint "
        "samples\npress within_depth\nsettle\nprint error\nkey H\norbit 30 0\nkey H\nwait 3\nsettle\nprint "
        "error\npress until_error\nsettle\nexpect error none\nexpect samples 1\n");
    const std::vector<std::string> errors = printed(ran, "error");
    EXPECT_STARTS(errors.at(0), "out of reach: with depth 0 ") << errors[0];
    for (const size_t i : {1u, 2u}) EXPECT_STARTS(errors.at(i), "error <= 0.0") << errors[i];
    // A moved camera restarts the image, as if the window had been opened with that camera.
    const Ran there = view("set depth 0\nkey H\norbit 30 0\nsettle\nprint error\n", asked_);
    EXPECT_EQ(printed(there, "error").at(0), errors.at(2));
}

}  // namespace glint::view::test::settings_test
