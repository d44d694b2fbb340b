// A picture that shows nothing comes with the likely reason.
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/image_io.h"
#include "support.h"

namespace glint::app::test::advice_test {
constexpr const char* kBall = R"("objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}])";

struct Nothing {
    const char* name;
    std::string rest;    // of the scene
    std::string advice;  // empty: none
    const char* options = "";
};

class Advice : public FolderTest, public ::testing::WithParamInterface<Nothing> {};

TEST_P(Advice, NamesTheReason) {
    writeText("a.json", sceneText(16, 12, GetParam().rest));
    const Ran ran = runGlint("render a.json --backend cpu", GetParam().options);
    EXPECT_EQ(ran.code, 0);
    EXPECT_EQ(ran.err,
              GetParam().advice.empty() ? "" : "glint: warning: a.json: " + GetParam().advice + "\n");
    EXPECT_EQ(names(), (std::set<std::string>{"a.json", "a.png"}));
    EXPECT_EQ(runGlint("render a.json --backend cpu --quiet", GetParam().options).err, "");
}

// sceneText's camera stands at (0, 0, 5) and looks along -z.
std::string ballAt(const std::string& center) {
    return R"("ambient": 1, "objects": [{"type": "sphere", "center": )" + center + R"(, "radius": 1}])";
}
std::string onlyBackground(const std::string& reason) {
    return "the image shows only background: " + reason;
}
std::string onlyBlack(const std::string& reason) {
    return "everything in the image is black: " + reason;
}

const std::string kPast = onlyBackground(
    "the camera looks past the objects, or they are smaller than a pixel; check its eye and target (glint "
    "info prints the bounds)");
const std::string kAlike = onlyBackground(
    "the surfaces have its colour, by what they let through, mirror or reflect; change a material or the "
    "background");

