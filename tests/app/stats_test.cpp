// --stats json and --quiet: what programs read.
#include <nlohmann/json.hpp>

#include "core/image_io.h"
#include "core/picture_hash.h"
#include "support.h"

namespace glint::app::test::stats_test {
class Stats : public FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        writeSmallScene("a.json");
    }
};

TEST_F(Stats, StandardOutputIsOneJsonDocument) {
    const Ran ran = runGlint(
        {"render", "a.json", "--backend", "cpu", "--stats", "json", "--aov", "color,depth", "--spp", "4"});
    EXPECT_EQ(ran.code, 0);
    EXPECT_EQ(ran.err, "");
    const nlohmann::json json = nlohmann::json::parse(ran.out);
    EXPECT_EQ(json["scene"], "a.json");
    EXPECT_EQ(json["backend"], "cpu");
    EXPECT_EQ(json["files"], (std::vector<std::string>{"a.png", "a.depth.png"}));
    EXPECT_EQ(json["complete"], true);
    EXPECT_EQ(json["width"], 64);
    EXPECT_EQ(json["height"], 48);
    EXPECT_EQ(json["samplesPerPixel"], 4);
    EXPECT_EQ(json["sampler"], "grid");
    EXPECT_EQ(json["maxDepth"], 5);
    EXPECT_EQ(json["triangles"], 1);
    EXPECT_EQ(json["spheres"], 2);
    EXPECT_EQ(json["planes"], 0);
    EXPECT_EQ(json["notFinite"], 0);
    for (const char* key :
         {"load", "pack", "upload", "compile", "trace", "device", "readback", "write", "total"}) {
        EXPECT_GE(json["seconds"].at(key).get<double>(), 0.0) << key;
    }
    EXPECT_GE(json["seconds"]["total"].get<double>(), json["seconds"]["trace"].get<double>());
}

TEST_F(Stats, WarningsDoNotDisturbIt) {
    writeText("dark.json",
              sceneText(8, 6, R"("objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}])"));
    const Ran ran = runGlint({"render", "dark.json", "--backend", "cpu", "--stats", "json"});
    EXPECT_TRUE(ran.err.starts_with("glint: warning: ")) << ran.err;
    EXPECT_TRUE(nlohmann::json::accept(ran.out));
}

TEST_F(Stats, FileNameThatIsNoUtf8) {
    const Ran ran = runGlint({"render", "a.json", "--backend", "cpu", "--stats", "json", "-o", "b\xff.png"});
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_TRUE(nlohmann::json::accept(ran.out));
    EXPECT_TRUE(names().contains("b\xff.png"));
}

// Of the picture, not of its file; what is told to read it back finds the same.
TEST_F(Stats, HashIsOfThePicture) {
    const auto hash = [](std::vector<std::string> options) {
        options.insert(options.begin(), {"render", "a.json", "--backend", "cpu", "--stats", "json"});
        return nlohmann::json::parse(runGlint(options).out)["hash"].get<std::string>();
    };
    const std::string png = hash({"-o", "b.png"});
    EXPECT_EQ(hash({"-o", "b.pfm"}), png);
    EXPECT_EQ(pictureHash(readImage(file("b.pfm"))), png);
    EXPECT_NE(hash({"-o", "b.png", "--spp", "4"}), png);
}

TEST_F(Stats, QuietSaysNothing) {
    const Ran ran = runGlint({"render", "a.json", "--backend", "cpu", "-q"});
    EXPECT_EQ(ran.out + ran.err, "");
    EXPECT_EQ(ran.code, 0);
    EXPECT_TRUE(nlohmann::json::accept(
        runGlint({"render", "a.json", "--backend", "cpu", "-q", "--stats", "json"}).out));
    EXPECT_EQ(runGlint({"render", "no.json", "--backend", "cpu", "-q"}).err,
              "glint: no.json: no such file\n");
}

TEST_F(Stats, SummaryNamesFileSizeAndTimes) {
    const Ran ran = runGlint({"render", "a.json", "--backend", "cpu", "-o", "b.exr"});
    EXPECT_TRUE(ran.out.starts_with("wrote b.exr (64x48)\ndevice: CPU reference (double precision), "))
        << ran.out;
    EXPECT_HAS(ran.out, "\nhash: ");
    EXPECT_HAS(ran.out, "\ntimes: load ");
    EXPECT_EQ(ran.err, "");
}

}  // namespace glint::app::test::stats_test
