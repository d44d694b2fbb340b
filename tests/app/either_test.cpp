// `glint render` and `glint trace` on either backend: app_tests and app_gpu_tests compile this file with
// theirs.
#include "core/image_io.h"
#include "support.h"

namespace glint::app::test::either_test {
const std::string kBackend = GLINT_BACKEND;

class RenderEither : public SmallSceneTest {
  protected:
    static void render(const Words& options) { SmallSceneTest::render("--backend " + kBackend + options); }
};

TEST_F(RenderEither, SameBytesOnEveryRun) {
    render("-o 1.png");
    render("-o 2.png");
    render("-o 1.exr --aov color,depth,cost --spp 3");
    render("-o 2.exr --aov color,depth,cost --spp 3");
    EXPECT_FALSE(readBytes("1.png").empty());
    EXPECT_EQ(readBytes("1.png"), readBytes("2.png"));
    EXPECT_EQ(readBytes("1.exr"), readBytes("2.exr"));
}

TEST_F(RenderEither, CropIsThePartOfTheWhole) {
    render("-o whole.pfm");
    render("-o part.pfm --crop 5,7,41,32");
    const Image whole = readImage("whole.pfm"), part = readImage("part.pfm");
    ASSERT_EQ(std::pair(part.width, part.height), std::pair(36, 25));
    int different = 0;
    for (int y = 0; y < part.height; ++y) {
        for (int x = 0; x < part.width; ++x) {
            for (int c = 0; c < 3; ++c) different += part.at(x, y, c) == whole.at(x + 5, y + 7, c) ? 0 : 1;
        }
    }
    EXPECT_EQ(different, 0);
}

// An image by options has the bits of the image of a file that says the same, even if its own file has no
// reflections.
TEST_F(RenderEither, OptionsHaveTheBitsOfTheFile) {
    const std::string rest = R"("background": [0.2, 0.4, 0.6], "ambient": 0.2,
        "materials": {"m": {"diffuse": 0.2, "mirror": 0.7}},
        "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "m"},
                    {"type": "sphere", "center": [1.5, 0.5, 1], "radius": 0.7, "material": "m"}])";
    writeText("a.json", sceneText(16, 12, R"("maxDepth": 0, )" + rest));
    std::string text = sceneText(24, 18, R"("maxDepth": 3, )" + rest);
    text.replace(text.find("\"width\""), 0, R"("samplesPerPixel": 4, "sampler": "jittered", "seed": 9, )");
    writeText("b.json", text);
    const auto draw = [](const Words& args) {
        const Ran ran = runGlint("render -q --backend " + kBackend, args);
        EXPECT_EQ(ran.code, 0) << ran.err;
    };
    draw("b.json -o b.pfm");
    draw("a.json -o a.pfm --size 24x18 --max-depth 3 --spp 4 --sampler jittered --seed 9");
    EXPECT_EQ(readBytes("a.pfm"), readBytes("b.pfm"));
    draw("b.json -o c.pfm --max-depth 0");
    EXPECT_NE(readBytes("c.pfm"), readBytes("b.pfm"));
}

// Rays that fp32 holds exactly.

constexpr const char* kHeader = "hit,t,u,v,object,primitive,px,py,pz,nx,ny,nz\n";
constexpr const char* kMiss = "0,,,,,,,,,,,\n";

class Trace : public FolderTest {
  protected:
    // A unit sphere at the origin, object 0, and the triangle (2,0,0) (4,0,0) (2,4,0), object 1.
    void SetUp() override {
        writeText("a.json",
                  sceneText(3, 3, R"("objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1},
            {"type": "triangle", "vertices": [[2, 0, 0], [4, 0, 0], [2, 4, 0]]}])"));
    }

    static std::string traceBy(const Words& options) {
        const Ran ran = runGlint("trace a.json --backend " + kBackend, options);
        EXPECT_EQ(ran.code, 0) << ran.err;
        EXPECT_EQ(ran.err, "");
        EXPECT_STARTS(ran.out, kHeader);
        return ran.out.substr(std::string(kHeader).size());
    }

    static std::string trace(const std::string& rays, const Words& options = {}) {
        writeText("r.csv", rays);
        return traceBy("--rays r.csv" + options);
    }
};

