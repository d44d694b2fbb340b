// `glint info`: what it says of scenes whose contents are known.
#include "support.h"

namespace glint::app::test::info_test {
class Info : public FolderTest {};

TEST_F(Info, EmptyScene) {
    writeText("a.json", "{}");
    const Ran ran = runGlint({"info", "a.json"});
    EXPECT_EQ(ran.code, 0);
    EXPECT_EQ(ran.err, "");
    EXPECT_TRUE(ran.out.starts_with(
        "a.json\n"
        "  picture       800 x 600, 1 sample per pixel, at most 5 reflections\n"
        "  camera        perspective\n"
        "  objects       0 (0 triangles, 0 spheres, 0 planes, 0 discs, 0 polygons, 0 quadrics, 0 boxes)\n"
        "  materials     0\n"
        "  lights        0\n"
        "  bounds        no geometry\n"
        "  BVH           none\n"))
        << ran.out;
    EXPECT_HAS(ran.out, "  features used nothing\n");
}

TEST_F(Info, PlaneOnly) {
    writeText("a.json", R"({"objects": [{"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0]}]})");
    const std::string out = runGlint({"info", "a.json"}).out;
    EXPECT_HAS(out,
               "  objects       1 (0 triangles, 0 spheres, 1 plane, 0 discs, 0 polygons, 0 quadrics, "
               "0 boxes)\n");
    EXPECT_HAS(out, "  bounds        infinite (planes only)\n  BVH           none\n");
    EXPECT_HAS(out, "  features used planes\n");
}

TEST_F(Info, CountsFeaturesAndWhatIsLeftOut) {
    writeSmallScene("a.json");
    const std::string out =
        runGlint({"info", "a.json", "--size", "10x20", "--spp", "4", "--max-depth", "1"}).out;
    EXPECT_HAS(out, "  picture       10 x 20, 4 samples per pixel (grid, auto), at most 1 reflection\n");
    EXPECT_HAS(runGlint({"info", "a.json", "--spp", "16"}).out,
               ", 16 samples per pixel (lowDiscrepancy, auto), ")
        << "the rule goes by --spp, not by the file's number";
    EXPECT_HAS(out,
               "  objects       3 (1 triangle, 2 spheres, 0 planes, 0 discs, 0 polygons, 0 quadrics, "
               "0 boxes)\n");
    EXPECT_HAS(out, "  materials     3: \"red\", \"mirror\", \"blue\"\n  lights        1: 1 point\n");
    EXPECT_HAS(out, "  bounds        (-3.9 -1.7 -1) .. (3.6 2.2 1.4)\n");
    EXPECT_HAS(out, "  features used triangles, spheres, pointLights, specular, mirrors\n");
    EXPECT_HAS(out, "  left out      ");
    writeText("b.json", sceneText(8, 6, R"("maxDepth": 0, "materials": {"m": {"mirror": 0.9}},
        "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "m"}])"));
    EXPECT_LACKS(runGlint({"info", "b.json"}).out, "mirrors\n")
        << "without reflections the mirror code is left out";
}

TEST_F(Info, KindOfCamera) {
    const auto infoOf = [](const std::string& camera) {
        writeText("a.json", "{\"camera\": {" + camera + "}}");
        return runGlint({"info", "a.json"}).out;
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
    const std::string out = runGlint({"info", "a.obj"}).out;
    EXPECT_HAS(out, "  dropped       1 primitive without area, 1 not finite\n");
}

TEST_F(Info, IsTheSameEveryTimeButForTheBuildTime) {
    writeSmallScene("a.json");
    const auto withoutTime = [] {
        const std::string out = runGlint({"info", "a.json"}).out;
        const size_t built = out.find(", built in ");
        return out.substr(0, built) + out.substr(out.find('\n', built));
    };
    EXPECT_EQ(withoutTime(), withoutTime());
}

}  // namespace glint::app::test::info_test
