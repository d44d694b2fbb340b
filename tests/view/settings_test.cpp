// What the panel changes is what a scene with those values would draw.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/image_io.h"
#include "core/quantize.h"
#include "support.h"
#include "view/display.h"

namespace glint::view::test::settings_test {
class Settings : public FolderTest {
  protected:
    // The view after `script` has the bytes of `scene` rendered.
    void expectLike(const std::string& script, const nlohmann::json& scene) {
        view(script + "wait 2\nscreenshot shot.png\n", {"--spp", "1"});
        writeText("like.json", scene.dump());
        render("like.json", "like.png");
        EXPECT_EQ(readBytes("shot.png"), readBytes("like.png"));
    }
    nlohmann::json scene_ = nlohmann::json::parse(sceneText());
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
    writeText("scene.json", scene_.dump());
    scene_["transmissiveShadows"] = "full";
    expectLike("set samples 1\nset glass full\nsettle\n", scene_);
}

// What C prints of lights and materials, put into the file, is the scene that is seen.
TEST_F(Settings, TheCopiedSceneIsTheOneThatIsSeen) {
    const Ran ran =
        view("set light 0 0.5\nset diffuse two 0.75 0.25 0.5\nkey Left\nsettle\nkey C\nscreenshot shot.png\n",
             {"--spp", "1"});
    const size_t from = ran.out.find("\"camera\""), to = ran.out.find("saved ");
    const nlohmann::json copied = nlohmann::json::parse("{" + ran.out.substr(from, to - from) + "}");
    scene_["camera"] = copied["camera"];
    scene_["lights"] = copied["lights"];
    EXPECT_EQ(copied["materials"].size(), 1u);
    scene_["materials"]["two"]["diffuse"] = copied["materials"]["two"]["diffuse"];
    writeText("like.json", scene_.dump());
    render("like.json", "like.png");
    EXPECT_EQ(readBytes("shot.png"), readBytes("like.png"));
}

// A scene that is loaded without reflections has a pipeline that can still be asked for them.
TEST_F(Settings, ReflectionsInASceneOfDepthZero) {
    nlohmann::json flat = scene_;
    flat["maxDepth"] = 0;
    writeText("scene.json", flat.dump());
    expectLike("set depth 3\n", scene_);
}

// Exposure doubles linear values for each stop; the bytes of background 0.25 at +1 are those of 0.5.
TEST_F(Settings, Exposure) {
    view(
        "set background 0.25 0.25 0.25\nset exposure 1\nset samples 1\nkey H\nsettle\nwindow w.png\n"
        "screenshot s.png\n",
        {"--spp", "1"});
    const int byte = srgbByte(0.5f);
    EXPECT_EQ(pixelOf(readImage("w.png"), 3, 3), (Rgb{byte, byte, byte}));
    EXPECT_EQ(pixelOf(readImage("s.png"), 3, 3), (Rgb{byte, byte, byte}));
}

// Without shadows no pixel is darker, the first sphere's shadow is lit, and what no shadow touches stays.
TEST_F(Settings, Shadows) {
    view("set shadows off\nwait 2\nscreenshot off.png\nset shadows on\nwait 2\nscreenshot on.png\n",
         {"--spp", "1"});
    render("scene.json", "rendered.png");
    EXPECT_EQ(readBytes("on.png"), readBytes("rendered.png"));
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

}  // namespace glint::view::test::settings_test
