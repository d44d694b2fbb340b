// What a person does with mouse and keyboard, through the window system: xdotool moves the real ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "core/image_io.h"
#include "core/quantize.h"
#include "support.h"
#include "view/camera_control.h"
#include "view/files.h"

namespace glint::view::test::hand_test {
class Hand : public FolderTest {
  protected:
    Hand() { size_ = "640x480"; }
};

glm::dvec3 vectorOf(const Json& json) {
    return {json[0], json[1], json[2]};
}

// All at once, faster than a frame: no digit reaches the camera, and what is out of range is not taken.
TEST_F(Hand, TypedDigitsStayInTheSlider) {
    size_ = "640x640";
    const Ran ran = view(
        "set samples 1\nprint camera\nhand mousemove @exposure keydown ctrl click 1 keyup ctrl key 1 key 2 "
        "key 3 key Return\nexpect exposure 10\npress tracing\nwait 3\nhand mousemove @aim keydown ctrl click "
        "1 keyup ctrl key minus key 1 key 0 key 0 key Return\nexpect aim 8\nhand mousemove @fov keydown ctrl "
        "click 1 keyup ctrl key 5 key 0 key Return\nexpect fov 50\nprint camera\n");
    Json before = cameras(ran).at(0);
    before["fovY"] = 50.0;
    EXPECT_EQ(before, cameras(ran).at(1));
}

TEST_F(Hand, PlusAndMinusAlsoOnTheKeypad) {
    view(
        "hand key plus\nexpect exposure 0.5\nhand key KP_Add\nexpect exposure 1\nhand key equal\nexpect "
        "exposure 1.5\nhand key minus\nhand key KP_Subtract\nhand key KP_Subtract\nexpect exposure 0\n");
}

// The focus distance goes along the view direction: the middle of the picture looks at the sphere's front.
TEST_F(Hand, ControlClickFocuses) {
    const Ran ran = view(
        "set samples 1\nkey H\nset lens 0.1\nhand mousemove @230,240 keydown ctrl click 1 keyup ctrl\nhand "
        "mousemove @230,240 click 1\nprint camera\n");
    const std::vector<double> fields = csvRows(ran.out.substr(0, ran.out.find("camera"))).at(0);
    ASSERT_GE(fields.size(), 9u) << ran.out;
    const Json camera = cameras(ran).at(0);
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
        "mousemove @10,175 mousedown 1 mousemove @40,175 mousemove @80,175 mouseup 1\nexpect verdict "
        "none\nkey R\nsettle\nkey S\nsettle\nkey V\nsettle\nwait 2\nexpect verdict passed\nhand mousemove "
        "@10,175 click 4\nexpect verdict none\nhand mousemove @20,150 click 1\nwait 1\nprint pick\nhand "
        "mousemove @10,175 click 4\nexpect pick none\n");
    EXPECT_HAS(ran.out, "pick ");
    EXPECT_EQ(readBytes("scene-view-001.png"), readBytes("scene-view-002.png"))
        << "as before V, after it and a drag";
    EXPECT_HAS(ran.out, "% eye: /objects/");
}

TEST_F(Hand, TheWheelStaysNearTheScene) {
    const Ran ran = view(
        "set samples 1\nkey H\nhand mousemove @320,240 click --repeat 400 --delay 1 5\nprint camera\nhand "
        "click --repeat 900 --delay 1 4\nprint camera\n");
    const auto distance = [&](size_t i) {
        const Json c = cameras(ran).at(i);
        return glm::length(vectorOf(c["eye"]) - vectorOf(c["target"]));
    };
    EXPECT_GT(distance(0), 1e3);
    EXPECT_LT(distance(0), 1e6);
    EXPECT_LT(distance(1), 1e-2);
    EXPECT_GT(distance(1), 1e-6);
}

TEST_F(Hand, HelpScrollsInASmallWindow) {
    size_ = "320x240";
    view(
        "set samples 1\nsettle\nhand mousemove @160,120\nhand key F1\nwait 3\nwindow top.png\nhand click 5 "
        "click 5\nwait 4\nwindow below.png\nhand click 4 click 4 click 4\nwait 4\nwindow again.png\n");
    EXPECT_NE(readBytes("below.png"), readBytes("top.png"));
    EXPECT_EQ(readBytes("again.png"), readBytes("top.png"));
}

