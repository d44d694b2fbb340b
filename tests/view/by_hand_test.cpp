// The panel and what lies over the picture, worked by the real mouse and keyboard: many things in one window.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/image_io.h"
#include "support.h"

namespace glint::view::test::by_hand_test {
using Json = nlohmann::json;

// Ctrl+click on a slider, and a number.
std::string typed(const std::string& control, const std::string& number) {
    return "hand mousemove @" + control + " keydown ctrl click 1 keyup ctrl\nhand key ctrl+a\nhand type " +
           number + "\nhand key Return\n";
}

std::string chosen(const std::string& control, const std::string& value) {
    return "press " + control + "\npress " + value + "\n";
}

class ByHand : public FolderTest {
  protected:
    ByHand() { byHand_ = true; }
    Json scene_ = Json::parse(sceneText());

    // What the last C printed.
    static Json copied(const Ran& ran) {
        const size_t from = ran.out.rfind("\"camera\": ");
        size_t to = ran.out.find("\n", from);
        while (to != std::string::npos && ran.out[to - 1] == ',') to = ran.out.find("\n", to + 1);
        return Json::parse("{" + ran.out.substr(from, to - from) + "}");
    }
};

// ---- reload ----

// The user moves the depth in the panel: it stays while all else follows the file, until it is given back.
TEST_F(ByHand, WhatThePanelHasMovedStaysOnReload) {
    size_ = "400x1000";
    const auto write = [&](const std::string& file, int depth, const Json& background) {
        scene_["maxDepth"] = depth;
        scene_["background"] = background;
        writeText(file, scene_.dump());
    };
    write("one.json", 1, {0.1, 0.8, 0.2});
    write("four.json", 4, {0.9, 0.2, 0.1});
    write("two-of-four.json", 2, {0.9, 0.2, 0.1});
    view(
        "set samples 1\npress tracing\nwait 2\nsettle\ncopy one.json scene.json\nreload\nexpect depth 1\nkey "
        "alt+S\nsettle\n" +
            typed("depth", "2") +
            "expect depth 2\ncopy four.json scene.json\nreload\nexpect depth 2\nkey alt+S\nsettle\nkey "
            "F5\nsettle\nexpect depth 2\npress reset_tracing\nexpect depth 4\nkey alt+S\nsettle\n",
        {"--spp", "1"});
    int number = 0;
    for (const char* file : {"one", "two-of-four", "four"}) {
        render(std::string(file) + ".json", std::string(file) + ".png");
        EXPECT_EQ(readBytes("scene-view-00" + std::to_string(++number) + ".png"),
                  readBytes(std::string(file) + ".png"))
            << file;
    }
}

// ---- everything in the panel ----

// Methods, sampling, lens, lights and materials: the picture is that of a file with what C has copied, drawn
// with those options. The material is the one that was picked.
TEST_F(ByHand, ThePanelChangesThePicture) {
    size_ = "640x1000";
    const Ran ran = view(
        "set samples 1\npress lights\nwait 2\npress materials\nwait 2\npress tracing\nwait 2\nsettle\nclick "
        "420 470\nexpect object 1\nkey Esc\n" +
        chosen("triangles", "barycentric") + chosen("spheres", "algebraic") + typed("depth", "2") +
        "press tracing\nwait 2\npress sampling\nwait 2\n" + typed("per_pixel", "4") +
        chosen("sampler", "jittered") + chosen("filter", "tent") +
        "press sampling\nwait 2\npress lights\nwait 2\n" + typed("0_point", "0.5") +
        "press lights\nwait 2\npress materials\nwait 2\n" + typed("shininess", "12") +
        chosen("glass_shadows", "full") + "press materials\nwait 2\npress camera\nwait 2\n" +
        typed("radius", "0.125") + "press camera\nwait 2\nsettle\nkey alt+S\nsettle\nkey C\n");
    const Json changed = copied(ran);
    EXPECT_EQ(changed["camera"]["lensRadius"], 0.125);
    EXPECT_EQ(changed["materials"], Json({{"mirror", {{"shininess", 12.0}}}}));
    EXPECT_EQ(changed["lights"][0]["intensity"], Json({0.35, 0.35, 0.35}));
    scene_["camera"] = changed["camera"];
    scene_["lights"] = changed["lights"];
    scene_["materials"]["mirror"]["shininess"] = 12;
    writeText("changed.json", scene_.dump());
    const std::vector<std::string> options = {"--intersector", "barycentric", "--sphere",    "algebraic",
                                              "--spp",         "4",           "--sampler",   "jittered",
                                              "--filter",      "tent",        "--max-depth", "2"};
    render("changed.json", "changed.png", options);
    EXPECT_EQ(readBytes("scene-view-001.png"), readBytes("changed.png"));
    render("scene.json", "before.png", options);
    EXPECT_NE(readBytes("before.png"), readBytes("changed.png"));
}

// ---- over the picture ----

// A circle about the picked pixel and lines along its rays, which a box of the panel takes away; a tooltip
// for the control under the mouse; the magnifier's squares have the pixel's colour.
TEST_F(ByHand, MarksTipsAndTheMagnifier) {
    size_ = "800x600";
    const Ran ran = view(
        "set samples 1\nsettle\nexpect tip none\nhand mousemove @exposure\nexpect tip brighter or darker, in "
        "powers of "
        "two (- and +)\nhand mousemove @790,590\nexpect tip none\nwindow plain.png\nhand mousemove @440,330 "
        "click "
        "1\nexpect object 1\nhand mousemove @790,590\nwindow marked.png\npress draw_rays\nhand mousemove "
        "@790,590\nwindow circle.png\nkey Esc\nkey I\nhand mousemove @300,500\nsettle\nwait 3\nwindow "
        "inspector.png\nprint pixel\nhand mousemove @zoom keydown ctrl click 1 keyup ctrl\nhand key "
        "ctrl+a\nhand type "
        "31\nhand key Return\nhand mousemove @300,500\nwait 3\nwindow finer.png\n");
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
    // A square of 9 in 11 lines of 13 pixels, or of 31: each pixel of the picture as a square.
    const Image inspector = readImage("inspector.png"), finer = readImage("finer.png");
    const Rgb own = pixelOf(inspector, 300, 500);
    const auto longestRun = [&](const Image& image) {
        int longest = 0;
        for (int y = 300; y < 600; ++y) {
            int run = 0;
            for (int x = 560; x < 800; ++x) {
                run = pixelOf(image, x, y) == own ? run + 1 : 0;
                longest = std::max(longest, run);
            }
        }
        return longest;
    };
    EXPECT_GE(longestRun(inspector), 12) << "a pixel is so large";
    EXPECT_GE(longestRun(finer), 3);
    EXPECT_LT(longestRun(finer), longestRun(inspector));
    EXPECT_EQ(printed(ran, "pixel").at(0).rfind("300 500  ", 0), 0u);
}

// Held keys fly, twice as fast at twice the speed, and the mouse looks around: the eye stays. Right and
// middle button dolly and pan.
TEST_F(ByHand, FliesAndMoves) {
    size_ = "640x480";
    const Ran ran = view(
        "set samples 1\nsettle\nprint camera\nkey Tab\nhold W 6\nprint camera\nhand mousemove @400,240 "
        "mousedown 1 mousemove "
        "@430,240 mousemove @460,240 mouseup 1\nprint camera\nkey Tab\nkey R\nprint camera\nhand mousemove "
        "@400,240 "
        "mousedown 2 mousemove @420,240 mousemove @440,240 mouseup 2\nprint camera\nkey R\nhand mousemove "
        "@400,240 mousedown 3 "
        "mousemove @400,260 mousemove @400,300 mouseup 3\nprint camera\n");
    const std::vector<Json> c = cameras(ran);
    EXPECT_LT(c.at(1)["eye"][2], c.at(0)["eye"][2]) << "forward";
    EXPECT_EQ(c.at(2)["eye"], c.at(1)["eye"]) << "looking around";
    EXPECT_NE(c.at(2)["target"], c.at(1)["target"]);
    EXPECT_EQ(c.at(3), c.at(0));
    EXPECT_NE(c.at(4)["target"], c.at(0)["target"]) << "panned";
    EXPECT_EQ(c.at(5)["target"], c.at(0)["target"]) << "farther";
    EXPECT_GT(c.at(5)["eye"][2], c.at(0)["eye"][2]);
}

// The wipe's line is dragged; what is right of it is this picture, left of it the kept one. Then all layers
// as EXR under a name that was typed.
TEST_F(ByHand, TheWipeIsDraggedAndAPictureNamed) {
    size_ = "640x480";
    view(
        "set samples 1\nkey H\nsettle\nkey K\nkey 5\nkey B\nsettle\nwait 2\nhand mousemove @320,240 "
        "mousedown 1 mousemove "
        "@330,240 mousemove @480,240 mouseup 1\nwait 2\nwindow wipe.png\nexpect pick none\nkey Esc\nkey "
        "R\nkey "
        "ctrl+shift+S\nwait 3\nhand type chosen.exr\nhand key Return\nsettle\n");
    const Image wipe = readImage("wipe.png");
    EXPECT_EQ(pixelOf(wipe, 480, 300), (Rgb{255, 255, 255}));
    render("scene.json", "own.png");
    const Image own = readImage("own.png");
    EXPECT_EQ(pixelOf(wipe, 400, 300), pixelOf(own, 400, 300)) << "the kept one";
    render("scene.json", "own.exr",
           {"--aov", "color,alpha,depth,position,normal,uv,object,primitive,material,bounces,cost"});
    EXPECT_EQ(readBytes("chosen.exr"), readBytes("own.exr"));
}

}  // namespace glint::view::test::by_hand_test
