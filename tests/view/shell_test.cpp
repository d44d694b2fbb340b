// The window's shell: lens and cameras, layers, comparison, messages, sizes.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "core/image_diff.h"
#include "core/image_io.h"
#include "support.h"

namespace glint::view::test::shell_test {
class Shell : public FolderTest {};

// ---- the camera goes through unchanged ----

TEST_F(Shell, EveryFieldOfTheCameraGoesThrough) {
    const Json all = Json::parse(R"([
        {"type": "perspective", "eye": [0, 1.5, 7], "target": [0, 0.8, 0], "up": [0, 1, 0], "fovY": 45.0,
         "near": 0.5, "far": 30.0, "lensRadius": 0.15, "focusDistance": 6.25},
        {"type": "perspective", "eye": [0, 1.5, 7], "target": [0, 0.8, 0], "up": [0, 1, 0],
         "planeNormal": [0, 0.1, 1], "window": [-0.5, 0.6, -0.4, 0.3]},
        {"type": "orthographic", "eye": [0, 1.5, 7], "target": [0, 0.8, 0], "up": [0, 1, 0],
         "planeNormal": [0, 0, 1], "height": 5.0, "near": 1.0}])");
    for (const Json& camera : all) {
        scene_["camera"] = camera;
        write("scene.json", scene_);
        const Ran ran = view("key C\nwait 2\nkey alt+S\nsettle\n", "--spp 4");
        const Json copied = cameras(ran).at(0);
        for (const auto& [key, value] : camera.items()) EXPECT_EQ(copied[key], value) << key;
        scene_["camera"] = copied;
        write("copied.json", scene_);
        expectRendered("scene-view-001.png", "scene.json", "--spp 4");
        expectRendered("scene-view-001.png", "copied.json", "--spp 4");
        std::filesystem::remove("scene-view-001.png");
    }
}

// At rest the lens is seen: what is out of focus is blurred as in the rendered picture, up to the noise of
// the samples, and not as through a pinhole.
TEST_F(Shell, TheLensIsSeen) {
    scene_["camera"]["lensRadius"] = 0.4;
    scene_["camera"]["focusDistance"] = 3.0;
    write("scene.json", scene_);
    view("set samples 16\nkey H\nsettle\nkey S\nsettle\n");
    render("scene.json", "lens.png", "--spp 128");
    scene_["camera"]["lensRadius"] = 0;
    write("pinhole.json", scene_);
    render("pinhole.json", "pinhole.png", "--spp 16");
    const Image shown = readImage("scene-view-001.png");
    const double toLens = compareImages(shown, readImage("lens.png"), 0).rmse;
    const double toPinhole = compareImages(shown, readImage("pinhole.png"), 0).rmse;
    EXPECT_LT(3 * toLens, toPinhole) << toLens << " " << toPinhole;
}

// ---- layers ----

TEST_F(Shell, SwitchingLayersTracesNothingAgain) {
    const Ran ran = view(
        "set samples 2\nsettle\nidle 0.2\nprint submissions\nkey L\nkey L\nexpect layer normal\nkey "
        "shift+L\nkey shift+L\nkey shift+L\nexpect layer cost\nkey L\nexpect layer color\nidle 0.2\nprint "
        "submissions\nprint samples\n");
    const std::vector<std::string> counts = printed(ran, "submissions");
    ASSERT_EQ(counts.size(), 2u);
    EXPECT_EQ(counts[0], counts[1]);
    EXPECT_EQ(printed(ran, "samples").at(0), "2");
}

// ---- comparison ----

TEST_F(Shell, APictureEqualsItself) {
    view(
        "set samples 1\nkey H\nsettle\nsave before.png\nkey K\nkey B\nwait 3\nexpect figures 0\nsave "
        "wipe.png\nkey B\nwait 3\nsave difference.png\nkey B\nkey B\nwait 2\nsave after.png\n");
    EXPECT_EQ(readBytes("before.png"), readBytes("after.png"));
    const Image difference = readImage("difference.png");
    EXPECT_EQ(*std::max_element(difference.pixels.begin(), difference.pixels.end()), 0.0f);
    const Image wipe = readImage("wipe.png"), before = readImage("before.png");
    EXPECT_EQ(pixelOf(wipe, 120, 90), (Rgb{255, 255, 255}));  // the line
    EXPECT_EQ(pixelOf(wipe, 60, 90), pixelOf(before, 60, 90));
}