TEST_F(Hand, ThePanelLeavesThePictureFree) {
    const Ran ran = view("set samples 1\nwait 3\nprint covered\nhand key h\nexpect covered 0.000\n");
    EXPECT_LT(std::stod(printed(ran, "covered").at(0)), 0.25);
}

// A color typed slowly, as the screen shows it; undo takes it back whole and leaves the camera.
TEST_F(Hand, UndoAndRedoOfAColor) {
    size_ = "640x760";
    const Ran ran = view(
        "set samples 1\nwait 4\nhand key Left\nwait 2\nprint camera\nhand mousemove @diffuse_hex click "
        "--repeat 2 1\nhand key ctrl+a\nhand key numbersign key 2 key 0\nidle 0.6\nhand key c key 0 key 4 "
        "key 0 key Return\nsettle\nhand key c\nhand key ctrl+z\nsettle\nprint camera\nhand key c\nhand "
        "key ctrl+y\nsettle\nhand key c\n");
    const std::vector<Json> materials = copied(ran, "materials");
    ASSERT_EQ(materials.size(), 2u) << ran.out;
    EXPECT_EQ(materials[0], materials[1]);
    const Json one = materials[0]["one"];
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
    EXPECT_STARTS(printed(ran, "pixel").at(0), expected) << "; rendered: " << expected;
}

// With Ctrl+Q right behind S the picture is there, whole, and nobody had to wait for it.
TEST_F(Hand, QuittingFinishesTheSave) {
    view("set samples 1\nstay\nhand key alt+s key ctrl+q\n", "--spp 4");
    expectRendered("scene-view-001.png", "scene.json", "--spp 4");
}

// The dialog has the keyboard each time, and one Esc closes it. A typed name lies in the folder shown.
TEST_F(Hand, ATypedPathIsOpened) {
    std::filesystem::create_directory("shown");
    for (int depth : {0, 1, 2}) {
        scene_["maxDepth"] = depth;
        write("shown/" + std::to_string(depth) + ".json", scene_);
    }
    view(
        "set samples 1\ndrop shown/2.json shown/0.json\nawait depth 0\nhand key ctrl+o\nwait 3\nhand type "
        "shown/1.json\nhand key Return\nawait depth 1\nhand key ctrl+o\nwait 3\nhand key Escape\nwait "
        "3\nhand key ctrl+o\nwait 3\npress shown/\nhand key "
        "Escape\nhand key ctrl+o\nwait 3\nhand type 2.json\nhand key Return\nawait depth 2\n");
}

TEST_F(Hand, ASaveThatFailsIsSaid) {
    const Ran ran = view(
        "set samples 1\nsettle\npress save_and_open\nwait 3\npress save_as\nwait 3\nhand type "
        "nowhere/a.png\nhand key Return\nsettle\nstay\nhand key ctrl+q\n");
    EXPECT_HAS(ran.err, "nowhere/a.png");
}

// ---- what is seen is what is saved ----

TEST_F(Hand, SavesWhatIsSeen) {
    const Ran ran = view(
        "set samples 4\nhand key h\nset exposure 1.5\nset tonemap aces\nsettle\nwindow color.png\nhand key "
        "s\nsettle\naov normal\nkey Esc\nsettle\nwait 2\nwindow normal.png\nhand key s\nsettle\n");
    EXPECT_EQ(readBytes("scene-view-001.png"), readBytes("color.png"));
    EXPECT_EQ(readBytes("scene-view-002.png"), readBytes("normal.png"));
    EXPECT_HAS(ran.out, "as seen: 4 samples");
}

TEST_F(Hand, SavesLayersAsSeen) {
    size_ = "240x180";
    view("set samples 1\nsettle\nhand key shift+s\nsettle\n");
    expectRendered("scene-view-001.exr", "scene.json", {"--aov", kLayers});
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
    const Ran ran = view("set samples 1\nstay\nhand key alt+s key ctrl+q key ctrl+q\n", "--spp 4096", 1);
    EXPECT_HAS(ran.err, "before the image was saved");
    EXPECT_FALSE(std::filesystem::exists("scene-view-001.png"));
}

// ---- the panel and the overlays on the image: many things in one window ----

// Ctrl+click on a slider, and a number.
std::string typed(const std::string& control, const std::string& number) {
    return "hand mousemove @" + control + " keydown ctrl click 1 keyup ctrl\nhand key ctrl+a\nhand type " +
           number + "\nhand key Return\n";
}

