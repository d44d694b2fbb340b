// What a person does with mouse and keyboard, through the window system: xdotool moves the real ones.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

#include "core/image_io.h"
#include "core/quantize.h"
#include "support.h"
#include "view/camera_control.h"
#include "view/files.h"

namespace glint::view::test::hand_test {
class Hand : public FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        size_ = "640x480";
        byHand_ = true;
    }
};

glm::dvec3 vectorOf(const nlohmann::json& json) {
    return {json[0], json[1], json[2]};
}

// All at once, faster than a frame: no digit reaches the camera, and what is out of range is not taken.
TEST_F(Hand, TypedDigitsStayInTheSlider) {
    size_ = "640x640";
    const Ran ran = view(
        "set samples 1\nprint camera\n"
        "hand mousemove @exposure keydown ctrl click 1 keyup ctrl key 1 key 2 key 3 key Return\n"
        "expect exposure 10\npress tracing\nwait 3\n"
        "hand mousemove @aim keydown ctrl click 1 keyup ctrl key minus key 1 key 0 key 0 key Return\nexpect "
        "aim 8\n"
        "hand mousemove @fov keydown ctrl click 1 keyup ctrl key 5 key 0 key Return\n"
        "expect fov 50\nprint camera\n");
    nlohmann::json before = cameras(ran).at(0);
    before["fovY"] = 50.0;
    EXPECT_EQ(before, cameras(ran).at(1));
}

TEST_F(Hand, PlusAndMinusAlsoOnTheKeypad) {
    view(
        "hand key plus\nexpect exposure 0.5\nhand key KP_Add\nexpect exposure 1\nhand key equal\n"
        "expect exposure 1.5\nhand key minus\nhand key KP_Subtract\nhand key KP_Subtract\nexpect exposure "
        "0\n");
}

// The focus distance goes along the view direction: the middle of the picture looks at the sphere's front.
TEST_F(Hand, ControlClickFocuses) {
    const Ran ran = view(
        "set samples 1\nkey H\nset lens 0.1\nhand mousemove @230,240 keydown ctrl click 1 keyup ctrl\n"
        "hand mousemove @230,240 click 1\nprint camera\n");
    std::istringstream line(ran.out.substr(ran.out.find('\n') + 1));
    std::vector<double> fields;
    for (std::string field; std::getline(line, field, ',') && fields.size() < 9;)
        fields.push_back(std::stod(field));
    ASSERT_EQ(fields.size(), 9u) << ran.out;
    const nlohmann::json camera = cameras(ran).at(0);
    const glm::dvec3 hit(fields[6], fields[7], fields[8]), eye = vectorOf(camera["eye"]);
    const glm::dvec3 forward = glm::normalize(vectorOf(camera["target"]) - eye);
    EXPECT_EQ(fields[4], 0);
    EXPECT_NEAR(camera["focusDistance"], glm::dot(hit - eye, forward), 1e-4);
    EXPECT_EQ(camera["lensRadius"], 0.1);
}

// The difference picture, the verdict and the pick belong to the view that they were made of.
TEST_F(Hand, MovingTakesWhatIsStaleAway) {
    size_ = "240x180";
    const Ran ran = view(
        "set samples 1\nkey H\nsettle\nkey S\nsettle\nkey V\nsettle\nwait 2\nexpect verdict passed\nhand "
        "mousemove @10,175 "
        "mousedown 1 mousemove @40,175 mousemove @80,175 mouseup 1\nexpect verdict none\nkey "
        "R\nsettle\nkey S\nsettle\n"
        "key V\nsettle\nwait 2\nexpect verdict passed\nhand mousemove @10,175 click 4\nexpect verdict "
        "none\nhand mousemove @20,150 click 1\nwait 1\nprint pick\n"
        "hand mousemove @10,175 click 4\nexpect pick none\n");
    EXPECT_NE(ran.out.find("pick "), std::string::npos);
    EXPECT_EQ(readBytes("scene-view-001.png"), readBytes("scene-view-002.png"))
        << "as before V, after it and a drag";
    EXPECT_NE(ran.out.find("% eye: /objects/"), std::string::npos) << ran.out;
}

TEST_F(Hand, TheWheelStaysNearTheScene) {
    const Ran ran = view(
        "set samples 1\nkey H\nhand mousemove @320,240 click --repeat 400 --delay 1 5\nprint camera\n"
        "hand click --repeat 900 --delay 1 4\nprint camera\n");
    const auto distance = [&](size_t i) {
        const nlohmann::json c = cameras(ran).at(i);
        return glm::length(vectorOf(c["eye"]) - vectorOf(c["target"]));
    };
    EXPECT_GT(distance(0), 1e3);
    EXPECT_LT(distance(0), 1e6);
    EXPECT_LT(distance(1), 1e-2);
    EXPECT_GT(distance(1), 1e-6);
}

TEST_F(Hand, HelpScrollsInASmallWindow) {
    size_ = "320x240";
    const Ran ran = view(
        "set samples 1\nhand key F1\nwait 3\nexpect scroll 0\nhand mousemove @160,120 click 5 click 5\nwait "
        "4\n"
        "print scroll\nhand key F1\n");
    EXPECT_GT(std::stod(printed(ran, "scroll").at(0)), 0);
}

TEST_F(Hand, ThePanelLeavesThePictureFree) {
    const Ran ran = view("set samples 1\nwait 3\nprint covered\nhand key h\nexpect covered 0.000\n");
    EXPECT_LT(std::stod(printed(ran, "covered").at(0)), 0.25);
}