// A ray's line of the CSV. The hit is that of the library; columns, digits and misses are the command's.
TEST_F(Trace, KnownHits) {
    const std::string sphere = ",0,0,0,0,0,0,1,0,0,1\n", back = ",0,0,0,0,0,0,-1,0,0,-1\n";
    const std::pair<const char*, std::string> cases[] = {
        {"0,0,5,0,0,-1", "1,4" + sphere},
        {"0,0,0,0,0,-1", "1,1" + back},  // from inside: the normal stays the outward one
        {"0,0,-5,0,0,-1", kMiss},
        {"0,0,5,0,0,-4", "1,1" + sphere},      // t is in units of the direction
        {"0,0,5,0,0,-1,0,4", "1,4" + sphere},  // tMin < t <= tMax
        {"0,0,5,0,0,-1,0,3.75", kMiss},
        {"0,0,5,0,0,-1,4,inf", "1,6" + back},
        {"nan,0,5,0,0,-1", kMiss},
        // P = (1-u-v)a + u b + v c: (3, 1, 0) is a + 1/2 (b-a) + 1/4 (c-a).
        {"3,1,-2,0,0,1", "1,2,0.5,0.25,1,0,3,1,0,0,0,1\n"}};
    std::string rays, lines;
    for (const auto& [ray, line] : cases) {
        rays += ray + std::string("\n");
        lines += line;
    }
    EXPECT_EQ(trace(rays), lines);
}

TEST_F(Trace, NoRays) {
    writeText("r.csv", "# none\n");
    const Ran ran = runGlint("trace a.json --rays r.csv --backend " + kBackend);
    EXPECT_EQ(ran.out, kHeader);
    EXPECT_EQ(ran.err, "glint: warning: r.csv: holds no rays\n");
}

TEST_F(Trace, AnyTellsHitsOnly) {
    EXPECT_EQ(trace("0,0,5,0,0,-1\n0,0,5,0,0,1\n0,0,5,0,0,-1,0,3\n3,1,2,0,0,-1\n", "--any"),
              std::string("1,,,,,,,,,,,\n") + kMiss + kMiss + "1,,,,,,,,,,,\n");
}

// The middle pixel of 3 x 3 looks along -z; the first one, at 45 degrees to each side of a 90 degree picture
// times 2/3, sees nothing.
TEST_F(Trace, PixelIsTheCameraRayOfItsCentre) {
    EXPECT_EQ(traceBy("--pixel 1,1"), "1,4,0,0,0,0,0,0,1,0,0,1\n");
    EXPECT_EQ(traceBy("--pixel 0,0"), kMiss);
    EXPECT_EQ(traceBy("--pixel 1,1 --any"), "1,,,,,,,,,,,\n");
    EXPECT_EQ(traceBy("--pixel 0,0 --any"), kMiss);
    EXPECT_EQ(traceBy("--pixel 4,4 --size 9x9"), "1,4,0,0,0,0,0,0,1,0,0,1\n");
}

// `object` is the index in the scene's list, also where another object comes first in the BVH; `primitive`
// the face's.
TEST_F(Trace, FacesAreNumberedAsInTheFile) {
    writeText("m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 6 1 0\nf 1 2 3 4\nf 5 6 7\n");
    writeText("a.json", sceneText(3, 3, R"("meshes": {"m": {"file": "m.obj"}}, "objects": [
        {"type": "plane", "point": [0, 0, -9], "normal": [0, 0, 1]}, {"type": "mesh", "mesh": "m"}])"));
    const std::string hits =
        trace("0.75,0.25,1,0,0,-1\n0.25,0.75,1,0,0,-1\n5.75,0.5,1,0,0,-1\n9,9,1,0,0,-1\n");
    std::vector<std::pair<double, double>> ids;
    for (const std::vector<double>& row : csvRows(kHeader + hits)) ids.emplace_back(row[4], row[5]);
    EXPECT_EQ(ids, (std::vector<std::pair<double, double>>{{1, 0}, {1, 0}, {1, 1}, {0, 0}}));
}

}  // namespace glint::app::test::either_test