TEST_F(Shell, AComparisonSaysWhatItWaitsFor) {
    const Ran ran = view(
        "set samples 1\nkey H\nsettle\nkey K\nset samples 100000\nkey B\nexpect waiting none\nkey B\nprint "
        "waiting\nset samples 1\nsettle\nwait 2\nexpect waiting none\n");
    EXPECT_STARTS(printed(ran, "waiting").at(0), "difference: waiting for the last sample (");
}

TEST_F(Shell, ADroppedPictureIsComparedWith) {
    scene_["background"] = {0.9, 0.1, 0.1};
    write("red.json", scene_);
    render("red.json", "red.png");
    const Ran ran = view(
        "set samples 1\nkey H\nsettle\ndrop red.png\nwait 3\nsave wipe.png\nprint figures\nkey B\nwait "
        "2\nkey H\nkey Shift+H\nsettle\nwait 2\nexpect waiting difference not shown: the images differ in "
        "size\n");
    const Image wipe = readImage("wipe.png"), red = readImage("red.png");
    EXPECT_EQ(pixelOf(wipe, 3, 3), pixelOf(red, 3, 3));
    EXPECT_NE(pixelOf(wipe, 236, 3), pixelOf(red, 236, 3));
    EXPECT_GT(std::stod(printed(ran, "figures").at(0)), 0.05);
}

// The same samples in double, with an error target those of both replicates: only edges differ.
TEST_F(Shell, TheReferenceDrawsTheSame) {
    size_ = "400x800";
    for (const Words options : {"", "--error 0.01 --within-depth"}) {
        const Ran ran = view(
            "set samples 2\nsettle\npress compare\nwait 3\npress reference\nsettle\nwait 5\nprint figures\n",
            options);
        EXPECT_LT(std::stod(printed(ran, "figures").at(0)), 2e-3);
        EXPECT_GT(std::stod(printed(ran, "figures").at(0)), 0);
    }
}

// Each of the two is seen in its turn, and nothing else.
TEST_F(Shell, FlickerShowsOneAfterTheOther) {
    scene_["background"] = {0.9, 0.1, 0.1};
    write("red.json", scene_);
    render("red.json", "red.png");
    render("scene.json", "own.png");
    std::string script =
        "set samples 1\nkey H\nsettle\nsave own-seen.png\ndrop red.png\nkey B\nkey B\nkey Esc\nkey B\nkey "
        "B\nkey B\nwait 3\n";
    for (int i = 0; i < 8; ++i) script += "save " + std::to_string(i) + ".png\nidle 0.2\n";
    view(script);
    std::set<std::vector<uint8_t>> seen;
    for (int i = 0; i < 8; ++i) seen.insert(readBytes(std::to_string(i) + ".png"));
    EXPECT_EQ(seen.size(), 2u);
    EXPECT_EQ(seen.count(readBytes("own-seen.png")), 1u);
    EXPECT_EQ(seen.count(readBytes("red.png")), 1u);
}

// ---- other scenes ----

TEST_F(Shell, ADroppedSceneIsOpened) {
    scene_["camera"]["eye"] = {3, 2, 6};
    scene_["maxDepth"] = 1;
    write("other.json", scene_);
    view(
        "set samples 1\nkey Left\nset depth 7\ndrop other.json\nsettle\nexpect depth 1\nscreenshot "
        "shot.png\ndrop broken.json\nsettle\nexpect fault broken.json\nscreenshot still.png\n");
    expectRendered("shot.png", "other.json");
    expectRendered("still.png", "other.json");
}

TEST_F(Shell, ASceneAndAnImageAreDroppedTogether) {
    scene_["maxDepth"] = 1;
    write("other.json", scene_);
    render("scene.json", "before.png");
    const Ran ran =
        view("set samples 1\ndrop other.json before.png\nawait depth 1\nsettle\nwait 3\nprint figures\n");
    EXPECT_LT(std::stod(printed(ran, "figures").at(0)), 0.1);
}

// By its list: the folder of the scene, and what can be opened there.
TEST_F(Shell, ASceneIsOpenedFromTheList) {
    size_ = "640x480";
    scene_["maxDepth"] = 1;
    write("other.json", scene_);
    view("set samples 1\nkey ctrl+O\nwait 3\npress other.json\nsettle\nexpect depth 1\n");
}

