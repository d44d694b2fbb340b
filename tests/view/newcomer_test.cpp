// What the window is to its surroundings: files dragged onto it, fine screens, people who see it first.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/image_io.h"
#include "support.h"
#include "x_client.h"

namespace glint::view::test::newcomer_test {
namespace {

class Newcomer : public FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        size_ = "640x480";
        byHand_ = true;
    }
    nlohmann::json scene_ = nlohmann::json::parse(sceneText());
};

// ---- drag and drop ----

// Dragged by another program, with a name that an address cannot hold as it is: a scene is opened, a picture
// compared with.
TEST_F(Newcomer, FilesAreDraggedOntoTheWindow) {
    scene_["maxDepth"] = 1;
    writeText("an other+scene.json", scene_.dump());
    render("scene.json", "red picture.png");
    std::string fault = "nothing was dragged";
    std::thread manager([&] {
        fault = dragOnto("glint: scene.json", {std::filesystem::absolute("an other+scene.json").string(),
                                               std::filesystem::absolute("red picture.png").string()});
    });
    const Ran ran = view("set samples 1\nawait depth 1\nexpect-no-error\nsettle\nwait 3\nprint figures\n");
    manager.join();
    EXPECT_EQ(fault, "");
    ASSERT_EQ(ran.code, 0) << ran.err;
    EXPECT_LT(std::stod(printed(ran, "figures").at(0)), 0.1);
}

// ---- scales ----

// Steep steps from dark to bright in the rows of the help's heading, per row. Letters that are drawn for
// their size have the same number at every size; of stretched ones the steps are flat.
double steepSteps(const Image& image, int rows) {
    int steps = 0;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x + 1 < image.width; ++x)
            steps += std::abs(pixelOf(image, x + 1, y).g - pixelOf(image, x, y).g) > 90 ? 1 : 0;
    return static_cast<double>(steps) / rows;
}

Image stretched(const Image& image, double factor) {
    Image result;
    result.width = static_cast<int>(image.width * factor);
    result.height = static_cast<int>(image.height * factor);
    result.channels = image.channels;
    for (int y = 0; y < result.height; ++y)
        for (int x = 0; x < result.width; ++x)
            for (int c = 0; c < image.channels; ++c) {
                const double u = std::max((x + 0.5) / factor - 0.5, 0.0),
                             v = std::max((y + 0.5) / factor - 0.5, 0.0);
                const int i = static_cast<int>(u), j = static_cast<int>(v);
                const int right = std::min(i + 1, image.width - 1), below = std::min(j + 1, image.height - 1);
                const auto s = static_cast<float>(u - i), t = static_cast<float>(v - j);
                result.pixels.push_back(
                    (1 - t) * ((1 - s) * image.at(i, j, c) + s * image.at(right, j, c)) +
                    t * ((1 - s) * image.at(i, below, c) + s * image.at(right, below, c)));
            }
    return result;
}

TEST_F(Newcomer, LettersAreSharpAtOneAndAHalf) {
    Image pictures[2];
    for (const int i : {0, 1}) {
        size_ = i == 0 ? "800x300" : "1200x450";
        const Ran ran =
            view("set samples 1\nkey F1\nwait 4\nwindow help.png\n", {"--scale", i == 0 ? "1" : "1.5"});
        ASSERT_EQ(ran.code, 0) << ran.err;
        pictures[i] = readImage("help.png");
    }
    const double plain = steepSteps(pictures[0], 16), fine = steepSteps(pictures[1], 24);
    const double blurred = steepSteps(stretched(pictures[0], 1.5), 24);
    EXPECT_GT(plain, 20);
    EXPECT_GT(fine, 0.8 * plain);
    EXPECT_LT(blurred, 0.6 * plain);
}

// A desktop that asks for letters half as large again gets them without an option.
TEST_F(Newcomer, TheScreenSaysHowLarge) {
    const std::string script = "set samples 1\nwait 3\nprint control exposure\n";
    const std::string one = view(script, {"--scale", "1"}).out, asked = view(script, {"--scale", "1.5"}).out;
    setDotsPerInch(144);
    const std::string said = view(script).out;
    setDotsPerInch(96);
    EXPECT_EQ(said, asked);
    EXPECT_NE(said, one);
    EXPECT_EQ(view(script).out, one);
}

// ---- the panel beside the picture ----

// In a small window too: nothing of the picture is hidden, and it is the picture that `glint render` draws of
// its size; the mouse finds in it what is there.
TEST_F(Newcomer, ThePanelIsDockedBesideThePicture) {
    const Ran ran = view(
        "set samples 1\nhand key shift+h\nwait 4\nexpect covered 0.000\nprint picture\nsettle\nwindow "
        "window.png\nsave shown.png\nhand mousemove @90,250 click 1\nexpect-object 0\nhand key Escape\n"
        "press fly\nwait 3\npress fly\nwait 3\nhand key h\nwait 4\nexpect picture 640 480\n"
        "hand key shift+h\nwait 4\npress dock\nwait 4\nexpect picture 640 480\n");
    ASSERT_EQ(ran.code, 0) << ran.err;
    int width = 0, height = 0;
    ASSERT_EQ(std::sscanf(printed(ran, "picture").at(0).c_str(), "%d %d", &width, &height), 2);
    EXPECT_GE(width, 320);
    EXPECT_LT(width, 500);
    EXPECT_EQ(height, 480);
    size_ = std::to_string(width) + "x480";
    render("scene.json", "rendered.png");
    EXPECT_EQ(readBytes("shown.png"), readBytes("rendered.png"));
    const Image window = readImage("window.png"), rendered = readImage("rendered.png");
    ASSERT_EQ(window.width, 640);
    int differ = 0;
    for (int y = 0; y < 480; ++y)
        for (int x = 0; x < width; ++x)
            differ += pixelOf(window, 640 - width + x, y) == pixelOf(rendered, x, y) ? 0 : 1;
    EXPECT_EQ(differ, 0);
}

// However small the window and large the letters, half of it is the picture's.
TEST_F(Newcomer, ADockedPanelTakesHalfAtMost) {
    size_ = "240x180";
    const Ran ran = view(
        "set samples 1\nkey shift+H\nwait 4\nexpect picture 120 180\nresize 2 2\nwait 4\n"
        "expect picture 1 2\nresize 1 1\nwait 4\nexpect picture 1 1\n",
        {"--scale", "3"});
    EXPECT_EQ(ran.code, 0) << ran.err;
}

// ---- first steps ----

// Each hint goes when its advice has been followed, by hand; a later window has only what was left.
TEST_F(Newcomer, HintsLeadThroughTheFirstSteps) {
    newcomer_ = true;
    Ran ran = view(
        "set samples 1\nwait 3\nexpect hints turn pick save compare\nprint "
        "covered\n"
        "hand mousemove @400,200 mousedown 1 mousemove @430,200 mouseup 1\nwait 2\nexpect hints pick save "
        "compare\n"
        "settle\nhand click 1\nwait 2\nexpect hints save compare\n");
    ASSERT_EQ(ran.code, 0) << ran.err;
    EXPECT_LT(std::stod(printed(ran, "covered").at(0)), 0.4);
    ran = view(
        "set samples 1\nsettle\nexpect hints save compare\nhand key s\nsettle\nexpect hints compare\n"
        "hand key k\nhand key 5\nhand key b\nwait 2\nexpect hints none\nexpect toast That is all it takes\n");
    ASSERT_EQ(ran.code, 0) << ran.err;
    ran = view("expect hints none\n");
    EXPECT_EQ(ran.code, 0) << ran.err;
}

}  // namespace
}  // namespace glint::view::test::newcomer_test
