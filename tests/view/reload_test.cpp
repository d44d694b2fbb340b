// Files that change under the window.
#include <gtest/gtest.h>

#include "support.h"

namespace glint::view::test::reload_test {
namespace {

class Reload : public FolderTest {};

TEST_F(Reload, ShowsAChangedScene) {
    writeText("changed.json", sceneText(0.1));
    const Ran ran =
        view("wait 2\ncopy changed.json scene.json\nreload\nexpect-no-error\nscreenshot shot.png\n",
             {"--spp", "1"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    render("changed.json", "rendered.png");
    EXPECT_EQ(readBytes("shot.png"), readBytes("rendered.png"));
}

// The camera is the user's: a file with another one does not move it, until R is pressed.
TEST_F(Reload, KeepsTheCamera) {
    std::string moved = sceneText(0.1);
    const std::string eye = "\"eye\": [0, 1.5, 7]";
    moved.replace(moved.find(eye), eye.size(), "\"eye\": [3, 2.5, 6]");
    writeText("moved.json", moved);
    writeText("changed.json", sceneText(0.1));
    const Ran ran = view(
        "wait 2\ncopy moved.json scene.json\nreload\nscreenshot kept.png\nkey R\nwait 2\nscreenshot "
        "reset.png\n",
        {"--spp", "1"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    render("changed.json", "a.png");
    EXPECT_EQ(readBytes("kept.png"), readBytes("a.png"));
    render("moved.json", "b.png");
    EXPECT_EQ(readBytes("reset.png"), readBytes("b.png"));
}

TEST_F(Reload, ABrokenSceneIsSaidAndTheOldOneStays) {
    render("scene.json", "rendered.png");
    writeText("broken.json", "{\"objects\": [}");
    writeText("good.json", sceneText());
    const Ran ran = view(
        "wait 2\ncopy broken.json scene.json\nreload\nexpect-error scene.json:1:\nscreenshot shot.png\n"
        "copy good.json scene.json\nreload\nexpect-no-error\n",
        {"--spp", "1"});
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_EQ(readBytes("shot.png"), readBytes("rendered.png"));
    EXPECT_NE(ran.err.find("scene.json:1:"), std::string::npos) << ran.err;
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
    const Ran ran = view(
        "wait 2\ncopy tall.obj part.obj\nreload\nscreenshot tall.png\ncopy green.mtl part.mtl\nreload\n"
        "screenshot green.png\n",
        {"--spp", "1"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    render("scene.json", "now.png");
    EXPECT_EQ(readBytes("green.png"), readBytes("now.png"));
    writeText("part.mtl", "newmtl m\nKd 1 0 0\n");
    render("scene.json", "before.png");
    EXPECT_EQ(readBytes("tall.png"), readBytes("before.png"));
    EXPECT_NE(readBytes("tall.png"), readBytes("green.png"));
}

}  // namespace
}  // namespace glint::view::test::reload_test
