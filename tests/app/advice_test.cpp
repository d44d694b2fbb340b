// A picture that shows nothing comes with the likely reason.
#include "support.h"

namespace glint::app::test {
namespace {

constexpr const char* kBall = R"("objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}])";

struct Nothing {
    const char* name;
    std::string rest;  // of the scene
    std::vector<std::string> options;
    std::string advice;  // empty: none
};

class Advice : public FolderTest, public ::testing::WithParamInterface<Nothing> {};

TEST_P(Advice, NamesTheReason) {
    writeText("a.json", sceneText(16, 12, GetParam().rest));
    std::vector<std::string> args = {"render", "a.json", "--backend", "cpu"};
    args.insert(args.end(), GetParam().options.begin(), GetParam().options.end());
    const Ran ran = runGlint(args);
    EXPECT_EQ(ran.code, 0);
    EXPECT_EQ(ran.err,
              GetParam().advice.empty() ? "" : "glint: warning: a.json: " + GetParam().advice + "\n");
    EXPECT_EQ(names(), (std::set<std::string>{"a.json", "a.png"}));
    args.push_back("--quiet");
    EXPECT_EQ(runGlint(args).err, "");
}

// sceneText's camera stands at (0, 0, 5) and looks along -z.
std::string ballAt(const std::string& center) {
    return R"("ambient": 1, "objects": [{"type": "sphere", "center": )" + center + R"(, "radius": 1}])";
}
std::string onlyBackground(const std::string& reason) {
    return "the picture shows background only: " + reason;
}
std::string onlyBlack(const std::string& reason) {
    return "everything in the picture is black: " + reason;
}

const Nothing kCases[] = {
    {"fine", R"("ambient": 0.5, )" + std::string(kBall), {}, ""},
    {"empty", R"("objects": [])", {}, onlyBackground("the scene has no objects")},
    {"behind",
     ballAt("[0, 0, 20]"),
     {},
     onlyBackground("everything lies behind the camera; check its eye and target")},
    {"aside",
     ballAt("[90, 0, 0]"),
     {},
     onlyBackground("the camera looks past the objects; glint info tells where they are")},
    {"planeAlone",
     R"("objects": [{"type": "plane", "point": [0, 0, 9], "normal": [0, 0, 1]}])",
     {},
     onlyBackground("the camera looks past the objects; glint info tells where they are")},
    {"crop",
     ballAt("[0, 0, 0]"),
     {"--crop", "0,0,2,2"},
     onlyBackground("there is nothing else in this --crop")},
    {"noLight", kBall, {}, onlyBlack("the scene has neither lights nor ambient light")},
    {"darkLight",
     R"("lights": [{"type": "point", "position": [0, 0, 5], "intensity": 0}], )" + std::string(kBall),
     {},
     onlyBlack("all its lights have the intensity 0, and there is no ambient light")},
    {"lightBehind",
     R"("lights": [{"type": "point", "position": [0, 0, -5]}], )" + std::string(kBall),
     {},
     onlyBlack("no light reaches what is seen, or its materials are black")},
    {"blackButFramed",
     R"("background": [1, 0, 0], )" + std::string(kBall),
     {"--spp", "4"},
     onlyBlack("the scene has neither lights nor ambient light")},
    {"onlyOneChannel",
     R"("lights": [{"type": "point", "position": [0, 0, 5], "intensity": [0, 0, 0.1]}], )" +
         std::string(kBall),
     {},
     ""},
};
INSTANTIATE_TEST_SUITE_P(All, Advice, ::testing::ValuesIn(kCases),
                         [](const auto& test) { return test.param.name; });

class ClippedAdvice : public FolderTest {};

TEST_F(ClippedAdvice, NearAndFar) {
    const auto advice = [](const std::string& limits) {
        writeText("a.json",
                  R"({"image": {"width": 16, "height": 12}, "ambient": 1, "camera": {"eye": [0, 0, 5], )" +
                      limits + R"(}, "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}]})");
        return runGlint({"render", "a.json", "--backend", "cpu"}).err;
    };
    EXPECT_EQ(advice("\"far\": 3.5"),
              "glint: warning: a.json: the picture shows background only: everything is farther away than "
              "the camera's far\n");
    EXPECT_EQ(advice("\"near\": 8"),
              "glint: warning: a.json: the picture shows background only: everything is nearer than the "
              "camera's near\n");
    EXPECT_EQ(advice("\"near\": 1, \"far\": 10"), "");
    // The ball is from 4 to 6 beyond the image plane of a parallel camera.
    const std::string parallel = R"("type": "orthographic", )";
    EXPECT_TRUE(advice(parallel + "\"far\": 3.9").ends_with("farther away than the camera's far\n"));
    EXPECT_TRUE(advice(parallel + "\"near\": 6.1").ends_with("nearer than the camera's near\n"));
    EXPECT_EQ(advice(parallel + "\"near\": 3.9, \"far\": 6.1"), "");
    // In front of the eye as it looks, behind the turned image plane: the eye is at (0, 0, 5), the plane's
    // normal (0, 3, 1), and of the view direction (0, 2, -5) upwards.
    EXPECT_TRUE(advice(R"("target": [0, 2, 0], "up": [0, 0, 1], "planeNormal": [0, 3, 1])")
                    .ends_with("everything lies behind the camera; check its eye and target\n"));
}

TEST_F(ClippedAdvice, AllTrianglesDropped) {
    writeText("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");  // no area
    writeText("a.json",
              sceneText(16, 12,
                        R"("meshes": {"m": {"file": "a.obj"}}, "objects": [{"type": "mesh", "mesh": "m"}])"));
    const Ran ran = runGlint({"render", "a.json", "--backend", "cpu"});
    EXPECT_EQ(ran.code, 0);
    EXPECT_TRUE(ran.err.ends_with(
        "glint: warning: a.json: the picture shows background only: nothing is left of its objects (see "
        "the warnings above)\n"))
        << ran.err;
}

}  // namespace
}  // namespace glint::app::test