std::string pressed(const std::string& control) {
    return "hand mousemove @" + control + " click 1\n";
}

std::string chosen(const std::string& control, const std::string& value) {
    return pressed(control) + pressed(value);
}

class ByHand : public FolderTest {};

// ---- reload ----

// After a reload, the window takes the camera and all unchanged settings from the file. A depth set in the
// panel stays until the panel resets it.
TEST_F(ByHand, WhatThePanelHasMovedStaysOnReload) {
    size_ = "400x1000";
    scene_["camera"]["eye"] = {3, 2.5, 6};
    const auto writeWith = [&](const std::string& file, int depth, const Json& background) {
        scene_["maxDepth"] = depth;
        scene_["background"] = background;
        write(file, scene_);
    };
    writeWith("one.json", 1, {0.1, 0.8, 0.2});
    writeWith("four.json", 4, {0.9, 0.2, 0.1});
    writeWith("two-of-four.json", 2, {0.9, 0.2, 0.1});
    view("set samples 1\n" + pressed("tracing") +
         "settle\ncopy one.json scene.json\nreload\nexpect depth 1\nhand key alt+s\nsettle\n" +
         typed("depth", "2") +
         "expect depth 2\ncopy four.json scene.json\nreload\nexpect depth 2\nhand key alt+s\nsettle\nhand "
         "key F5\nsettle\nexpect depth 2\n" +
         pressed("reset_tracing") + "expect depth 4\nhand key alt+s\nsettle\n");
    int number = 0;
    for (const char* file : {"one.json", "two-of-four.json", "four.json"})
        expectRendered("scene-view-00" + std::to_string(++number) + ".png", file);
}

// ---- everything in the panel ----

// Methods, lens, lights and materials: Alt+S renders the image of a file with the JSON of C, with those
// options and the file's own sampling. The material is the picked one.
TEST_F(ByHand, ThePanelChangesThePicture) {
    size_ = "640x1000";
    scene_["image"].update({{"samplesPerPixel", 4}, {"sampler", "jittered"}, {"filter", "tent"}});
    write("scene.json", scene_);
    const Ran ran =
        view("set samples 1\n" + pressed("lights") + pressed("materials") + pressed("tracing") +
             "settle\nhand mousemove @420,470 click 1\nexpect object 1\nhand key Escape\n" +
             chosen("triangles", "barycentric") + chosen("spheres", "algebraic") + typed("depth", "2") +
             pressed("tracing") + pressed("lights") + typed("0_point", "0.5") + pressed("lights") +
             pressed("materials") + typed("shininess", "12") + chosen("glass_shadows", "full") +
             pressed("materials") + pressed("camera") + typed("radius", "0.125") + pressed("camera") +
             "settle\nhand key alt+s\nsettle\nhand key c\n");
    scene_["camera"] = cameras(ran).at(0);
    scene_["lights"] = copied(ran, "lights").at(0);
    EXPECT_EQ(scene_["camera"]["lensRadius"], 0.125);
    EXPECT_EQ(copied(ran, "materials").at(0), Json({{"mirror", {{"shininess", 12.0}}}}));
    EXPECT_EQ(scene_["lights"][0]["intensity"], Json({0.35, 0.35, 0.35}));
    scene_["materials"]["mirror"]["shininess"] = 12;
    write("changed.json", scene_);
    const Words options = "--intersector barycentric --sphere algebraic --max-depth 2";
    expectRendered("scene-view-001.png", "changed.json", options);
    render("scene.json", "before.png", options);
    EXPECT_NE(readBytes("before.png"), readBytes("scene-view-001.png"));
}

// ---- over the picture ----

