// Option values from text, through the whole command line: `glint COMMAND x.json OPTION VALUE`, where x.json
// does not exist. A value that is fine leads to the complaint about the missing file, with exit code 3.
#include "app/options.h"
#include "core/text_file.h"
#include "support.h"

namespace glint::app::test::options_test {

struct Value {
    const char* command;
    const char* option;
    std::string text;
    std::string line;  // after "glint: "; empty: the value is fine
};

class OptionValue : public FolderTest, public ::testing::WithParamInterface<Value> {};

TEST_P(OptionValue, IsTakenOrRefusedInOneLine) {
    const Value& v = GetParam();
    const Ran ran = runGlint({v.command, "x.json", v.option, v.text});
    EXPECT_EQ(ran.err, "glint: " + (v.line.empty() ? "x.json: no such file" : v.line) + "\n")
        << v.option << ' ' << v.text;
    EXPECT_EQ(ran.code, v.line.empty() ? 3 : 2);
    EXPECT_EQ(ran.out, "");
    EXPECT_TRUE(names().empty());
}

Value refused(const char* option, const std::string& text, const std::string& wanted,
              const char* command = "render") {
    return {command, option, text, std::string(option) + ": expected " + wanted + ", got \"" + text + "\""};
}

const std::string kSizeForm = "WxH such as 640x480", kSizeRange = "a width and a height from 1 to 65536";
INSTANTIATE_TEST_SUITE_P(
    Size, OptionValue,
    ::testing::Values(Value{"render", "--size", "1x1", ""}, Value{"render", "--size", "800x600", ""},
                      refused("--size", "0x0", kSizeRange), refused("--size", "5x0", kSizeRange),
                      refused("--size", "-5x3", kSizeRange), refused("--size", "65537x1", kSizeRange),
                      refused("--size", "99999999999999999999x3", kSizeRange),
                      refused("--size", "640x", kSizeForm), refused("--size", "x480", kSizeForm),
                      refused("--size", "640", kSizeForm), refused("--size", "640X480", kSizeForm),
                      refused("--size", "1e9x1e9", kSizeForm), refused("--size", "64x48x3", kSizeForm),
                      refused("--size", " 64x48", kSizeForm), refused("--size", "64.5x48", kSizeForm),
                      refused("--size", "", kSizeForm), refused("--size", "0", kSizeForm, "trace"),
                      refused("--size", "0", kSizeForm, "info"),
                      refused("--size", "0", kSizeForm, "verify")));

const std::string kSpp = "a whole number from 1 to 65536", kDepth = "a whole number from 0 to 1000";
INSTANTIATE_TEST_SUITE_P(
    Counts, OptionValue,
    ::testing::Values(Value{"render", "--spp", "1", ""}, Value{"render", "--spp", "65536", ""},
                      refused("--spp", "0", kSpp), refused("--spp", "-4", kSpp),
                      refused("--spp", "65537", kSpp), refused("--spp", "1.5", kSpp),
                      refused("--spp", "1e3", kSpp), refused("--spp", "many", kSpp),
                      refused("--spp", "", kSpp), refused("--spp", "99999999999999999999", kSpp),
                      Value{"render", "--max-depth", "0", ""}, Value{"render", "--max-depth", "1000", ""},
                      refused("--max-depth", "-1", kDepth), refused("--max-depth", "1001", kDepth),
                      refused("--max-depth", "-99999999999999999999", kDepth)));

const std::string kPart = "K/N with 1 <= K <= N, such as 3/8", kError = "a number above 0";
INSTANTIATE_TEST_SUITE_P(
    Ranges, OptionValue,
    ::testing::Values(refused("--part", "0/4", kPart), refused("--part", "5/4", kPart),
                      refused("--frames", "3:2", "A:B with 0 <= A <= B, such as 0:240, or one number"),
                      refused("--frames", "1:2:3", "A:B with 0 <= A <= B, such as 0:240, or one number"),
                      Value{"render", "--frames", "3", ""}, refused("--error", "0", kError),
                      refused("--error", "-1", kError), refused("--error", "nan", kError),
                      refused("--error", "inf", kError), refused("--error", "", kError),
                      refused("--error", "1e-400", kError)));

const std::string kCropForm = "x0,y0,x1,y1 such as 0,0,64,64",
                  kCropOrder = "x0,y0,x1,y1 with 0 <= x0 < x1 and 0 <= y0 < y1";
INSTANTIATE_TEST_SUITE_P(
    Places, OptionValue,
    ::testing::Values(Value{"render", "--crop", "0,0,1,1", ""}, refused("--crop", "5,5,5,6", kCropOrder),
                      refused("--crop", "5,5,6,5", kCropOrder), refused("--crop", "9,9,5,5", kCropOrder),
                      refused("--crop", "-1,0,3,3", kCropOrder), refused("--crop", "1,2,3", kCropForm),
                      refused("--crop", "1,2,3,4,5", kCropForm), refused("--crop", "a", kCropForm),
                      refused("--crop", "0, 0, 5, 5", kCropForm), refused("--crop", "", kCropForm),
                      refused("--pixel", "3", "x,y such as 320,240", "trace"),
                      refused("--pixel", "3,4,5", "x,y such as 320,240", "trace"),
                      refused("--pixel", "a,b", "x,y such as 320,240", "trace"),
                      Value{"trace", "--pixel", "3,4", ""}));

const std::string kKnown =
    " (known: color, alpha, depth, position, normal, uv, object, primitive, material, bounces, cost, error, "
    "samples)";
INSTANTIATE_TEST_SUITE_P(
    Aovs, OptionValue,
    ::testing::Values(
        Value{"render", "--aov", "color,depth", ""}, Value{"render", "--aov", " color , depth", ""},
        Value{"render", "--aov", "", "--aov: unknown layer \"\"" + kKnown},
        Value{"render", "--aov", ",", "--aov: unknown layer \"\"" + kKnown},
        Value{"render", "--aov", "color,", "--aov: unknown layer \"\"" + kKnown},
        Value{"render", "--aov", "xyzzy", "--aov: unknown layer \"xyzzy\"" + kKnown},
        Value{"render", "--aov", "dpeth", "--aov: unknown layer \"dpeth\" (did you mean \"depth\"?)"},
        Value{"render", "--aov", "Color", "--aov: unknown layer \"Color\" (did you mean \"color\"?)"},
        Value{"render", "--aov", "uv,uv", "--aov: the layer \"uv\" is given twice"}));

const std::string kNumber = "a number from 0 up";
INSTANTIATE_TEST_SUITE_P(Words, OptionValue,
                         ::testing::Values(Value{"render", "--backend", "cpu", ""},
                                           Value{"render", "--backend", "gpu", ""},
                                           refused("--backend", "CPU", "gpu or cpu"),
                                           refused("--backend", "", "gpu or cpu", "trace"),
                                           Value{"render", "--progress", "none", ""},
                                           refused("--progress", "on", "auto, bar, plain or none"),
                                           refused("--progress", "", "auto, bar, plain or none", "verify"),
                                           Value{"render", "--stats", "json", ""},
                                           refused("--stats", "xml", "json"),
                                           refused("--stats", "", "json")));

TEST(Options, ToleranceIsAFiniteNumberFromZeroUp) {
    for (const char* text : {"-1", "nan", "inf", "1x", "", "0x1", "1e999", "-0.001", " 1"}) {
        const Ran ran = runGlint({"diff", "a.png", "b.png", "--tolerance", text});
        EXPECT_EQ(ran.err,
                  std::string("glint: --tolerance: expected a number from 0 up, got \"") + text + "\"\n");
        EXPECT_EQ(ran.code, 2);
    }
    EXPECT_EQ(parseNotNegative("0"), 0.0);
    EXPECT_EQ(parseNotNegative("1e-3"), 1e-3);
}

TEST(Options, ValuesArrive) {
    EXPECT_EQ(parseSize("640x480").width, 640);
    EXPECT_EQ(parseSize("640x480").height, 480);
    const Region crop = parseCrop("1,2,30,40");
    EXPECT_EQ(std::vector({crop.x0, crop.y0, crop.x1, crop.y1}), std::vector({1, 2, 30, 40}));
    EXPECT_EQ(parsePixel("7,-8"), std::pair(7, -8));
    EXPECT_EQ(parseAovs("color, depth ,cost"), (std::vector<Aov>{Aov::Radiance, Aov::Depth, Aov::Cost}));
    EXPECT_EQ(parseWhole("12", 1, 16), 12);
}

TEST(Options, TextInMessagesIsOneShortLine) {
    EXPECT_EQ(quoted("a\nb\t\x7f"), "\"a?b??\"");
    EXPECT_EQ(quoted(std::string(100, 'x')), "\"" + std::string(60, 'x') + "...\"");
    EXPECT_EQ(quoted("\xc3\xa4"), "\"\xc3\xa4\"");
}

}  // namespace glint::app::test::options_test