const Nothing kCases[] = {
    {"fine", R"("ambient": 0.5, )" + std::string(kBall), ""},
    {"empty", R"("objects": [])", onlyBackground("the scene has no objects")},
    {"behind", ballAt("[0, 0, 20]"), kPast},
    {"aside", ballAt("[90, 0, 0]"), kPast},
    {"tooSmall", ballAt("[0, 0, -90000]"), kPast},
    {"planeAlone", R"("objects": [{"type": "plane", "point": [0, 0, 9], "normal": [0, 0, 1]}])", kPast},
    {"planeEdgeOn",
     R"("ambient": 0.5, "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1},
        {"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0]}])",
     "the camera lies in the plane of /objects/1, which is invisible from there; move the camera's eye"},
    {"crop", ballAt("[0, 0, 0]"),
     onlyBackground("nothing is in this --crop; leave it out to see the whole image"), "--crop 0,0,2,2"},
    {"noLight", kBall, onlyBlack("the scene has neither lights nor ambient light")},
    {"darkLight",
     R"("lights": [{"type": "point", "position": [0, 0, 5], "intensity": 0}], )" + std::string(kBall),
     onlyBlack("the scene has neither lights nor ambient light")},
    {"lightBehind", R"("lights": [{"type": "point", "position": [0, 0, -5]}], )" + std::string(kBall),
     onlyBlack("no light reaches what is seen, or its materials are black")},
    {"insideASphere",
     R"("lights": [{"type": "point", "position": [0, 90, 5]}], "objects": [{"type": "sphere", "center": [0, 0, 6], "radius": 3}])",
     onlyBlack("the camera is inside /objects/0, which blocks every light")},
    {"insideAMirrorBall",
     R"("lights": [{"type": "point", "position": [0, 90, 5]}], "materials": {"mirror": {"diffuse": 0, "mirror": 0.9}},
        "objects": [{"type": "sphere", "center": [0, 0, 6], "radius": 3, "material": "mirror"}])",
     onlyBlack("the camera is inside /objects/0, which blocks every light")},
    {"insideASphereOfAmbientLight", R"("ambient": 0.5, "lights": [{"type": "point", "position": [0, 90, 5]}],
        "objects": [{"type": "sphere", "center": [0, 0, 6], "radius": 3}])",
     "the camera is inside /objects/0, which blocks every light"},
    {"insideASphereWithALamp",
     R"("lights": [{"type": "point", "position": [0, 1, 5]}], "objects": [{"type": "sphere", "center": [0, 0, 6], "radius": 3}])",
     ""},
    {"insideWithCompany",
     R"("ambient": 0.5, "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 30},
        {"type": "sphere", "center": [0, 0, 0], "radius": 1}])",
     ""},
    {"blackButFramed", R"("background": [1, 0, 0], )" + std::string(kBall),
     onlyBlack("the scene has neither lights nor ambient light"), "--spp 4"},
    {"rimAlone", R"("background": [1, 0, 0], "ambient": 0.5, )" + std::string(kBall), "",
     "--size 1x1 --spp 16"},
    {"blackRimAlone", std::string(kBall), onlyBlack("the scene has neither lights nor ambient light"),
     "--size 1x1 --spp 16"},
    {"glassWithoutDepth",
     R"("maxDepth": 1, "lights": [{"type": "point", "position": [0, 0, 5]}], "materials": {"glass": {"transmission": 1}},
        "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "glass"}])",
     onlyBlack("what is seen shows only reflections and refractions, and maxDepth is 1; use --max-depth 5")},
    {"invisible",
     R"("background": [1, 0.5, 0.2], "materials": {"clear": {"transmission": 1, "ior": 1}},
        "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "clear"}])",
     kAlike, "--spp 3"},
    {"mirrorOfNothing",
     R"("background": [1, 0.5, 0.2], "materials": {"mirror": {"diffuse": 0, "mirror": 1}},
        "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "mirror"}])",
     kAlike},
    {"tooDark",
     R"("lights": [{"type": "point", "position": [0, 0, 601], "falloff": "inverseSquare"}], )" +
         std::string(kBall),
     "everything in the image is too dark for 8 bits; the brightest value is 1.94e-06: use --exposure 18, or "
     "a format with floats such as .exr"},
    {"darkButExposed",
     R"("lights": [{"type": "point", "position": [0, 0, 601], "falloff": "inverseSquare"}], )" +
         std::string(kBall),
     "", "--exposure 18"},
    {"tooBright",
     R"("lights": [{"type": "point", "position": [0, 0, 601], "intensity": 50000}], "ambient": 100, )" +
         std::string(kBall),
     "everything in the image is too bright for 8 bits; the brightest value is 3.5e+04: use --exposure -16, "
     "or a format with floats such as .exr"},
    {"onlyOneChannel",
     R"("lights": [{"type": "point", "position": [0, 0, 5], "intensity": [0, 0, 0.1]}], )" +
         std::string(kBall),
     ""}};
INSTANTIATE_TEST_SUITE_P(All, Advice, ::testing::ValuesIn(kCases),
                         [](const auto& test) { return test.param.name; });

class ClippedAdvice : public FolderTest {};

