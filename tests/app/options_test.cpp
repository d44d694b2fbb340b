// Option values from text, through the whole command line: `glint COMMAND x.json OPTION VALUE`, where x.json
// does not exist. A value that is fine leads to the complaint about the missing file, with exit code 3.
#include "app/options.h"
#include "core/text_file.h"
#include "support.h"

namespace glint::app::test::options_test {

class OptionValue : public FolderTest {
  protected:
    // `line`: after "glint: "; empty: the value is fine.
    void expectLine(const std::string& command, const std::string& option, const std::string& text,
                    const std::string& line) {
        SCOPED_TRACE(command + " " + option + " " + text);
        expectError({command, "x.json", option, text}, line.empty() ? 3 : 2,
                    line.empty() ? "x.json: no such file" : line);
        EXPECT_TRUE(names().empty());
    }
};

using Texts = std::vector<std::string>;

TEST_F(OptionValue, IsTaken) {
    const std::pair<const char*, Texts> cases[] = {
        {"--size", {"1x1", "800x600"}}, {"--spp", {"1", "65536"}},
        {"--max-depth", {"0", "1000"}}, {"--frames", {"3"}},
        {"--crop", {"0,0,1,1"}},        {"--aov", {"color,depth", " color , depth"}},
        {"--backend", {"cpu", "gpu"}},  {"--progress", {"none"}},
        {"--stats", {"json"}}};
    for (const auto& [option, texts] : cases)
        for (const std::string& text : texts) expectLine("render", option, text, "");
    expectLine("trace", "--pixel", "3,4", "");
}

// Texts that are refused by naming what is expected.
struct Refused {
    const char *option, *expected;
    Texts texts;
    const char* command = "render";
};

TEST_F(OptionValue, IsRefusedInOneLine) {
    const char *const size = "WxH such as 640x480", *const frames =
                                                        "A:B with 0 <= A <= B, such as 0:240, or one number";
    const char* const progress = "auto, bar, plain or none";
    const Refused cases[] = {
        {"--size",
         "a width and a height from 1 to 65536",
         {"0x0", "5x0", "-5x3", "65537x1", "99999999999999999999x3"}},
        {"--size", size, {"640x", "x480", "640", "640X480", "1e9x1e9", "64x48x3", " 64x48", "64.5x48", ""}},
        {"--size", size, {"0"}, "trace"},
        {"--size", size, {"0"}, "info"},
        {"--size", size, {"0"}, "verify"},
        {"--spp",
         "a whole number from 1 to 65536",
         {"0", "-4", "65537", "1.5", "1e3", "many", "", "99999999999999999999"}},
        {"--max-depth", "a whole number from 0 to 1000", {"-1", "1001", "-99999999999999999999"}},
        {"--part", "K/N with 1 <= K <= N, such as 3/8", {"0/4", "5/4"}},
        {"--frames", frames, {"3:2", "1:2:3"}},
        {"--error", "a number above 0", {"0", "-1", "nan", "inf", "", "1e-400"}},
        {"--crop",
         "x0,y0,x1,y1 with 0 <= x0 < x1 and 0 <= y0 < y1",
         {"5,5,5,6", "5,5,6,5", "9,9,5,5", "-1,0,3,3"}},
        {"--crop", "x0,y0,x1,y1 such as 0,0,64,64", {"1,2,3", "1,2,3,4,5", "a", "0, 0, 5, 5", ""}},
        {"--pixel", "x,y such as 320,240", {"3", "3,4,5", "a,b"}, "trace"},
        {"--backend", "gpu or cpu", {"CPU"}},
        {"--backend", "gpu or cpu", {""}, "trace"},
        {"--progress", progress, {"on"}},
        {"--progress", progress, {""}, "verify"},
        {"--stats", "json", {"xml", ""}}};
    for (const auto& [option, expected, texts, command] : cases)
        for (const std::string& text : texts)
            expectLine(command, option, text,
                       std::string(option) + ": expected " + expected + ", got \"" + text + "\"");
}

TEST_F(OptionValue, NamesTheLayerThatIsRefused) {
    const std::string known =
        " (known: color, alpha, depth, position, normal, uv, object, primitive, material, bounces, cost, "
        "error, samples)";
    const std::pair<const char*, std::string> cases[] = {
        {"", "unknown layer \"\"" + known},
        {",", "unknown layer \"\"" + known},
        {"color,", "unknown layer \"\"" + known},
        {"xyzzy", "unknown layer \"xyzzy\"" + known},
        {"dpeth", "unknown layer \"dpeth\" (did you mean \"depth\"?)"},
        {"Color", "unknown layer \"Color\" (did you mean \"color\"?)"},
        {"uv,uv", "the layer \"uv\" is given twice"}};
    for (const auto& [text, line] : cases) expectLine("render", "--aov", text, "--aov: " + line);
}

TEST(Options, ToleranceIsAFiniteNumberFromZeroUp) {
    for (const std::string text : {"-1", "nan", "inf", "1x", "", "0x1", "1e999", "-0.001", " 1"})
        expectError({"diff", "a.png", "b.png", "--tolerance", text}, 2,
                    "--tolerance: expected a number from 0 up, got \"" + text + "\"");
    EXPECT_EQ(parseNotNegative("0"), 0.0);
    EXPECT_EQ(parseNotNegative("1e-3"), 1e-3);
}

TEST(Options, TextInMessagesIsOneShortLine) {
    EXPECT_EQ(quoted("a\nb\t\x7f"), "\"a?b??\"");
    EXPECT_EQ(quoted(std::string(100, 'x')), "\"" + std::string(60, 'x') + "...\"");
    EXPECT_EQ(quoted("\xc3\xa4"), "\"\xc3\xa4\"");
}

}  // namespace glint::app::test::options_test
