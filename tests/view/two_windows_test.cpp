// Two windows at once, each a process of its own, in one folder.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "core/image_io.h"
#include "support.h"
#include "x_client.h"

namespace glint::view::test::two_windows_test {
namespace {

class TwoWindows : public FolderTest {
  protected:
    // `glint view scene.json` until it is closed; its exit code.
    static int run(const std::string& size, const std::string& output) {
        const std::string command = "timeout 300 " + std::string(GLINT_PROGRAM) +
                                    " view scene.json --validation --spp 32 --size " + size + " > " + output +
                                    " 2>&1";
        const int status = std::system(command.c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    static void type(const FoundWindow& window, const std::string& key) {
        giveKeysTo(window.id);
        ASSERT_EQ(std::system(("xdotool key " + key).c_str()), 0);
    }
    // Whether a file holds so many lines that begin with "saved", within a minute.
    static bool saved(const std::string& output, size_t count) {
        for (int i = 0; i < 6000; ++i) {
            const std::string text = glint::test::readText(output);
            size_t lines = 0;
            for (size_t at = text.find("saved "); at != std::string::npos; at = text.find("saved ", at + 1))
                ++lines;
            if (lines >= count) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return false;
    }
};

// Both save at the same time, twice, and both are closed while they save: every picture is there, whole,
// under a name of its own. They are told apart by their size.
TEST_F(TwoWindows, SaveAtTheSameTimeAndAreClosed) {
    int large = -1, small = -1;
    std::thread one([&] { large = run("240x180", "large.txt"); });
    // A new window takes the keys: before it has, those of the other one would go astray.
    std::vector<FoundWindow> windows = windowsCalled("glint: scene.json", 1);
    EXPECT_TRUE(!windows.empty() && takesKeys(windows[0].id));
    std::thread two([&] { small = run("200x150", "small.txt"); });
    windows = windowsCalled("glint: scene.json", 2);
    if (windows.size() == 2 && windows[0].width < windows[1].width) std::swap(windows[0], windows[1]);
    EXPECT_TRUE(windows.size() == 2 && takesKeys(windows[1].id));
    for (const FoundWindow& window : windows) type(window, "alt+s");
    EXPECT_TRUE(saved("large.txt", 1));
    EXPECT_TRUE(saved("small.txt", 1));
    for (const FoundWindow& window : windows) type(window, "alt+s");
    for (const FoundWindow& window : windows) type(window, "ctrl+q");
    one.join();
    two.join();
    EXPECT_EQ(large, 0) << glint::test::readText("large.txt");
    EXPECT_EQ(small, 0) << glint::test::readText("small.txt");
    size_ = "240x180";
    render("scene.json", "large.png", {"--spp", "32"});
    size_ = "200x150";
    render("scene.json", "small.png", {"--spp", "32"});
    int ofLarge = 0, ofSmall = 0;
    for (const char* name :
         {"scene-view-001.png", "scene-view-002.png", "scene-view-003.png", "scene-view-004.png"}) {
        const std::vector<uint8_t> bytes = readBytes(name);
        ofLarge += bytes == readBytes("large.png") ? 1 : 0;
        ofSmall += bytes == readBytes("small.png") ? 1 : 0;
    }
    EXPECT_EQ(ofLarge, 2);
    EXPECT_EQ(ofSmall, 2);
}

}  // namespace
}  // namespace glint::view::test::two_windows_test