TEST_F(ClippedAdvice, NearAndFar) {
    const auto advice = [](const std::string& limits) {
        writeText("a.json",
                  R"({"image": {"width": 16, "height": 12}, "ambient": 1, "camera": {"eye": [0, 0, 5], )" +
                      limits + R"(}, "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}]})");
        return runGlint("render a.json --backend cpu").err;
    };
    const std::string clipped =
        "glint: warning: a.json: the image shows only background: everything is nearer than the camera's "
        "near "
        "or farther away than its far\n";
    EXPECT_EQ(advice("\"far\": 3.5"), clipped);
    EXPECT_EQ(advice("\"near\": 8"), clipped);
    EXPECT_EQ(advice("\"near\": 1, \"far\": 10"), "");
    // The ball is from 4 to 6 beyond the image plane of a parallel camera.
    const std::string parallel = R"("type": "orthographic", )";
    EXPECT_EQ(advice(parallel + "\"far\": 3.9"), clipped);
    EXPECT_EQ(advice(parallel + "\"near\": 6.1"), clipped);
    EXPECT_EQ(advice(parallel + "\"near\": 3.9, \"far\": 6.1"), "");
    // Not the box around it, but all of it that the picture would show.
    writeText("a.json",
              R"({"image": {"width": 16, "height": 12}, "ambient": 1, "camera": {"eye": [0, 0, 5], "far": 4},
              "objects": [{"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}, {"type": "sphere", "center": [90, 0, 0], "radius": 3}]})");
    EXPECT_EQ(runGlint("render a.json --backend cpu").err, clipped);
}

// A cube of triangles around the eye.
TEST_F(ClippedAdvice, InsideAMesh) {
    writeText("a.obj",
              "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
              "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 1 5 8 4\nf 2 3 7 6\n");
    writeText("a.json", sceneText(16, 12, R"("lights": [{"type": "point", "position": [0, 9, 9]}],
        "meshes": {"m": {"file": "a.obj"}}, "objects": [{"type": "mesh", "mesh": "m", "transform": [{"translate": [0, 0, 4.5]}]}])"));
    EXPECT_EQ(runGlint("render a.json --backend cpu").err,
              "glint: warning: a.json: everything in the image is black: the camera is inside /objects/0, "
              "which blocks every light\n");
}

TEST_F(ClippedAdvice, AllTrianglesDropped) {
    writeText("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");  // no area
    writeText("a.json",
              sceneText(16, 12,
                        R"("meshes": {"m": {"file": "a.obj"}}, "objects": [{"type": "mesh", "mesh": "m"}])"));
    const Ran ran = runGlint("render a.json --backend cpu");
    EXPECT_EQ(ran.code, 0);
    EXPECT_STARTS(ran.err, "glint: warning: a.json: /objects/0: 1 of 1 triangles dropped: no area");
    EXPECT_ENDS(ran.err,
                "glint: warning: a.json: the image shows only background: nothing is left of its "
                "objects (see the warnings above)\n");
}

// Two lamps of 1e18 that fade with the square of the distance, a hundred-billionth above the floor: 1e18 /
// (1e-11)^2 is more than fp32 holds, and infinity times the green of a red floor is no number. The picture
// holds neither; the pixels are counted and the first is named.
TEST_F(ClippedAdvice, NotFiniteIsCountedAndShownBlack) {
    writeText(
        "a.json",
        R"({"image": {"width": 9, "height": 7}, "ambient": 0.25, "materials": {"red": {"ambient": 1, "diffuse": [0.5, 0, 0]}},
        "camera": {"eye": [0, 0, 1e-10], "target": [0, 0, 0], "up": [0, 1, 0], "fovY": 60},
        "lights": [{"type": "point", "position": [0, 0, 1e-11], "intensity": 1e18, "falloff": "inverseSquare"}],
        "objects": [{"type": "disc", "center": [0, 0, 0], "normal": [0, 0, 1], "radius": 1, "material": "red"}]})");
    const Ran ran = runGlint("render a.json --backend cpu -o a.pfm --stats json");
    EXPECT_EQ(ran.code, 0);
    const auto stats = nlohmann::json::parse(ran.out);
    const uint64_t count = stats["notFinite"];
    EXPECT_GT(count, 0u);
    const int x = stats["firstNotFinite"][0], y = stats["firstNotFinite"][1];
    EXPECT_HAS(ran.err, std::to_string(count) + " pixels not finite (NaN or infinite), the first at " +
                            std::to_string(x) + "," + std::to_string(y) + "; shown black.");
    const Image image = readImage("a.pfm");
    uint64_t black = 0;
    std::pair<int, int> first = {99, 99};
    for (int row = 0; row < image.height; ++row) {
        for (int column = 0; column < image.width; ++column) {
            for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isfinite(image.at(column, row, c)));
            if (image.at(column, row, 0) != 0) continue;  // ambient light is everywhere
            ++black;
            first = std::min(first, {row, column});
        }
    }
    EXPECT_EQ(black, count);
    EXPECT_EQ(first, std::pair(y, x));
}

}  // namespace glint::app::test::advice_test
