// Command lines that are refused: exact text, exit code 2, nothing on standard output, no file.
#include "support.h"

namespace glint::app::test::usage_test {
struct Case {
    const char* name;
    Words args;
    const char* line;  // without "glint: " and the line's end
};

void PrintTo(const Case& c, std::ostream* out) {
    *out << c.name;
}

class Usage : public SmallSceneTest, public ::testing::WithParamInterface<Case> {};

TEST_P(Usage, OneLineAndExitCode2) {
    expectError(GetParam().args, 2, GetParam().line);
    EXPECT_EQ(names(), std::set<std::string>{"a.json"});
}

const Case kCommands[] = {
    {"unknown", "paint",
     "unknown command \"paint\" (there are: render, merge, view, verify, report, bench, trace, diff, ...); "
     "see glint --help"},
    {"misspelt", "rendr a.json", "unknown command \"rendr\" (did you mean \"render\"?); see glint --help"},
    {"empty",
     {""},
     "unknown command \"\" (there are: render, merge, view, verify, report, bench, trace, diff, ...); see "
     "glint --help"},
    {"file", {"a.json"}, "\"a.json\" is no command; did you mean: glint render a.json"},
    {"optionFirst", "--size 3x3 render a.json",
     "the command comes first, then its options (got \"--size\"); see glint --help"},
    {"helpOfUnknown", "help verfy", "unknown command \"verfy\" (did you mean \"verify\"?); see glint --help"},
    {"viewAlone", "view", "view: SCENE is missing; see glint view --help"},
    {"viewPresent", "view a.json --present fast",
     "--present: expected fifo, mailbox, immediate or fifoRelaxed, got \"fast\""},
    {"renderAlone", "render", "render: SCENE is missing; see glint render --help"},
    {"diffOne", "diff a.png", "diff: B is missing; see glint diff --help"},
    {"devicesArgument", "devices gpu", "devices: unexpected argument \"gpu\"; see glint devices --help"},
    {"extra", "render a.json b.json", "render: unexpected argument \"b.json\"; see glint render --help"},
    {"emptyScene", "render ''", "SCENE: the name is empty"},
    {"emptyPart", "merge a.part ''", "PART: the name is empty"},
};
INSTANTIATE_TEST_SUITE_P(Commands, Usage, ::testing::ValuesIn(kCommands),
                         [](const auto& test) { return test.param.name; });

const Case kOptions[] = {
    {"benchStats", "bench a.json --stats csv", "--stats: expected json, got \"csv\""},
    {"benchWith", "bench a.json --with quadrics,mirors",
     "--with: unknown feature \"mirors\" (did you mean \"mirrors\"?)"},
    {"benchFullOnHost", "bench a.json --backend cpu --full", "--full: needs --backend gpu"},
    {"unknown", "render a.json --foo", "render: unknown option \"--foo\"; see glint render --help"},
    {"unknownWithoutScene", "render --foo", "render: unknown option \"--foo\"; see glint render --help"},
    {"misspelt", "render a.json --siez 3x3",
     "render: unknown option \"--siez\" (did you mean \"--size\"?); see glint render --help"},
    {"misspeltEquals", "render a.json --max-dept=3",
     "render: unknown option \"--max-dept\" (did you mean \"--max-depth\"?); see glint render --help"},
    {"ofAnotherCommand", "info a.json --crop 0,0,1,1",
     "info: unknown option \"--crop\"; see glint info --help"},
    {"noValue", "render a.json --size", "render: --size needs a value: WxH; see glint render --help"},
    {"optionForValue", "render a.json --size -q", "--size: expected WxH such as 640x480, got \"-q\""},
    {"twice", "render a.json --size 3x3 --size 4x4",
     "render: --size is given more than once; see glint render --help"},
    {"flagValue", "render a.json --quiet=no", "render: --quiet takes no value; see glint render --help"},
    {"seed", "render a.json --seed -7", "--seed: expected a whole number from 0 to 4294967295, got \"-7\""},
    {"sampler", "render a.json --sampler random",
     "--sampler: expected auto, grid, jittered or lowDiscrepancy, got \"random\""},
    {"filter", "verify a.json --filter tent,0",
     "--filter: expected box, tent, gaussian or mitchell, and perhaps a radius from 0.01 to 8 pixels as in "
     "tent,1.5, got \"tent,0\""},
    {"adaptive", "render a.json --adaptive 64,2",
     "--adaptive: expected the most samples of a pixel, from 1 to 65536, and perhaps a threshold above 0, at "
     "most 1, as in 64,0.05, got \"64,2\""},
    {"cpuDevice", "render a.json --backend cpu --device 0", "--device: needs --backend gpu"},
    {"cpuValidation", "render a.json --backend cpu --validation", "--validation: needs --backend gpu"},
    {"cpuTraversal", "render a.json --backend cpu --traversal lane", "--traversal: needs --backend gpu"},
    {"cpuTraversals", "bench a.json --backend cpu --traversal all", "--traversal: needs --backend gpu"},
    {"traversalAll", "render a.json --traversal all",
     "--traversal: expected auto, lane or packet, got \"all\""},
    {"wholePathsOnHost", "bench a.json --backend cpu --whole-paths", "--whole-paths: needs --backend gpu"},
    {"reportAlone", "report", "report: SCENE is missing; see glint report --help"},
    {"reportNowhere", "report a.json", "report: --output is missing; see glint report --help"},
    {"reportFolder", "report a.json -o ''", "--output: the name is empty"},
    {"reportRepeats", "report a.json -o x --repeats 0",
     "--repeats: expected a whole number from 1 to 1000, got \"0\""},
    {"reportTruth", "report a.json -o x --truth x", "--truth: expected gpu or cpu, got \"x\""},
    {"reportBudget", "report a.json -o x --budget -1",
     "--budget: expected a whole number from 1 to 10000000, got \"-1\""},
    {"reportOnly", "report a.json -o x --only grod",
     "--only: unknown setting \"grod\" (did you mean \"grid\"?)"},
    {"reportDevices", "report a.json -o x --devices cpu,,0",
     "--devices: a device's name is empty in \"cpu,,0\""},
    {"reportNoDevice",
     {"report", "a.json", "-o", "x", "--devices", ""},
     "--devices: a device's name is empty in \"\""},
    {"reportDevice", "report a.json -o x --only device", "--only device requires --devices"},
    {"reportSize", "report a.json -o x --size 3",
     "--size: expected a whole number from 4 to 4096, got \"3\""},
    {"traceNeither", "trace a.json", "trace: give either --rays FILE.csv or --pixel x,y"},
    {"traceBoth", "trace a.json --rays r.csv --pixel 1,2", "--rays excludes --pixel: give one of them"},
    {"errorAdaptive", "render a.json --error 0.1 --adaptive 64",
     "--error excludes --adaptive: leave out --adaptive, as --error chooses the samples of all pixels"},
    {"errorSpp", "render a.json --error 0.1 --spp 4",
     "--spp: --error chooses the number of samples; limit it with --max-spp"},
    {"errorBands", "render a.json --error 0.1 --band-rows 8",
     "--error excludes --band-rows: use --spp with --band-rows"},
    {"errorPart", "render a.json --error 0.1 --part 1/2", "--error excludes --part: use --spp with --part"},
    {"partBands", "render a.json --part 1/2 --band-rows 8",
     "--part excludes --band-rows: use more parts to need less memory, and merge --in-bands"},
    {"partExposure", "render a.json --part 1/2 --exposure 1",
     "--exposure: parts hold linear floats; give it to glint merge"},
    {"partFrames", "render a.json --part 1/2 --frames 0:2",
     "--part excludes --frames: give each machine frames of its own"},
    {"framesTime", "render a.json --frames 0:2 --time 1",
     "--frames excludes --time: choose the time by --fps, as frame N shows time N / fps"},
    {"framesName", "render a.json --frames 0:2 -o f.pfm",
     "f.pfm: the name of several frames has # in the place of each digit of their number, such as "
     "frame.####.png"},
    {"overwriteAlone", "render a.json --overwrite",
     "render: --overwrite requires --frames; see glint render --help"},
    {"errorCheckpoint", "render a.json --checkpoint c --error 0.1",
     "--error excludes --checkpoint: use --spp with --checkpoint"},
    {"partCheckpoint", "render a.json --part 1/2 --checkpoint c",
     "--part excludes --checkpoint: use more parts, each of which is soon repeated"},
    {"framesCheckpoint", "render a.json --frames 0:2 --checkpoint c",
     "--checkpoint excludes --frames: leave out --checkpoint, as --frames skips frames that exist"},
    {"framesBands", "render a.json --frames 0:2 --band-rows 8",
     "--frames excludes --band-rows: render the frame alone by --time SECONDS"},
    {"standardOutput", "render a.json -o - --part 1/2",
     "--output -: with --part, --checkpoint, --frames or --band-rows name a file"},
    {"oneFileTwice", "verify a.json --json r --junit r",
     "--junit: --json writes this file; name another one"},
    {"unknownFormat", "render a.json -o a.jpg",
     "a.jpg: unknown image format .jpg (use .png, .exr, .pfm or .hdr)"},
    {"diffFormat", "diff a b -o d.txt", "d.txt: unknown image format .txt (use .png, .exr, .pfm or .hdr)"},
};
INSTANTIATE_TEST_SUITE_P(Options, Usage, ::testing::ValuesIn(kOptions),
                         [](const auto& test) { return test.param.name; });

const Case kLateValues[] = {
    {"cropBeyond", "render a.json --backend cpu --crop 0,0,65,48",
     "--crop: reaches beyond the image of 64x48 pixels"},
    {"cropFarBeyond", "render a.json --backend cpu --crop 0,0,99999999999999999999,48",
     "--crop: reaches beyond the image of 64x48 pixels"},
    {"cropOutside", "render a.json --backend cpu --crop 64,48,65,49",
     "--crop: reaches beyond the image of 64x48 pixels"},
    {"pixelBeyond", "trace a.json --backend cpu --pixel 64,0",
     "--pixel: 64,0 is outside the image of 64x48 pixels"},
    {"pixelFarBeyond", "trace a.json --backend cpu --pixel 99999999999999999999,0",
     "--pixel: expected x,y below 65536, got \"99999999999999999999,0\""},
    {"pixelNegative", "trace a.json --backend cpu --pixel 0,-1",
     "--pixel: 0,-1 is outside the image of 64x48 pixels"},
    {"pixelOfGpu", "trace a.json --pixel 0,48", "--pixel: 0,48 is outside the image of 64x48 pixels"},
};
INSTANTIATE_TEST_SUITE_P(LateValues, Usage, ::testing::ValuesIn(kLateValues),
                         [](const auto& test) { return test.param.name; });

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

TEST(Help, VersionIsOneLine) {
    const Ran ran = runGlint("--version");
    EXPECT_EQ(ran.code, 0);
    EXPECT_STARTS(ran.out, "glint ");
    EXPECT_EQ(ran.out.find('\n'), ran.out.size() - 1);
}

}  // namespace glint::app::test::usage_test
