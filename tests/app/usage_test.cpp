// Command lines that are refused: exact text, exit code 2, nothing on standard output, no file.
#include "support.h"

namespace glint::app::test::usage_test {
using Usage = SmallSceneTest;

struct Case {
    Words args;
    const char* line;  // without "glint: " and the line's end
};

const Case kCases[] = {
    // Commands.
    {"paint",
     "unknown command \"paint\" (there are: render, merge, view, verify, report, bench, trace, diff, info, "
     "devices, pages); "
     "see glint --help"},
    {"rendr a.json", "unknown command \"rendr\" (did you mean \"render\"?); see glint --help"},
    {{""},
     "unknown command \"\" (there are: render, merge, view, verify, report, bench, trace, diff, info, "
     "devices, pages); see "
     "glint --help"},
    {{"a.json"}, "\"a.json\" is no command; did you mean: glint render a.json"},
    {"--size 3x3 render a.json",
     "the command comes first, then its options (got \"--size\"); see glint --help"},
    {"help verfy", "unknown command \"verfy\" (did you mean \"verify\"?); see glint --help"},
    {"view", "view: SCENE is required; see glint view --help"},
    {"view a.json --confidence 0.9", "view: --confidence requires --error; see glint view --help"},
    {"view a.json --within-depth", "view: --within-depth requires --error; see glint view --help"},
    {"render", "render: SCENE is required; see glint render --help"},
    {"diff a.png", "diff: B is required; see glint diff --help"},
    {"devices gpu", "devices: unexpected argument \"gpu\"; see glint devices --help"},
    {"render a.json b.json", "render: unexpected argument \"b.json\"; see glint render --help"},
    {"render ''", "SCENE: the name is empty"},
    {"merge a.part ''", "PART: the name is empty"},
    // Options.
    {"bench a.json --stats csv", "--stats: expected json, got \"csv\""},
    {"bench a.json --with quadrics,mirors", "--with: unknown feature \"mirors\" (did you mean \"mirrors\"?)"},
    {"bench a.json --backend cpu --full", "--full: needs --backend gpu"},
    {"render a.json --foo", "render: unknown option \"--foo\"; see glint render --help"},
    {"render --foo", "render: unknown option \"--foo\"; see glint render --help"},
    {"render a.json --siez 3x3",
     "render: unknown option \"--siez\" (did you mean \"--size\"?); see glint render --help"},
    {"render a.json --max-dept=3",
     "render: unknown option \"--max-dept\" (did you mean \"--max-depth\"?); see glint render --help"},
    {"info a.json --crop 0,0,1,1", "info: unknown option \"--crop\"; see glint info --help"},
    {"render a.json --size", "render: --size: 1 required WxH missing; see glint render --help"},
    {"render a.json --size -q", "--size: expected WxH such as 640x480, got \"-q\""},
    {"render a.json --size 3x3 --size 4x4",
     "render: --size: At Most 1 required but received 2; see glint render --help"},
    {"render a.json --quiet=maybe", "render: Could not convert: --quiet = maybe; see glint render --help"},
    {"render a.json --seed -7", "--seed: expected a whole number from 0 to 4294967295, got \"-7\""},
    {"render a.json --sampler random",
     "--sampler: expected auto, grid, jittered or lowDiscrepancy, got \"random\""},
    {"verify a.json --filter tent,0",
     "--filter: expected box, tent, gaussian or mitchell, and perhaps a radius from 0.01 to 8 pixels as in "
     "tent,1.5, got \"tent,0\""},
    {"render a.json --adaptive 64,2",
     "--adaptive: expected the most samples of a pixel, from 1 to 65536, and perhaps a threshold above 0, at "
     "most 1, as in 64,0.05, got \"64,2\""},
    {"render a.json --backend cpu --device 0", "--device: needs --backend gpu"},
    {"render a.json --backend cpu --validation", "--validation: needs --backend gpu"},
    {"render a.json --backend cpu --traversal lane", "--traversal: needs --backend gpu"},
    {"bench a.json --backend cpu --traversal all", "--traversal: needs --backend gpu"},
    {"render a.json --traversal all", "--traversal: expected auto, lane or packet, got \"all\""},
    {"bench a.json --backend cpu --whole-paths", "--whole-paths: needs --backend gpu"},
    {"report", "report: SCENE is required; see glint report --help"},
    {"report a.json", "report: --output is required; see glint report --help"},
    {"report a.json -o ''", "--output: the name is empty"},
    {"report a.json -o x --repeats 0", "--repeats: expected a whole number from 1 to 1000, got \"0\""},
    {"report a.json -o x --budget -1", "--budget: expected a whole number from 1 to 10000000, got \"-1\""},
    {"report a.json -o x --only grod", "--only: unknown setting \"grod\" (did you mean \"grid\"?)"},
    {"report a.json -o x --size 3", "--size: expected a whole number from 4 to 4096, got \"3\""},
    {"trace a.json", "trace: give either --rays FILE.csv or --pixel x,y"},
    {"trace a.json --rays r.csv --pixel 1,2", "--rays excludes --pixel: give one of them"},
    {"render a.json --error 0.1 --adaptive 64",
     "--error excludes --adaptive: leave out --adaptive, as --error chooses the samples of all pixels"},
    {"render a.json --error 0.1 --spp 4",
     "--error excludes --spp: limit the number of samples, which --error chooses, with --max-spp"},
    {"render a.json --error 0.1 --band-rows 8", "--error excludes --band-rows: use --spp with --band-rows"},
    {"render a.json --error 0.1 --part 1/2", "--error excludes --part: use --spp with --part"},
    {"render a.json --part 1/2 --band-rows 8",
     "--part excludes --band-rows: use more parts to need less memory, and merge --in-bands"},
    {"render a.json --part 1/2 --exposure 1",
     "--part excludes --exposure: parts hold linear floats; give --exposure to glint merge"},
    {"render a.json --part 1/2 --frames 0:2",
     "--part excludes --frames: give each machine frames of its own"},
    {"render a.json --frames 0:2 --time 1",
     "--frames excludes --time: choose the time by --fps, as frame N shows time N / fps"},
    {"render a.json --frames 0:2 -o f.pfm",
     "f.pfm: the name of several frames has # in the place of each digit of their number, such as "
     "frame.####.png"},
    {"render a.json --overwrite", "render: --overwrite requires --frames; see glint render --help"},
    {"render a.json --checkpoint c --error 0.1",
     "--error excludes --checkpoint: use --spp with --checkpoint"},
    {"render a.json --part 1/2 --checkpoint c",
     "--part excludes --checkpoint: use more parts, each of which is soon repeated"},
    {"render a.json --frames 0:2 --checkpoint c",
     "--checkpoint excludes --frames: leave out --checkpoint, as --frames skips frames that exist"},
    {"render a.json --frames 0:2 --band-rows 8",
     "--frames excludes --band-rows: render the frame alone by --time SECONDS"},
    {"render a.json -o - --part 1/2",
     "--output -: with --part, --checkpoint, --frames or --band-rows name a file"},
    {"verify a.json --json r --junit r", "--junit: --json writes this file; name another one"},
    {"render a.json -o a.jpg", "a.jpg: unknown image format .jpg (use .png, .exr, .pfm or .hdr)"},
    {"diff a b -o d.txt", "d.txt: unknown image format .txt (use .png, .exr, .pfm or .hdr)"},
    // Values that depend on the scene.
    {"render a.json --backend cpu --crop 0,0,65,48", "--crop: reaches beyond the image of 64x48 pixels"},
    {"render a.json --backend cpu --crop 0,0,99999999999999999999,48",
     "--crop: reaches beyond the image of 64x48 pixels"},
    {"render a.json --backend cpu --crop 64,48,65,49", "--crop: reaches beyond the image of 64x48 pixels"},
    {"trace a.json --backend cpu --pixel 64,0", "--pixel: 64,0 is outside the image of 64x48 pixels"},
    {"trace a.json --backend cpu --pixel 99999999999999999999,0",
     "--pixel: expected x,y below 65536, got \"99999999999999999999,0\""},
    {"trace a.json --backend cpu --pixel 0,-1", "--pixel: 0,-1 is outside the image of 64x48 pixels"},
    {"trace a.json --pixel 0,48", "--pixel: 0,48 is outside the image of 64x48 pixels"},
};

TEST_F(Usage, OneLineAndExitCode2) {
    for (const auto& [args, line] : kCases) expectError(args, 2, line);
    EXPECT_EQ(names(), std::set<std::string>{"a.json"});
}

TEST(Help, IsTheSameByEveryOptionAndCommand) {
    const std::string help = runGlint("--help").out;
    EXPECT_EQ(runGlint("--help").code, 0);
    EXPECT_EQ(runGlint("--help").err, "");
    EXPECT_EQ(runGlint("-h").out, help);
    EXPECT_EQ(runGlint("help").out, help);
    EXPECT_EQ(runGlint({}).err, help);
    EXPECT_EQ(runGlint({}).out, "");
    EXPECT_EQ(runGlint("help render").out, runGlint("render --help").out);
}

TEST(Help, NamesEveryCommandAndExitCode) {
    const std::string help = runGlint("--help").out;
    for (const char* word : {"render", "view", "verify", "report", "bench", "trace", "diff", "info",
                             "devices", "0 done", "1 could not render or write", "2 usage", "3 invalid scene",
                             "4 no usable device", "5 difference found", "130 interrupted"}) {
        EXPECT_HAS(help, word) << word;
    }
}

// The window reads files alone, and has a size of its own.
TEST(Help, StatesWhatTheWindowTakes) {
    const std::string help = runGlint("view --help").out;
    EXPECT_LACKS(help, "standard input");
    EXPECT_HAS(help, "size in pixels (default: a window of 1280x800 or more)");
}

TEST(Help, VersionIsOneLine) {
    const Ran ran = runGlint("--version");
    EXPECT_EQ(ran.code, 0);
    EXPECT_STARTS(ran.out, "glint ");
    EXPECT_EQ(ran.out.find('\n'), ran.out.size() - 1);
}

}  // namespace glint::app::test::usage_test
