// Cameras with names in the window: the file's, and bookmarks that are written into it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "import/load.h"
#include "support.h"

namespace glint::view::test::cameras_test {
class Cameras : public FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        size_ = "500x900";  // the whole panel is seen
    }
    void writeWithCameras() {
        scene_["cameras"]["top"] = {{"type", "orthographic"}, {"eye", {0, 9, 1}}, {"height", 5}};
        scene_["cameras"]["side"] = {{"eye", {7, 1, 0}}, {"lensRadius", 0.2}, {"focusDistance", 6}};
        write("scene.json", scene_);
    }
};

// Found in the window, kept, named, written into the file by hand, and drawn by `glint render`; of what the
// file's owner wrote every byte stays.
TEST_F(Cameras, BookmarksAreWrittenIntoTheFile) {
    const std::string text = "// my scene\n" + sceneText() + "// the end\n";
    writeText("scene.json", text);
    std::filesystem::permissions("scene.json", std::filesystem::perms(0640));
    const Ran ran = view(
        "set samples 1\nkey Left\nkey PageUp\nwait 2\nhand key m\nscreenshot one.png\nkey 5\nwait 2\nhand "
        "key m\nscreenshot two.png\npress camera\nwait 3\nhand mousemove @name click --repeat 2 1\nwait "
        "3\nhand key ctrl+a\nhand type from_above\nhand key Return\nwait 2\nprint cameras\nhand mousemove "
        "@write_to_file click 1\nsettle\nprint cameras\n");
    const std::string names = "cameras bookmark 1, from_above\n";
    EXPECT_EQ(ran.out.substr(ran.out.find(names)), names + "wrote 2 cameras to scene.json\n" + names)
        << ran.out;
    expectRendered("one.png", "scene.json", {"--camera", "bookmark 1"});
    expectRendered("two.png", "scene.json", "--camera from_above");
    EXPECT_NE(readBytes("one.png"), readBytes("two.png"));

    std::string written = glint::test::readText("scene.json");
    const std::string start = "\n  \"cameras\": {\n    \"bookmark 1\": {", last = "\n  },";
    const size_t at = written.find(start), end = written.find(last, at);
    ASSERT_TRUE(at != std::string::npos && end != std::string::npos) << written;
    EXPECT_EQ(written.erase(at, end + last.size() - at), text);
    EXPECT_EQ(std::filesystem::status("scene.json").permissions(), std::filesystem::perms(0640));
}

// What somebody has changed meanwhile is not overwritten, nor anything without a bookmark.
TEST_F(Cameras, AChangedFileIsNotWritten) {
    writeText("broken.json", "{ \"objects\": [ oops");
    const Ran ran = view(
        "set samples 1\nhand key m\npress camera\nwait 3\ncopy broken.json scene.json\nreload\nkey "
        "Esc\npress write_to_file\nexpect toast has changed since it was read; nothing written\nprint "
        "cameras\n");
    EXPECT_EQ(glint::test::readText("scene.json"), "{ \"objects\": [ oops");
    EXPECT_HAS(ran.out, "cameras bookmark 1\n") << "the bookmark is still there";
}

TEST_F(Cameras, OfTheFileAreChosen) {
    writeWithCameras();
    view(
        "set samples 1\nhand key n\nsettle\nscreenshot next.png\npress camera\nwait 3\npress "
        "top\nsettle\nscreenshot pressed.png\nkey ctrl+Z\nsettle\nscreenshot undone.png\nkey "
        "R\nsettle\nscreenshot own.png\n",
        "--spp 4");
    expectRendered("next.png", "scene.json",
                   "--spp 4 --camera side");  // nlohmann's order: by name
    expectRendered("pressed.png", "scene.json", "--spp 4 --camera top");
    expectRendered("undone.png", "scene.json", "--spp 4 --camera side");
    expectRendered("own.png", "scene.json", "--spp 4");
}

// With the option the window begins there, and R comes back to it; another scene need not have such a camera.
TEST_F(Cameras, TheOptionChoosesTheFirst) {
    writeWithCameras();
    writeText("other.json", sceneText());
    const Ran ran = view(
        "set samples 1\nsettle\nscreenshot one.png\nkey Left\nkey R\nsettle\nscreenshot two.png\ndrop "
        "other.json\nsettle\nexpect fault none\nprint cameras\n",
        "--camera top");
    EXPECT_HAS(ran.out, "cameras none");
    expectRendered("one.png", "scene.json", "--camera top");
    expectRendered("two.png", "scene.json", "--camera top");
    const Ran unknown = view("", "--camera tip", 2);
    EXPECT_EQ(unknown.err, "glint: scene.json: no camera \"tip\" (there are \"side\", \"top\")\n");
}

// A glTF file has several, and holds no others.
TEST_F(Cameras, OfGltfAreChosen) {
    const std::string text = R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1, 2]}],
        "buffers": [{"byteLength": 36, "uri": "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "cameras": [{"type": "perspective", "name": "wide", "perspective": {"yfov": 1, "znear": 0.1}},
                    {"type": "orthographic", "name": "flat", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 9}}],
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 3]}, {"camera": 1, "translation": [0.2, 0.1, 2]}]})";
    writeText("two.gltf", text);
    const Ran ran =
        runView({"two.gltf", "--size", size_},
                parseScript("set samples 1\nprint cameras\nkey n\nkey n\nsettle\nscreenshot flat.png\nkey "
                            "m\npress camera\nwait 3\nprint control wide\nprint control write_to_file\n",
                            "script.txt"));
    EXPECT_EQ(ran.code, 1);
    EXPECT_HAS(ran.err, "no control 'write to file' is to be seen");
    EXPECT_HAS(ran.out, "cameras wide, flat\n");
    expectRendered("flat.png", "two.gltf", "--camera flat");
}

}  // namespace glint::view::test::cameras_test