// A circle about the picked pixel and lines along its rays, which a box of the panel takes away; a tooltip
// for the control under the mouse; the magnifier's squares have the pixel's colour.
TEST_F(ByHand, MarksTipsAndTheMagnifier) {
    size_ = "800x600";
    const Ran ran = view(
        "set samples 1\nsettle\nexpect tip none\nhand mousemove @exposure\nexpect tip brighter or darker, in "
        "powers of two (- and +)\nhand mousemove @790,590\nexpect tip none\nwindow plain.png\nhand mousemove "
        "@440,330 click 1\nexpect object 1\nhand mousemove @790,590\nwindow marked.png\npress "
        "draw_rays\nhand mousemove @790,590\nwindow circle.png\nkey Esc\nkey I\nhand mousemove "
        "@300,500\nsettle\nwait 3\nwindow inspector.png\nprint pixel\n");
    const Image plain = readImage("plain.png"), marked = readImage("marked.png"),
                circle = readImage("circle.png");
    const auto differ = [&](const Image& a, const Image& b, int x0, int y0, int x1, int y1) {
        int count = 0;
        for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x) count += pixelOf(a, x, y) == pixelOf(b, x, y) ? 0 : 1;
        return count;
    };
    EXPECT_GT(differ(plain, circle, 430, 320, 451, 341), 20) << "the circle";
    EXPECT_EQ(differ(plain, circle, 240, 350, 800, 590), 0) << "and nothing below it";
    EXPECT_GT(differ(marked, circle, 240, 250, 560, 590), 20) << "the reflected ray's line";
    // Nine squares in 11 lines of 14 pixels: 17 pixels each.
    const Image inspector = readImage("inspector.png");
    const Rgb own = pixelOf(inspector, 300, 500);
    int longest = 0;
    for (int y = 300; y < 600; ++y) {
        int run = 0;
        for (int x = 560; x < 800; ++x) {
            run = pixelOf(inspector, x, y) == own ? run + 1 : 0;
            longest = std::max(longest, run);
        }
    }
    EXPECT_GE(longest, 12) << "a pixel is so large";
    EXPECT_STARTS(printed(ran, "pixel").at(0), "300 500  ");
}

// Held keys fly, the mouse looks around from the same eye, right and middle button dolly and pan.
TEST_F(ByHand, FliesAndMoves) {
    size_ = "640x480";
    const Ran ran = view(
        "set samples 1\nsettle\nprint camera\nhand key Tab\nhand keydown w\nwait 6\nhand keyup w\nprint "
        "camera\nhand mousemove @400,240 mousedown 1 mousemove @430,240 mousemove @460,240 mouseup 1\nprint "
        "camera\nkey Tab\nkey R\nprint camera\nhand mousemove @400,240 mousedown 2 mousemove @420,240 "
        "mousemove @440,240 mouseup 2\nprint camera\nkey R\nhand mousemove @400,240 mousedown 3 mousemove "
        "@400,260 mousemove @400,300 mouseup 3\nprint camera\n");
    const std::vector<Json> c = cameras(ran);
    EXPECT_LT(c.at(1)["eye"][2], c.at(0)["eye"][2]) << "forward";
    EXPECT_EQ(c.at(2)["eye"], c.at(1)["eye"]) << "looking around";
    EXPECT_NE(c.at(2)["target"], c.at(1)["target"]);
    EXPECT_EQ(c.at(3), c.at(0));
    EXPECT_NE(c.at(4)["target"], c.at(0)["target"]) << "panned";
    EXPECT_EQ(c.at(5)["target"], c.at(0)["target"]) << "farther";
    EXPECT_GT(c.at(5)["eye"][2], c.at(0)["eye"][2]);
}

// Left of the wipe's line is the kept image. All layers are saved as EXR under a typed name, and replaced.
TEST_F(ByHand, TheWipeIsDraggedAndAPictureNamed) {
    size_ = "640x480";
    view(
        "set samples 1\nkey H\nsettle\nkey K\nkey 5\nkey B\nsettle\nwait 2\nhand mousemove @320,240 "
        "mousedown 1 mousemove @330,240 mousemove @480,240 mouseup 1\nwait 2\nwindow wipe.png\nexpect pick "
        "none\nkey Esc\nkey R\nhand key ctrl+shift+s\nwait 3\nhand type chosen.exr\nhand key "
        "Return\nsettle\nhand key ctrl+shift+s\nwait 3\nhand key Return\nwait 3\nexpect toast "
        "exists\npress replace_the_file\npress save\nsettle\nexpect toast saved\n");
    const Image wipe = readImage("wipe.png");
    EXPECT_EQ(pixelOf(wipe, 480, 300), (Rgb{255, 255, 255}));
    render("scene.json", "own.png");
    const Image own = readImage("own.png");
    EXPECT_EQ(pixelOf(wipe, 400, 300), pixelOf(own, 400, 300)) << "the kept one";
    expectRendered("chosen.exr", "scene.json", {"--aov", kLayers});
}

}  // namespace glint::view::test::hand_test
