// `glint render --part` and `glint merge`, on the reference.
#include "core/image_io.h"
#include "support.h"

namespace glint::app::test::part_test {
class Part : public SmallSceneTest {
  protected:
    static Ran part(const std::string& which, const Words& more = {}) {
        return runGlint({"render", "a.json", "--backend", "cpu", "--part", which}, more);
    }
};

TEST_F(Part, MergedPicturesAreTheBytesOfOneRun) {
    const std::string layers =
        "color,alpha,depth,position,normal,uv,object,primitive,material,bounces,cost,samples";
    const Words options =
        "--backend cpu --spp 6 --sampler jittered --adaptive 24,0.05 --crop 3,1,60,44 --aov " + layers;
    for (const int parts : {1, 3, 7}) expectPartsAreTheWhole("a.json", options, parts);
}

TEST_F(Part, NamesAndSummary) {
    const Ran first = part("1/2");
    EXPECT_EQ(first.code, 0);
    EXPECT_STARTS(first.out, "wrote a.1-of-2.part (part 1 of 2, ");
    EXPECT_EQ(part("2/2", "--stats json").code, 0);
    const Ran merged = runGlint("merge a.1-of-2.part a.2-of-2.part");
    EXPECT_EQ(merged.code, 0);
    EXPECT_STARTS(merged.out, "wrote a.png (64x48)\ndevice: CPU reference (double precision)\nhash: ");
    const nlohmann::json whole = jsonOf("render a.json --backend cpu --stats json -o b.png");
    const nlohmann::json json = jsonOf("merge a.2-of-2.part a.1-of-2.part --in-bands --stats json -o ./");
    EXPECT_EQ(json["hash"], whole["hash"]);
    EXPECT_EQ(json["parts"], 2);
    EXPECT_EQ(json["inBands"], true);
    EXPECT_EQ(readImage("a.png").pixels, readImage("b.png").pixels);
}

TEST_F(Part, TheMergedPictureIsExposed) {
    ASSERT_EQ(part("1/1", "-q -o 1.part").code, 0);
    ASSERT_EQ(runGlint("render a.json --backend cpu -q --exposure -2").code, 0);
    for (const bool rows : {false, true}) {
        Words merge = "merge 1.part -o all.png --exposure -2 -q";
        if (rows) merge.push_back("--in-bands");
        ASSERT_EQ(runGlint(merge).code, 0);
        EXPECT_EQ(readImage("all.png").pixels, readImage("a.png").pixels);
    }
}

TEST_F(Part, OptionsThatMakeNoSense) {
    const Words half = "render a.json --backend cpu --part 1/2 -o";
    expectError(half + "a.png", 2,
                "a.png: the name of a part ends in .part; glint merge makes an image from the parts");
    expectError(half + "no/a.part", 1, "no/a.part: cannot write: there is no folder no");
    EXPECT_EQ(names(), (std::set<std::string>{"a.json"}));
}

// Parts of different renders are told apart by name.
TEST_F(Part, ForeignPartsAreNamed) {
    ASSERT_EQ(part("1/2", "-q").code, 0);
    const auto expectDifference = [](const std::string& which, const Words& options,
                                     const std::string& line) {
        EXPECT_EQ(part(which, "-q -o b.part" + options).code, 0);
        expectError("merge a.1-of-2.part b.part", 1,
                    "b.part: comes from another render than a.1-of-2.part: " + line);
    };
    expectDifference(
        "2/2", "--spp 4",
        "samples is 4 grid, filter box 0.5, seed 0 there and 1 grid, filter box 0.5, seed 0 here");
    expectDifference("2/2", "--size 32x24", "size is 32x24 there and 64x48 here");
    expectDifference("2/3", "", "parts is 3 there and 2 here");
    expectDifference("2/2", "--aov color,depth", "layers is color,depth there and color here");
    writeText("a.json", sceneText(64, 48, R"("objects": [])"));
    expectDifference("2/2", "", "file a.json has other contents there");
    expectError("merge a.1-of-2.part", 1, "part 2 of 2 is missing");
    EXPECT_EQ(names(), (std::set<std::string>{"a.json", "a.1-of-2.part", "b.part"}));
    writeText("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n");
    const Words half = "render m.obj --backend cpu -q --part 1/2 -o";
    EXPECT_EQ(runGlint(half + "y.part --up y").code + runGlint(half + "z.part --up z").code, 0);
    expectError("merge y.part z.part", 1,
                "z.part: comes from another render than y.part: up is z there and y here");
}

}  // namespace glint::app::test::part_test