// One window remembers what another one has shown, in its list and its panel.
TEST_F(Shell, ASceneIsOpenedThatWasSeenBefore) {
    size_ = "640x480";
    std::filesystem::create_directory("elsewhere");
    scene_["maxDepth"] = 1;
    write("elsewhere/other.json", scene_);
    ASSERT_EQ(runGlint({"view", "elsewhere/other.json", "--size", size_, "--frames", "2"}).code, 0);
    view(
        "set samples 1\nkey ctrl+O\nwait 3\npress recent_other.json\nsettle\nexpect depth 1\npress "
        "save_and_open\nwait 3\npress recent_scene.json\nsettle\nexpect depth 3\n");
}

// What was changed in a group goes back to the file's, group by group.
TEST_F(Shell, ResetsGiveTheFileBack) {
    size_ = "400x1000";  // the whole panel is seen
    view(
        "set samples 1\nwait 3\npress lights\nwait 2\npress materials\nwait 2\npress tracing\nwait 2\nset "
        "exposure 2\nset tonemap aces\nwait 3\npress reset_view\nexpect exposure 0\nexpect tonemap "
        "linear\nset depth 0\nset reflections off\nset background 1 0 0\nwait 3\npress reset_tracing\nexpect "
        "depth 3\npress tracing\nwait 3\npress lights\nset light 0 0.5\nwait 3\npress reset_lights\npress "
        "materials\nset diffuse two 1 1 1\nwait 3\npress reset_materials\nsettle\nkey 5\nkey [\npress "
        "camera\nwait 3\npress scene's\nwait 3\nscreenshot shot.png\n",
        "--spp 4");
    expectRendered("shot.png", "scene.json", "--spp 4");
}

// ---- messages, sizes ----

TEST_F(Shell, ProgressIsSeenWithoutThePanel) {
    const Ran ran = view(
        "set samples 1\nkey H\nsettle\nexpect covered 0.000\nhand key alt+s\nwait 3\nprint "
        "covered\nstay\nhand key ctrl+q key ctrl+q\n",
        "--spp 4096", 1);
    EXPECT_GT(std::stod(printed(ran, "covered").at(0)), 0.05);
}

TEST_F(Shell, MessagesGoAwayByThemselves) {
    view(
        "set samples 1\nsettle\nkey C\nwait 2\nexpect toast copied as scene JSON: camera\nidle 6\nexpect "
        "toast none\n");
}

// At twice the size letters are rasterized again. If pixels were doubled, no aligned square of two by two
// pixels would hold two colours.
TEST_F(Shell, LettersAreSharpAtTwiceTheSize) {
    size_ = "640x480";
    view("set samples 1\nkey F1\nwait 4\nwindow help.png\n", "--scale 2");
    const Image image = readImage("help.png");
    int mixed = 0;
    for (int y = 0; y + 1 < 30; y += 2)  // the heading
        for (int x = 0; x + 1 < 400; x += 2) {
            const std::set<int> reds = {pixelOf(image, x, y).r, pixelOf(image, x + 1, y).r,
                                        pixelOf(image, x, y + 1).r, pixelOf(image, x + 1, y + 1).r};
            mixed += reds.size() > 1 ? 1 : 0;
        }
    EXPECT_GT(mixed, 200);
}

TEST_F(Shell, BuildQualityIsUsed) {
    const std::string hall = glint::test::sourcePath("scenes/arcade.json");
    std::set<std::string> costs;
    for (const char* quality : {"fast", "default"}) {
        const Ran ran =
            runView({hall, "--size", size_, "--build-quality", quality}, parseScript("print tree", "tree"));
        ASSERT_EQ(ran.code, 0) << ran.err;
        costs.insert(printed(ran, "tree").at(0));
    }
    EXPECT_EQ(costs.size(), 2u);
}

// In glass every ray is named by what the surface did, and hangs below the one that it comes from.
TEST_F(Shell, ThePickIsATreeOfRays) {
    scene_["materials"]["one"] = {{"transmission", 1}, {"ior", 1.5}};
    write("scene.json", scene_);
    const Ran ran = view("set samples 1\nkey H\nhand mousemove @70,90 click 1\nprint pick\n");
    EXPECT_HAS(ran.out, "% eye: /objects/0");
    EXPECT_HAS(ran.out, "\n  ");
    EXPECT_HAS(ran.out, "% transmitted: ");
    EXPECT_HAS(ran.out, "% reflected: ");
    double sum = 0;
    std::istringstream lines(ran.out.substr(ran.out.find("pick ") + 5));
    for (std::string line; std::getline(lines, line);) {
        double share = 0;
        if (std::sscanf(line.c_str(), " %lf %%", &share) == 1) sum += share;
    }
    EXPECT_NEAR(sum, 100, 1.5);  // each is rounded to a tenth
}

}  // namespace glint::view::test::shell_test
