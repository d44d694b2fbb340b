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

std::string moved(const std::string& scene) {
    std::string text = scene;
    const std::string eye = "\"eye\": [0, 1.5, 7]";
    return text.replace(text.find(eye), eye.size(), "\"eye\": [3, 2.5, 6]");
}

// Until the user has moved it, the camera is the file's.
TEST_F(Reload, FollowsTheFilesCamera) {
    writeText("moved.json", moved(sceneText()));
    const Ran ran = view("wait 2\ncopy moved.json scene.json\nreload\nscreenshot shot.png\n", {"--spp", "1"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    render("moved.json", "a.png");
    EXPECT_EQ(readBytes("shot.png"), readBytes("a.png"));
}

// A camera that the user has moved stays, until R is pressed.
TEST_F(Reload, KeepsTheUsersCamera) {
    writeText("moved.json", moved(sceneText(0.1)));
    writeText("changed.json", sceneText(0.1));
    const Ran ran = view(
        "wait 2\nkey Left\nkey PageUp\nwait 1\nprint camera\ncopy moved.json scene.json\nreload\nprint "
        "camera\n"
        "key R\nwait 2\nscreenshot reset.png\n",
        {"--spp", "1"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    const size_t end = ran.out.find('\n');
    EXPECT_EQ(ran.out.substr(0, end), ran.out.substr(end + 1, ran.out.find('\n', end + 1) - end - 1));
    render("moved.json", "b.png");
    EXPECT_EQ(readBytes("reset.png"), readBytes("b.png"));
}

std::string withSettings(int depth, const std::string& background) {
    std::string text = sceneText();
    text.replace(text.find("\"maxDepth\": 3"), 13, "\"maxDepth\": " + std::to_string(depth));
    const std::string old = "[0.3, 0.4, 0.6]";
    return text.replace(text.find(old), old.size(), background);
}

// What the panel has not touched is the file's: then a saved picture is what `glint render` draws of it.
TEST_F(Reload, SettingsFollowTheFile) {
    writeText("other.json", withSettings(1, "[0.1, 0.8, 0.2]"));
    const Ran ran = view("wait 2\ncopy other.json scene.json\nreload\nexpect depth 1\nscreenshot shot.png\n",
                         {"--spp", "1"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    render("other.json", "other.png");
    EXPECT_EQ(readBytes("shot.png"), readBytes("other.png"));
}

// And what it has touched is the user's.
TEST_F(Reload, SettingsOfTheUserStay) {
    writeText("other.json", withSettings(2, "[0.1, 0.8, 0.2]"));
    writeText("expected.json", withSettings(2, "[0.25, 0.5, 0.125]"));
    const Ran ran = view(
        "wait 2\nset background 0.25 0.5 0.125\nset light 1 0\ncopy other.json scene.json\nreload\n"
        "expect depth 2\nset light 1 1\nwait 2\nscreenshot shot.png\n",
        {"--spp", "1"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    render("expected.json", "expected.png");
    EXPECT_EQ(readBytes("shot.png"), readBytes("expected.png"));
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
