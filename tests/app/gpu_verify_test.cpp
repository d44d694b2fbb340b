// `glint verify` as a command; what makes a pixel explained is tested with the module itself.
#include <fstream>

#include "core/available_memory.h"
#include "core/image_io.h"
#include "gpu/device.h"
#include "support.h"

namespace glint::app::test::gpu_verify_test {
class GpuVerify : public FolderTest {};

TEST_F(GpuVerify, PassesAndWritesNothing) {
    writeSmallScene("a.json");
    writeText("empty.json", "{\"image\": {\"width\": 9, \"height\": 7}}");
    const Ran ran = runGlint("verify a.json empty.json");
    EXPECT_EQ(ran.code, 0) << ran.out << ran.err;
    EXPECT_EQ(ran.err, "");
    EXPECT_STARTS(ran.out, "device: " + gpu::Device().info().name);
    EXPECT_HAS(ran.out, "\na.json: ok\n    3072 pixels; beyond their predicted error: ");  // 64 x 48
    EXPECT_HAS(ran.out, "\nempty.json: ok\n    63 pixels; beyond their predicted error: ");
    EXPECT_EQ(names(), (std::set<std::string>{"a.json", "empty.json"}));
}

TEST_F(GpuVerify, OptionsReplaceTheScenes) {
    writeSmallScene("a.json");
    const Ran ran = runGlint("verify a.json --size 20x10 --spp 4 --max-depth 1");
    EXPECT_EQ(ran.code, 0) << ran.out << ran.err;
    EXPECT_HAS(ran.out, "    800 pixels; ") << "20 x 10 x 4 samples: " << ran.out;
}

TEST_F(GpuVerify, TakesACameraByItsName) {
    writeText("a.json", R"({"image": {"width": 20, "height": 10}, "cameras": {"up": {"target": [9, 0, 5]}},
        "ambient": 0.3, "lights": [{"type": "point", "position": [1, 2, 3]}],
        "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}]})");
    const std::string shown = runGlint("verify a.json").out;
    const Ran ran = runGlint("verify a.json --camera up");
    EXPECT_EQ(ran.code, 0) << ran.out << ran.err;
    EXPECT_NE(ran.out, shown);
    EXPECT_EQ(runGlint("verify a.json --camera x").err,
              "glint: a.json: no camera \"x\" (there are \"up\")\n");
}

// Two spheres of different colours, one 1e-5 in front of the other, seen from distance 4: nearly as far as
// surfaces that count as one may be apart, so rounding decides which of them a ray meets. Every pixel is
// explained, and as many as the scene demands. The second scene does not pass: a textbook's sphere test on a
// planet.
TEST_F(GpuVerify, SurfacesInOnePlacePassAndAMethodThatLosesDigitsFails) {
    writeText("fight.json",
              R"({"image": {"width": 64, "height": 64}, "ambient": 1, "camera": {"eye": [0.3, 0.2, 5]},
        "materials": {"red": {"diffuse": [1, 0, 0]}, "green": {"diffuse": [0, 1, 0]}},
        "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "red"},
                    {"type": "sphere", "center": [0, 0, 1e-5], "radius": 1, "material": "green"}]})");
    writeText("empty.json", "{\"image\": {\"width\": 9, \"height\": 7}}");
    writeText("planet.json",
              R"({"image": {"width": 64, "height": 48}, "ambient": 0.1, "camera": {"eye": [0, 2, 5]},
        "lights": [{"type": "directional", "direction": [-1, -1, -1]}],
        "objects": [{"type": "sphere", "center": [0, -1000000, 0], "radius": 1000000}]})");
    const Ran ran = runGlint("verify --sphere algebraic fight.json planet.json empty.json");
    EXPECT_EQ(ran.code, 5);
    EXPECT_EQ(ran.err, "glint: verify: 1 of 3 scenes failed\n");
    EXPECT_HAS(ran.out, "fight.json: ok\n");
    EXPECT_HAS(ran.out,
               "planet.json: FAILED: too many pixels differ, though rounding explains each: the method loses "
               "digits here\n");
    EXPECT_HAS(ran.out, ", 0 unexplained\n");
    EXPECT_HAS(ran.out, "\nempty.json: ok\n") << "the scenes after a failed one are verified too";
}

