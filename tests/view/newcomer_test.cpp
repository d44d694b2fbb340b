// The window in its surroundings: fine screens, small windows, people who see it first.
#include <gtest/gtest.h>

#include <string>

#include "core/image_io.h"
#include "support.h"
// X11 defines common words as macros.
#include <X11/Xatom.h>
#include <X11/Xlib.h>

namespace glint::view::test::newcomer_test {
// Sets the resolution that desktops tell programs: the X resource Xft.dpi; 96 is a scale of 1.
void setDotsPerInch(int dots) {
    ::Display* const display = XOpenDisplay(nullptr);
    if (display == nullptr) return;
    const std::string text = "Xft.dpi:\t" + std::to_string(dots) + "\n";
    XChangeProperty(display, DefaultRootWindow(display), XA_RESOURCE_MANAGER, XA_STRING, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(text.data()), static_cast<int>(text.size()));
    XCloseDisplay(display);
}

class Newcomer : public FolderTest {
  protected:
    Newcomer() { size_ = "640x480"; }
};

// ---- scales ----

// A desktop that asks for letters half as large again gets them without an option.
TEST_F(Newcomer, TheScreenSaysHowLarge) {
    const std::string script = "set samples 1\nwait 3\nprint control exposure\n";
    const std::string one = view(script, "--scale 1").out, asked = view(script, "--scale 1.5").out;
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
        "window.png\nsave shown.png\nhand mousemove @90,250 click 1\nexpect object 0\nhand key Escape\npress "
        "fly\nwait 3\npress fly\nwait 3\nhand key h\nwait 4\nexpect picture 640 480\nhand key shift+h\nwait "
        "4\npress dock\nwait 4\nexpect picture 640 480\n");
    int width = 0, height = 0;
    ASSERT_EQ(std::sscanf(printed(ran, "picture").at(0).c_str(), "%d %d", &width, &height), 2);
    EXPECT_GE(width, 320);
    EXPECT_LT(width, 500);
    EXPECT_EQ(height, 480);
    size_ = std::to_string(width) + "x480";
    expectRendered("shown.png", "scene.json");
    const Image window = readImage("window.png"), shown = readImage("shown.png");
    ASSERT_EQ(window.width, 640);
    int differ = 0;
    for (int y = 0; y < 480; ++y)
        for (int x = 0; x < width; ++x)
            differ += pixelOf(window, 640 - width + x, y) == pixelOf(shown, x, y) ? 0 : 1;
    EXPECT_EQ(differ, 0);
}

// However small the window and large the letters, half of it is the picture's.
TEST_F(Newcomer, ADockedPanelTakesHalfAtMost) {
    size_ = "240x180";
    view(
        "set samples 1\nkey shift+H\nwait 4\nexpect picture 120 180\nresize 2 2\nwait 4\nexpect picture 1 "
        "2\nresize 1 1\nwait 4\nexpect picture 1 1\n",
        "--scale 3");
}

// ---- first steps ----

// Each hint goes when its advice has been followed, by hand; a later window has only what was left.
TEST_F(Newcomer, HintsLeadThroughTheFirstSteps) {
    newcomer_ = true;
    const Ran ran = view(
        "set samples 1\nwait 3\nexpect hints turn pick save compare\nprint covered\nhand mousemove @400,200 "
        "mousedown 1 mousemove @430,200 mouseup 1\nwait 2\nexpect hints pick save compare\nsettle\nhand "
        "click 1\nwait 2\nexpect hints save compare\n");
    EXPECT_LT(std::stod(printed(ran, "covered").at(0)), 0.4);
    view(
        "set samples 1\nsettle\nexpect hints save compare\nhand key s\nsettle\nexpect hints compare\nhand "
        "key k\nhand key 5\nhand key b\nwait 2\nexpect hints none\nexpect toast That is all it takes\n");
    view("expect hints none\n");
}

}  // namespace glint::view::test::newcomer_test
