// The window on a screen in memory, driven by scripts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/available_memory.h"
#include "core/error.h"
#include "core/image_io.h"
#include "driver.h"
#include "import/load.h"
#include "support.h"
#include "support/environment.h"
#include "view/display.h"
#include "view/session.h"
#include "view/view_scene.h"

namespace glint::view::test::window_test {
class Window : public FolderTest {};

TEST_F(Window, OpensLargeWithThePanelBesideTheImage) {
    const Ran ran =
        runView({"scene.json"}, parseScript("wait 3\nexpect size 1280 800\nprint picture\n", "script.txt"));
    ASSERT_EQ(ran.code, 0) << ran.err;
    int width = 0, height = 0;
    ASSERT_EQ(std::sscanf(printed(ran, "picture").at(0).c_str(), "%d %d", &width, &height), 2);
    EXPECT_LT(width, 1280);
    EXPECT_GT(width, 640);
    EXPECT_EQ(height, 800);
}

TEST_F(Window, WarningsOfLoadingStayUntilEsc) {
    writeText("scene.json",
              R"({"camera": {"eye": [0, 0, 5]}, "lights": [{"type": "point", "position": [0, 5, 5]}],
        "meshes": {"m": {"file": "m.obj"}}, "objects": [{"type": "mesh", "mesh": "m"}]})");
    writeText("m.obj", "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const Ran ran = view("wait 3\nexpect warnings 1\nkey Esc\nexpect warnings 0\n");
    EXPECT_HAS(ran.err, "glint: warning: m.obj:1: none.mtl: no such file");
}

TEST_F(Window, EscClosesAPicker) {
    size_ = "640x760";
    view(
        "set samples 1\nsettle\nhand mousemove @601,21\nwait 3\nwindow panel.png\npress diffuse\nhand "
        "mousemove @600,20\nwait 3\nwindow picker.png\nkey Esc\nwait 3\nwindow closed.png\n");
    EXPECT_NE(readBytes("picker.png"), readBytes("closed.png"));
    EXPECT_EQ(readBytes("closed.png"), readBytes("panel.png"));
}

// While a depth layer comes in row by row, those that are there have the greys that they will have at the
// end: the nearest and the farthest thing of the coarse image below them count too.
TEST_F(Window, RowsOfADataLayerAreNormalisedTogether) {
    constexpr int kWidth = 160, kHeight = 120;
    const gpu::Device device(gpu::DeviceOptions{});
    const auto scene = std::make_shared<ViewScene>(
        *packViewScene("scene.json", loadScene("scene.json"), BuildQuality::Default));
    Session session(device, scene);
    PictureSettings settings = session.settings();
    settings.layer = ViewLayer::Depth;
    session.apply(settings);
    session.setView(scene->scene.camera, kWidth, kHeight);
    ASSERT_TRUE(session.renderMoving(0.5, 1));
    std::vector<Canvas> partial;
    std::vector<int> rows;
    while (!session.finished()) {
        session.refine(1e-9, [] { return false; });  // the least piece
        partial.push_back(session.canvas({}));
        rows.push_back(static_cast<int>(std::lround(session.progress() * kHeight)));
    }
    ASSERT_GT(partial.size(), 10u);
    const Canvas& end = partial.back();
    for (size_t i = 0; i + 1 < partial.size(); ++i) {
        int worst = 0;
        for (int k = 0; k < rows[i] * kWidth; ++k) {
            const auto at = static_cast<size_t>(k);
            worst = std::max(worst, std::abs(static_cast<int>(partial[i].pixels[at] & 255u) -
                                             static_cast<int>(end.pixels[at] & 255u)));
        }
        EXPECT_LE(worst, 12) << rows[i] << " rows";
    }
}

TEST_F(Window, ScreenshotHasTheBytesOfRender) {
    view("wait 2\nscreenshot shot.png\nscreenshot shot.exr\n", "--spp 16");
    expectRendered("shot.png", "scene.json", "--spp 16");
    expectRendered("shot.exr", "scene.json", {"--spp", "16", "--aov", kLayers});
}

// A drag across the whole height turns the eye by 180 degrees, so 30 of 180 pixels to the right turn it by 30
// degrees: to the left, about the y axis through the target.
TEST_F(Window, DraggingOrbits) {
    const Ran ran = view("orbit 30 0\nkey C\n");
    const Json camera = cameras(ran).at(0);
    const double angle = 30 * M_PI / 180;
    EXPECT_NEAR(camera["eye"][0], -7 * std::sin(angle), 1e-4);
    EXPECT_NEAR(camera["eye"][1], 1.5, 1e-9);
    EXPECT_NEAR(camera["eye"][2], 7 * std::cos(angle), 1e-4);
    EXPECT_EQ(camera["target"], Json({0, 0.8, 0}));
    // What C prints is a camera that the scene format takes.
    scene_["camera"] = camera;
    write("turned.json", scene_);
    EXPECT_EQ(runGlint({"info", "turned.json"}).code, 0);
}

// Every kind of camera, in a scene that was loaded without it.
TEST_F(Window, EveryProjectionDrawsWhatItsJsonDraws) {
    for (int presses = 1; presses <= 3; ++presses) {
        std::string script;
        for (int i = 0; i < presses; ++i) script += "key P\n";
        const Ran ran = view(script + "orbit 25 10\nkey C\nscreenshot shot.png\n");
        scene_["camera"] = cameras(ran).at(0);
        write("turned.json", scene_);
        expectRendered("shot.png", "turned.json");
    }
}

// The tangent from distance d to a sphere of radius 1 makes the angle asin(1 / d) with its axis, which is
// half the field of view where the sphere fills the picture's height; a tenth is left as margin. The sphere
// is at -1.6f in the packed scene.
TEST_F(Window, FramesThePickedObject) {
    const Ran ran = view("key H\nclick 70 90\nexpect object 0\nkey F\nkey C\n");
    const Json camera = cameras(ran).at(0);
    EXPECT_EQ(camera["target"], Json({static_cast<double>(-1.6f), 1.0, 0.0})) << camera;
    double squared = 0;
    for (int c = 0; c < 3; ++c)
        squared += std::pow(camera["eye"][c].get<double>() - camera["target"][c].get<double>(), 2);
    EXPECT_NEAR(std::sqrt(squared), 1.1 / std::sin(22.5 * M_PI / 180), 1e-6);
}

TEST_F(Window, PicksWhatTraceFinds) {
    constexpr int kPlaces[][2] = {{70, 90}, {138, 80}, {185, 95}, {120, 170}, {5, 5}, {20, 120}};
    std::string script = "key H\n";
    std::string expected;
    for (const auto& [x, y] : kPlaces) {
        script += "key Esc\nclick " + std::to_string(x) + " " + std::to_string(y) + "\n";
        const Ran traced = runGlint("trace scene.json --size 240x180 --pixel",
                                    {std::to_string(x) + "," + std::to_string(y)});
        expected += traced.out;
        const std::vector<double> fields = csvRows(traced.out).at(0);
        script += "expect object " + (fields[0] == 1 ? describe(fields[4]) : "none") + "\n";
    }
    const Ran ran = view(script);
    EXPECT_EQ(ran.out, expected);
}

TEST_F(Window, FollowsItsSize) {
    view(
        "wait 2\nresize 320 200\nexpect size 320 200\nscreenshot wide.png\nclick 93 100\nresize 100 "
        "240\nwait 3\nscreenshot tall.png\n");
    size_ = "320x200";
    expectRendered("wide.png", "scene.json");
    size_ = "100x240";
    expectRendered("tall.png", "scene.json");
}

TEST_F(Window, SurvivesMinimising) {
    view("wait 2\nminimise 3\nwait 2\nexpect size 240 180\n");
}

TEST_F(Window, RestsAtNoCost) {
    const Ran ran = view("set samples 1\nsettle\nwait 3\nidle 2\n");
    double seconds = 0;
    unsigned long long frames = 0, rounds = 0;
    ASSERT_EQ(
        std::sscanf(ran.out.c_str(), "idle: %lf s, %llu frames, %llu rounds", &seconds, &frames, &rounds), 3)
        << ran.out;
    EXPECT_LE(frames, 3u);  // what was still due when the rest began
    EXPECT_LE(static_cast<double>(rounds),
              10 + 10 * seconds);  // 4 a second at rest; a loop that waits badly makes 200
}

TEST_F(Window, VerifiesTheView) {
    const Ran ran = view("orbit 20 10\nkey V\nsettle\nexpect verdict passed\nexpect difference off\n");
    EXPECT_HAS(ran.out, "verify passed: 43200 pixels");
}

TEST_F(Window, OpensALostDeviceAgainOnce) {
    view("wait 3\nlose-device\nwait 3\nscreenshot shot.png\n");
    expectRendered("shot.png", "scene.json");
    const Ran twice = view("lose-device\nwait 3\nlose-device\n", {}, 4);
    EXPECT_HAS(twice.err, "lost again");
}

// Before the device is opened, with both figures and what would fit.
TEST_F(Window, PicturesBeyondMemoryAreRefused) {
    Options options;
    options.scene = "scene.json";
    options.width = 640;
    options.height = 480;
    options.frames = 1;
    const uint64_t needed = 640 * 480 * Session::bytesPerPixel();
    std::string script;
    const auto answer = [&](uint64_t free) {
        options.memory = [free] { return free; };
        std::ostringstream out, err;
        return glint::test::errorOf(ErrorKind::Failed, [&] {
            Viewer viewer(options, out, err);
            Driver(viewer, parseScript(script, "grow.txt"), out, options.frames > 0).run();
        });
    };
    EXPECT_EQ(answer(needed / 4), "an image of 640x480 pixels takes " + gibibytes(needed) + " of memory, " +
                                      gibibytes(needed / 4) +
                                      " are free; ask for a smaller --size (320x240 fits)");
    EXPECT_EQ(answer(needed), "no error");
    // And when it grows, with what it has taken already.
    options.frames = 0;
    options.width = 64;
    options.height = 48;
    script = "wait 2\nresize 640 480\nwait 2\n";
    EXPECT_STARTS(answer(needed / 4), "an image of 640x480 pixels takes ");
    EXPECT_EQ(answer(needed - 64 * 48 * Session::bytesPerPixel()), "no error");
}

TEST_F(Window, WithoutADisplayNamesRender) {
    const glint::test::ScopedEnvironment noX("DISPLAY", nullptr), noWayland("WAYLAND_DISPLAY", nullptr);
    const Ran ran = runGlint({"view", "scene.json"});
    EXPECT_EQ(ran.code, 4);
    EXPECT_HAS(ran.err, "glint render");
    EXPECT_HAS(ran.err, "no display");
}

}  // namespace glint::view::test::window_test