// A color typed as the screen shows it; undo takes it back and leaves the camera.
TEST_F(Hand, UndoAndRedoOfAColor) {
    size_ = "640x760";
    const Ran ran = view(
        "set samples 1\nwait 4\nhand key Left\nwait 2\nprint camera\nhand mousemove @diffuse_hex click "
        "--repeat 2 "
        "1\nhand key ctrl+a\nhand key numbersign key 2 key 0 key c key 0 key 4 key 0 key Return\nsettle\n"
        "hand key c\nhand key ctrl+z\nsettle\nprint camera\nhand key c\nhand key ctrl+y\nsettle\nhand key "
        "c\n");
    std::vector<std::string> materials;
    std::istringstream lines(ran.out);
    for (std::string line; std::getline(lines, line);)
        if (line.rfind("\"materials\": ", 0) == 0) materials.push_back(line.substr(13));
    ASSERT_EQ(materials.size(), 2u) << ran.out;
    EXPECT_EQ(materials[0], materials[1]);
    const nlohmann::json one = nlohmann::json::parse(materials[0])["one"];
    EXPECT_NEAR(one["diffuse"][1], linearFromSrgb(0xc0 / 255.0), 1e-6);
    EXPECT_EQ(one["ambient"], one["diffuse"]);
    EXPECT_EQ(cameras(ran).at(0), cameras(ran).at(1));
}

TEST_F(Hand, FullscreenAndBack) {
    view(
        "set samples 1\nhand key F11\nwait 3\nexpect size 1280 1024\nhand key F11\nwait 3\nexpect size 640 "
        "480\n");
}

TEST_F(Hand, TheInspectorReadsThePixel) {
    const Ran ran =
        view("set samples 1\nkey H\nhand key i\nhand mousemove @330,150\nsettle\nwait 3\nprint pixel\n");
    render("scene.json", "rendered.exr");
    const Image image = readImage("rendered.exr");
    char expected[80];
    std::snprintf(expected, sizeof(expected), "330 150  %.6g %.6g %.6g  /objects/1",
                  static_cast<double>(image.at(330, 150, 0)), static_cast<double>(image.at(330, 150, 1)),
                  static_cast<double>(image.at(330, 150, 2)));
    EXPECT_EQ(printed(ran, "pixel").at(0).rfind(expected, 0), 0u)
        << printed(ran, "pixel").at(0) << "; rendered: " << expected;
}

// With Ctrl+Q right behind S the picture is there, whole, and nobody had to wait for it.
TEST_F(Hand, QuittingFinishesTheSave) {
    view("set samples 1\nstay\nhand key alt+s key ctrl+q\n", {"--spp", "4"});
    render("scene.json", "rendered.png", {"--spp", "4"});
    EXPECT_EQ(readBytes("scene-view-001.png"), readBytes("rendered.png"));
}

TEST_F(Hand, ASaveThatFailsIsSaid) {
    const Ran ran = view(
        "set samples 1\nsettle\npress save_and_open\nwait 3\npress save_as\nwait 3\n"
        "hand type nowhere/a.png\nhand key Return\nsettle\nstay\nhand key ctrl+q\n");
    EXPECT_NE(ran.err.find("nowhere/a.png"), std::string::npos) << ran.err;
}

// ---- what is seen is what is saved ----

TEST_F(Hand, SavesWhatIsSeen) {
    const Ran ran = view(
        "set samples 4\nhand key h\nset exposure 1.5\nset tonemap aces\nsettle\nwindow color.png\nhand key "
        "s\nsettle\n"
        "aov normal\nkey Esc\nsettle\nwait 2\nwindow normal.png\nhand key s\nsettle\n");
    EXPECT_EQ(readBytes("scene-view-001.png"), readBytes("color.png"));
    EXPECT_EQ(readBytes("scene-view-002.png"), readBytes("normal.png"));
    EXPECT_NE(ran.out.find("as seen: 4 samples"), std::string::npos) << ran.out;
}

TEST_F(Hand, SavesLayersAsSeen) {
    size_ = "240x180";
    view("set samples 1\nsettle\nhand key shift+s\nsettle\n");
    render("scene.json", "rendered.exr",
           {"--aov", "color,alpha,depth,position,normal,uv,object,primitive,material,bounces,cost"});
    EXPECT_EQ(readBytes("scene-view-001.exr"), readBytes("rendered.exr"));
}

// Nobody's picture is lost to another window that looks for a name at the same time.
TEST_F(Hand, NamesAreClaimed) {
    std::vector<std::filesystem::path> names(64);
    std::vector<std::thread> windows;
    for (size_t w = 0; w < 8; ++w)
        windows.emplace_back([&, w] {
            for (size_t i = 0; i < 8; ++i) names[8 * w + i] = claimName(".", "scene", ".png");
        });
    for (std::thread& window : windows) window.join();
    const std::set<std::filesystem::path> different(names.begin(), names.end());
    EXPECT_EQ(different.size(), names.size());
}

// Who asks twice does not want it: no half of a picture stays, nor an empty file, and the exit code says so.
TEST_F(Hand, QuittingTwiceDropsTheSave) {
    const Ran ran = view("set samples 1\nstay\nhand key alt+s key ctrl+q key ctrl+q\n", {"--spp", "4096"}, 1);
    EXPECT_NE(ran.err.find("before the image was saved"), std::string::npos) << ran.err;
    EXPECT_FALSE(std::filesystem::exists("scene-view-001.png"));
}

}  // namespace glint::view::test::hand_test