TEST_F(GpuVerify, AnInvalidOrMissingSceneDoesNotEndTheRun) {
    writeText("a.json", "{\"image\": {\"width\": 9, \"height\": 7}}");
    writeText("b.json", "{\"objekts\": []}");
    const Ran ran = runGlint("verify a.json b.json no.json a.json --json r.json --junit r.xml");
    EXPECT_EQ(ran.code, 3);
    EXPECT_EQ(ran.err,
              "glint: b.json:1:13: /objekts: unknown key (did you mean \"objects\"?)\n"
              "glint: no.json: no such file\n");
    EXPECT_HAS(ran.out, "\na.json: ok\n");
    EXPECT_EQ(names(), (std::set<std::string>{"a.json", "b.json", "r.json", "r.xml"}));
    EXPECT_HAS(glint::test::readText("r.xml"), "<error message=\"no.json: no such file\">");
    const nlohmann::json report = nlohmann::json::parse(std::ifstream("r.json"));
    EXPECT_EQ(report["summary"],
              (nlohmann::json{{"passed", 2}, {"failed", 0}, {"error", 2}, {"skipped", 0}}));
    EXPECT_EQ(report["scenes"][1]["status"], "error");
    EXPECT_EQ(report["scenes"][3]["status"], "passed");
}

// The scenes after an error are verified, and a difference decides the exit code.
TEST_F(GpuVerify, ErrorsAreOfTheirSceneAlone) {
    ASSERT_LT(availableMemory(), uint64_t{1172} << 30);
    writeText("a.json", R"({"image": {"width": 9, "height": 7}, "cameras": {"up": {}}})");
    writeText("giant.json", R"({"image": {"width": 65536, "height": 65536, "samplesPerPixel": 64}})");
    writeText(
        "planet.json",
        R"({"image": {"width": 64, "height": 48}, "camera": {"eye": [0, 2, 5]}, "cameras": {"up": {"eye": [0, 2, 5]}},
        "lights": [{"type": "directional", "direction": [-1, -1, -1]}],
        "objects": [{"type": "sphere", "center": [0, -1000000, 0], "radius": 1000000}]})");
    const Ran lacks = runGlint("verify giant.json a.json --camera up --brief");
    EXPECT_EQ(lacks.code, 2);
    EXPECT_EQ(lacks.err, "glint: giant.json: no camera \"up\" (none in it has a name)\n");
    EXPECT_HAS(lacks.out, "\na.json: ok, ");
    const Ran ran = runGlint(
        "verify giant.json no.json planet.json a.json --sphere algebraic --brief --junit r.xml --artifacts "
        ".");
    EXPECT_EQ(ran.code, 5);
    EXPECT_STARTS(ran.err, "glint: giant.json: an image of 65536x65536 pixels takes 1172.0 GiB of memory, ");
    EXPECT_HAS(ran.out, "\n4 scenes: 1 passed, 1 failed, 2 errors, 0 skipped, ");
    std::filesystem::create_directory("full");
    std::filesystem::create_directory("full/planet.device.png");
    const Ran full =
        runGlint("verify planet.json a.json --sphere algebraic --brief --junit r.xml --artifacts full");
    EXPECT_EQ(full.code, 5);
    EXPECT_HAS(full.err, "glint: full/planet.device.png: ");
    EXPECT_HAS(glint::test::readText("r.xml"), "failures=\"1\" errors=\"0\" skipped=\"0\"");
}

// Reports would replace the scene before it is read, or each other.
TEST_F(GpuVerify, ReportsDoNotReplaceScenes) {
    writeText("a.json", "{\"image\": {\"width\": 9, \"height\": 7}}");
    for (const std::string option : {"--json", "--junit"}) {
        const Ran ran = runGlint("verify a.json " + option + " ./a.json");
        EXPECT_EQ(ran.code, 2);
        EXPECT_EQ(ran.err, "glint: " + option + ": verify reads this file; name another one\n");
    }
    EXPECT_EQ(runGlint("verify a.json --json r --junit ./r").code, 2);
    EXPECT_EQ(names(), std::set<std::string>{"a.json"});
}

