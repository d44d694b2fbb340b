// Files that change under the window.
#include <gtest/gtest.h>

#include "support.h"

namespace glint::view::test::reload_test {
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
        "camera\n"
        "key R\nwait 2\nscreenshot reset.png\n",
        {"--spp", "1"});
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

// Settings that the user has not changed, the camera included, follow the file.
TEST_F(Reload, SettingsFollowTheFile) {
    writeText("other.json", moved(withSettings(1, "[0.1, 0.8, 0.2]")));
    view("wait 2\ncopy other.json scene.json\nreload\nexpect depth 1\nscreenshot shot.png\n", {"--spp", "1"});
    render("other.json", "other.png");
    EXPECT_EQ(readBytes("shot.png"), readBytes("other.png"));
}

TEST_F(Reload, ABrokenSceneIsSaidAndTheOldOneStays) {
    render("scene.json", "rendered.png");
    writeText("broken.json", "{\"objects\": [}");
    writeText("good.json", sceneText());
    const Ran ran = view(
        "wait 2\ncopy broken.json scene.json\nreload\nexpect fault scene.json:1:\nscreenshot shot.png\n"
        "copy good.json scene.json\nreload\nexpect fault none\n",
        {"--spp", "1"});
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
    view(
        "wait 2\ncopy tall.obj part.obj\nreload\nscreenshot tall.png\ncopy green.mtl part.mtl\nreload\n"
        "screenshot green.png\n",
        {"--spp", "1"});
    render("scene.json", "now.png");
    EXPECT_EQ(readBytes("green.png"), readBytes("now.png"));
    writeText("part.mtl", "newmtl m\nKd 1 0 0\n");
    render("scene.json", "before.png");
    EXPECT_EQ(readBytes("tall.png"), readBytes("before.png"));
    EXPECT_NE(readBytes("tall.png"), readBytes("green.png"));
}

}  // namespace glint::view::test::reload_test
