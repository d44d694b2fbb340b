// Texts of `info` and of the summaries of other commands.
#include "core/content_hash.h"
#include "core/image_io.h"
#include "support.h"

namespace glint::app::test::info_test {

// `glint info`: what it says of scenes whose contents are known.

class Info : public FolderTest {};

TEST_F(Info, EmptyScene) {
    writeText("a.json", "{}");
    const Ran ran = runGlint("info a.json");
    EXPECT_EQ(ran.code, 0);
    EXPECT_EQ(ran.err, "");
    EXPECT_STARTS(
        ran.out,
        "a.json\n"
        "  image         800 x 600, 1 sample per pixel, at most 5 reflections\n"
        "  camera        perspective\n"
        "  objects       0 (0 triangles, 0 spheres, 0 planes, 0 discs, 0 polygons, 0 quadrics, 0 boxes)\n"
        "  materials     0\n"
        "  lights        0\n"
        "  bounds        no geometry\n"
        "  BVH           none\n");
    EXPECT_HAS(ran.out, "  features used nothing\n");
}

TEST_F(Info, PlaneOnly) {
    writeText("a.json", R"({"objects": [{"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0]}]})");
    const std::string out = runGlint("info a.json").out;
    EXPECT_HAS(
        out,
        "  objects       1 (0 triangles, 0 spheres, 1 plane, 0 discs, 0 polygons, 0 quadrics, 0 boxes)\n");
    EXPECT_HAS(out, "  bounds        infinite (planes only)\n  BVH           none\n");
    EXPECT_HAS(out, "  features used planes\n");
}

TEST_F(Info, CountsFeaturesAndWhatIsLeftOut) {
    writeSmallScene("a.json");
    const std::string out = runGlint("info a.json --size 10x20 --spp 4 --max-depth 1").out;
    EXPECT_HAS(out, "  image         10 x 20, 4 samples per pixel (grid, auto), at most 1 reflection\n");
    EXPECT_HAS(runGlint("info a.json --spp 16").out, ", 16 samples per pixel (lowDiscrepancy, auto), ")
        << "the rule goes by --spp, not by the file's number";
    EXPECT_HAS(
        out,
        "  objects       3 (1 triangle, 2 spheres, 0 planes, 0 discs, 0 polygons, 0 quadrics, 0 boxes)\n");
    EXPECT_HAS(out, "  materials     3: \"red\", \"mirror\", \"blue\"\n  lights        1: 1 point\n");
    EXPECT_HAS(out, "  bounds        (-3.9 -1.7 -1) .. (3.6 2.2 1.4)\n");
    EXPECT_HAS(out, "  features used triangles, spheres, pointLights, specular, mirrors\n");
    EXPECT_HAS(out, "  left out      ");
    writeText("b.json", sceneText(8, 6, R"("maxDepth": 0, "materials": {"m": {"mirror": 0.9}},
        "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "m"}])"));
    EXPECT_LACKS(runGlint("info b.json").out, "mirrors\n")
        << "without reflections the mirror code is left out";
}

TEST_F(Info, LeastGapIsInSceneUnits) {
    const auto gapAt = [](const char* corner) {
        writeText("a.json", std::string(R"({"objects": [{"type": "box", "min": [-)") + corner +
                                ", -1, -1], \"max\": [" + corner + ", 1, 1]}]}");
        return runGlint("info a.json").out;
    };
    EXPECT_HAS(gapAt("1"), "  least gap     7.2e-07 along an axis, 2.5e-06 in other directions\n");
    EXPECT_HAS(gapAt("1000"), "  least gap     0.00072 along an axis, 0.0025 in other directions\n");
}

TEST_F(Info, KindOfCamera) {
    const auto infoOf = [](const std::string& camera) {
        writeText("a.json", "{\"camera\": {" + camera + "}}");
        return runGlint("info a.json").out;
    };
    const std::string tilted = R"("planeNormal": [0, 1, 1])", parallel = R"("type": "orthographic")";
    const std::pair<std::string, std::string> kinds[] = {{tilted, "oblique perspective"},
                                                         {parallel, "orthographic"},
                                                         {parallel + ", " + tilted, "oblique parallel"}};
    for (const auto& [camera, kind] : kinds) {
        const std::string out = infoOf(camera);
        EXPECT_HAS(out, "\n  camera        " + kind + "\n");
        const bool used = out.find("features used parallelCamera\n") != std::string::npos;
        EXPECT_EQ(used, camera.starts_with(parallel)) << out;
    }
}

TEST_F(Info, DroppedTrianglesAreCounted) {
    writeText("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n");
    const std::string out = runGlint("info a.obj").out;
    EXPECT_HAS(out, "  dropped       1 primitive without area, 1 not finite\n");
}

// --stats json and --quiet: what programs read.

using Stats = SmallSceneTest;

TEST_F(Stats, StandardOutputIsOneJsonDocument) {
    const nlohmann::json json = jsonOf("render a.json --backend cpu --stats json --aov color,depth --spp 4");
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
    const Ran ran = runGlint("render dark.json --backend cpu --stats json");
    EXPECT_STARTS(ran.err, "glint: warning: ");
    EXPECT_TRUE(nlohmann::json::accept(ran.out));
}

TEST_F(Stats, FileNameThatIsNoUtf8) {
    jsonOf("render a.json --backend cpu --stats json -o b\xff.png");
    EXPECT_TRUE(names().contains("b\xff.png"));
}

// The hash is of the image and not of its file, so it is the same for the image that is read back.
TEST_F(Stats, HashIsOfThePicture) {
    const auto hash = [](const Words& options) {
        return jsonOf("render a.json --backend cpu --stats json" + options)["hash"].get<std::string>();
    };
    const std::string png = hash("-o b.png");
    EXPECT_EQ(hash("-o b.pfm"), png);
    EXPECT_EQ(pictureHash(readImage(file("b.pfm"))), png);
    EXPECT_NE(hash("-o b.png --spp 4"), png);
}

TEST_F(Stats, QuietSaysNothing) {
    const Ran ran = runGlint("render a.json --backend cpu -q");
    EXPECT_EQ(ran.out + ran.err, "");
    EXPECT_EQ(ran.code, 0);
    EXPECT_EQ(jsonOf("render a.json --backend cpu -q --stats json")["scene"], "a.json");
    expectError("render no.json --backend cpu -q", 3, "no.json: no such file");
}

TEST_F(Stats, SummaryNamesFileSizeAndTimes) {
    const Ran ran = runGlint("render a.json --backend cpu -o b.exr");
    EXPECT_STARTS(ran.out, "wrote b.exr (64x48)\ndevice: CPU reference (double precision), ");
    EXPECT_HAS(ran.out, "\nhash: ");
    EXPECT_HAS(ran.out, "\ntimes: load ");
    EXPECT_EQ(ran.err, "");
}

}  // namespace glint::app::test::info_test
