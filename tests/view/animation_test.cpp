// An animated scene in the window, by the real mouse and keys.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support.h"

namespace glint::view::test::animation_test {
class Animation : public FolderTest {
  protected:
    void animate(const Json& tracks, const std::string& file = "scene.json") {
        Json scene = scene_;
        scene["animation"]["tracks"] = tracks;
        write(file, scene);
    }
    const Json hop_ = {
        {"target", "/objects/0/center"}, {"times", {0, 2}}, {"values", {{-1.6, 1, 0}, {-1.6, 2, 0}}}};
    const Json turn_ = {{"target", "/camera/eye"}, {"times", {0, 2}}, {"values", {{0, 1.5, 7}, {2, 1.5, 7}}}};
};

// Frames by keys; the slider by the mouse and by typing; what is saved is what `glint render` draws of that
// moment, and the message says how to ask for it.
TEST_F(Animation, IsSteppedAndScrubbed) {
    size_ = "320x300";
    animate(Json::array({hop_, turn_}));
    const Ran ran = view(
        "set samples 1\nexpect time none\nhand key period\nsettle\nexpect time 0\nhand key period key "
        "period\nsettle\nexpect time 0.08333333333333333\nhand key comma\nsettle\nexpect time "
        "0.041666666666666664\nhand key alt+s\nsettle\nexpect toast glint render scene.json --time "
        "0.041666666666666664\nhand key s\nsettle\nhand key End\nsettle\nexpect time 2\nhand key "
        "period\nsettle\nexpect time 2\nhand key Home\nsettle\nexpect time 0\nhand mousemove @frame "
        "mousedown 1 mousemove_relative 20 0 mouseup 1\nsettle\nprint time\nhand mousemove @frame keydown "
        "ctrl click 1 keyup ctrl\nhand type 12\nhand key Return\nsettle\nexpect time 0.5\nhand mousemove "
        "@frame_on click 1\nsettle\nexpect time 0.5416666666666666\nhand mousemove @frame_back click "
        "1\nsettle\nexpect time 0.5\nkey Esc\nwait 4\nidle 0.5\n");
    expectRendered("scene-view-001.png", "scene.json", "--time 0.041666666666666664");
    render("scene.json", "first.png");
    EXPECT_NE(readBytes("first.png"), readBytes("scene-view-001.png"));
    const double scrubbed = std::stod(printed(ran, "time").at(0));
    EXPECT_GT(scrubbed, 0.2);
    EXPECT_LT(scrubbed, 1.9);
    double seconds = 0;
    unsigned long long frames = 99;
    const size_t idle = ran.out.find("idle: ");
    ASSERT_EQ(std::sscanf(ran.out.c_str() + idle, "idle: %lf s, %llu frames", &seconds, &frames), 2);
    EXPECT_LE(frames, 3u) << "paused, it costs nothing";
}

// Space plays and pauses; without the loop it stops at the end. A camera that moves alone needs no tree. What
// the user has moved stays.
TEST_F(Animation, IsPlayed) {
    animate(Json::array({turn_}));
    const Ran ran = view(
        "set samples 1\nsettle\nprint built\nhand key space\nawait playing on\nhand sleep 1.3\nprint "
        "time\nhand key space\nexpect playing off\nsettle\nprint time\nprint built\nprint camera\nscreenshot "
        "shown.png\npress loop\nhand key End\nhand key space\nawait playing off\nsettle\nexpect time 2\nhand "
        "key Left\nwait 2\nprint camera\nhand key Home\nsettle\nexpect time 0\nprint camera\nhand key "
        "r\nsettle\nprint camera\n");
    const std::vector<std::string> times = printed(ran, "time"), built = printed(ran, "built");
    const std::vector<Json> c = cameras(ran);
    EXPECT_GT(std::stod(times.at(0)), 0);
    EXPECT_EQ(built.at(0), built.at(1));
    EXPECT_NEAR(c.at(0)["eye"][0], std::stod(times.at(1)), 1e-12) << "a unit a second";
    expectRendered("shown.png", "scene.json", {"--time", times.at(1)});
    EXPECT_EQ(c.at(1), c.at(2)) << "the user's";
    EXPECT_EQ(c.at(3)["eye"], Json({0, 1.5, 7})) << "the file's";
}

// The file is loaded again at the moment that is shown; a moment at fault is said, and not shown; a scene
// without animation says so. What the panel has changed is not moved.
TEST_F(Animation, KeepsItsMoment) {
    animate(Json::array({hop_}), "other.json");
    Json shrink = {{"target", "/objects/0/radius"}, {"times", {0, 2}}, {"values", {1, -1}}};
    animate(Json::array({hop_, shrink}));
    write("still.json", scene_);
    view(
        "set samples 1\nset diffuse two 0.75 0.25 0.5\nsettle\nexpect time 0.5\nscreenshot own.png\nhand key "
        "End\nsettle\nexpect toast (at 2 s of the animation)\nexpect time 0.5\nscreenshot "
        "still-own.png\ncopy other.json scene.json\nreload\nsettle\nexpect time 0.5\nscreenshot "
        "other.png\ndrop still.json\nwait 2\nexpect toast not saved\ndrop still.json\nsettle\nexpect time "
        "none\nhand key space\nexpect toast this scene has no animation\nscreenshot still.png\n",
        "--time 0.5");
    expectRendered("still.png", "still.json");
    scene_["materials"]["two"]["diffuse"] = {0.75, 0.25, 0.5};
    animate(Json::array({hop_, shrink}), "edited.json");
    animate(Json::array({hop_}), "edited-other.json");
    expectRendered("own.png", "edited.json", "--time 0.5");
    expectRendered("still-own.png", "edited.json", "--time 0.5");
    expectRendered("other.png", "edited-other.json", "--time 0.5");
}

}  // namespace glint::view::test::animation_test