TEST_F(GpuVerify, SchemasBesideScenesAreSkipped) {
    writeText("a.json", "{\"image\": {\"width\": 9, \"height\": 7}}");
    writeText("scene.schema.json", "{}");
    const Ran ran = runGlint("verify a.json scene.schema.json --brief");
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_HAS(ran.out, "\na.json: ok, 63 pixels, 0 explained, 0 unexplained, RMSE 0, ");
    EXPECT_HAS(ran.out,
               "\nscene.schema.json: skipped: a JSON schema, not a scene\n"
               "2 scenes: 1 passed, 0 failed, 0 errors, 1 skipped, ");
}

// A textbook's sphere test on a planet fails, an empty image passes: only the first leaves images, and the
// second scene of its name leaves others. Pixels with another path are yellow.
TEST_F(GpuVerify, FilesAndImagesForOtherPrograms) {
    writeText("empty.json", "{\"image\": {\"width\": 9, \"height\": 7}}");
    std::filesystem::create_directory("x");
    for (const char* name : {"planet.json", "x/planet.json"})
        writeText(name,
                  R"({"image": {"width": 64, "height": 48}, "ambient": 1, "camera": {"eye": [0.3, 0.2, 5]},
        "materials": {"red": {"diffuse": [1, 0, 0]}, "green": {"diffuse": [0, 1, 0]}},
        "lights": [{"type": "directional", "direction": [-1, -1, -1]}],
        "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "red"},
                    {"type": "sphere", "center": [0, 0, 1e-5], "radius": 1, "material": "green"},
                    {"type": "sphere", "center": [0, -1000001.2, 0], "radius": 1000000}]})");
    const Ran ran = runGlint(
        "verify --sphere algebraic planet.json empty.json x/planet.json --json r.json --junit r.xml "
        "--artifacts new/art");
    EXPECT_EQ(ran.code, 5);
    EXPECT_EQ(names(), (std::set<std::string>{"empty.json", "planet.json", "x", "r.json", "r.xml", "new"}));
    std::set<std::string> images;
    for (const auto& entry : std::filesystem::directory_iterator("new/art"))
        images.insert(entry.path().filename().string());
    EXPECT_EQ(images, (std::set<std::string>{"planet.device.png", "planet.difference.png",
                                             "planet.reference.png", "planet-2.device.png",
                                             "planet-2.difference.png", "planet-2.reference.png"}));
    const Image picture = readImage("new/art/planet.difference.png");
    int yellow = 0;
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x)
            yellow += picture.at(x, y, 0) > 0.9f && picture.at(x, y, 2) < 0.1f && picture.at(x, y, 1) > 0.5f;
    EXPECT_GT(yellow, 0);
    const nlohmann::json report = nlohmann::json::parse(std::ifstream("r.json"));
    EXPECT_EQ(report["format"], "glint.verify");
    EXPECT_EQ(report["version"], 2);
    const nlohmann::json& planet = report["scenes"][0];
    EXPECT_EQ(planet["status"], "failed");
    ASSERT_GT(planet["differing"], 0);
    EXPECT_EQ(planet["differingPixels"].size(), std::min(planet["differing"].get<size_t>(), size_t{1000}));
    for (const char* key : {"x", "y", "sample", "reason", "difference", "device", "reference"})
        EXPECT_TRUE(planet["differingPixels"][0].contains(key)) << key;
    const std::string xml = glint::test::readText("r.xml");
    EXPECT_HAS(xml, "tests=\"3\" failures=\"2\" errors=\"0\" skipped=\"0\"");
    EXPECT_HAS(xml, "<failure message=\"FAILED: ");
}

TEST_F(GpuVerify, JsonOnStandardOutput) {
    writeText("a.json", "{\"image\": {\"width\": 9, \"height\": 7}}");
    EXPECT_EQ(jsonOf("verify a.json --json - --brief")["scenes"][0]["status"], "passed");
    EXPECT_EQ(names(), std::set<std::string>{"a.json"});
}

// 65536^2 pixels with 64 samples take 36 + 256 bytes each, and 1 for the rays of a part.
TEST_F(GpuVerify, HugePictureIsRefused) {
    ASSERT_LT(availableMemory(), uint64_t{1172} << 30);
    writeSmallScene("a.json");
    const Ran ran = runGlint("verify a.json --size 65536x65536 --spp 64");
    EXPECT_STARTS(ran.err, "glint: a.json: an image of 65536x65536 pixels takes 1172.0 GiB of memory, ");
    EXPECT_EQ(ran.code, 1);
}

}  // namespace glint::app::test::gpu_verify_test
