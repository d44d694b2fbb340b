// The program itself, on the reference: interrupts, progress, terminals, a machine without Vulkan.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <tuple>

#include "child.h"
#include "core/image_io.h"
#include "support.h"

namespace glint::app::test::process_test {
using Process = ChildTest;

// Minutes of work, in rows of a fraction of a second.
const Words kLong = "render a.json --backend cpu --size 1000x4000 --spp 64 -o out.png";
// Minutes of work for each row.
const Words kLongRows = "render a.json --backend cpu --size 60000x8 --spp 4096 -o out.png";

TEST_F(Process, ExitCodesAndStreams) {
    Child fine("render a.json --backend cpu");
    EXPECT_EQ(fine.wait(), 0);
    EXPECT_STARTS(fine.out(), "wrote a.png (64x48)\n");
    EXPECT_EQ(fine.err(), "");
    const std::tuple<const char*, int, const char*> faults[] = {
        {"rendr", 2, "unknown command \"rendr\" (did you mean \"render\"?); see glint --help"},
        {"render no.json", 3, "no.json: no such file"},
        {"render a.json -o no/a.png", 1, "no/a.png: cannot write: there is no folder no"}};
    for (const auto& [words, code, line] : faults) {
        Child child(words);
        EXPECT_EQ(child.wait(), code);
        EXPECT_EQ(child.out(), "");
        EXPECT_EQ(child.err(), std::string("glint: ") + line + "\n");
    }
    Child nothing({});
    EXPECT_EQ(nothing.wait(), 2);
}

using glint::test::readText;

// Run by a shell, which can close streams and limit resources.
int shell(const std::string& text) {
    const int status = std::system(text.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// A closed stream is found before the work, and a picture does not go to where results should.
TEST_F(Process, ClosedStandardOutput) {
    const std::string render = std::string("'" GLINT_PROGRAM "' render a.json --backend cpu ");
    for (const std::string to : {">&-", "> /dev/full"}) {
        EXPECT_EQ(shell(render + to + " 2> err.txt"), 1);
        EXPECT_EQ(readText("err.txt"), "glint: cannot write to standard output: No space left on device\n");
        EXPECT_EQ(names(), (std::set<std::string>{"a.json", "err.txt"}));
        EXPECT_EQ(shell(render + "--stats json -q " + to + " 2> err.txt"), 1);
        EXPECT_EQ(names(), (std::set<std::string>{"a.json", "err.txt"}));
        // Without output no stream is needed.
        EXPECT_EQ(shell(render + "-q " + to + " 2> err.txt"), 0);
        EXPECT_EQ(readText("err.txt"), "");
        EXPECT_EQ(readImage("a.png").width, 64);
        std::filesystem::remove("a.png");
    }
}

TEST_F(Process, StandardStreams) {
    const std::string render = "'" GLINT_PROGRAM "' render ";
    ASSERT_EQ(shell(render + "a.json --backend cpu -q -o a.png"), 0);
    EXPECT_EQ(shell(render + "- --backend cpu --threads 3 < a.json > out.txt"), 0);
    EXPECT_HAS(readText("out.txt"), "(double precision), 3 threads\n");
    EXPECT_EQ(readBytes("stdin.png"), readBytes("a.png"));
    EXPECT_EQ(shell(render + "- --backend cpu -o - < a.json > b.png 2> err.txt"), 0);
    EXPECT_EQ(readText("err.txt"), "");
    EXPECT_EQ(readBytes("b.png"), readBytes("a.png"));
    EXPECT_EQ(shell(render + "a.json --backend cpu -o - > /dev/full 2> err.txt"), 1);
    EXPECT_EQ(shell("echo '{\"objekts\": []}' | " + render + "- 2> err.txt"), 3);
    EXPECT_EQ(readText("err.txt"),
              "glint: standard input:1:13: /objekts: unknown key (did you mean \"objects\"?)\n");
    EXPECT_EQ(names(),
              (std::set<std::string>{"a.json", "a.png", "b.png", "err.txt", "out.txt", "stdin.png"}));
}

TEST_F(Process, BashGetsCompletions) {
    writeText("complete.sh",
              "source bash-completion/completions/glint\n"
              "COMP_WORDS=('" GLINT_PROGRAM
              "' render a.json --backend '')\nCOMP_CWORD=4\n_glint\n"
              "echo \"${COMPREPLY[*]}\"\n");
    EXPECT_EQ(shell("'" GLINT_PROGRAM "' pages . > list.txt && bash complete.sh > out.txt 2>&1"), 0);
    EXPECT_EQ(readText("out.txt"), "gpu cpu\n");
}

TEST_F(Process, FilesThatGrowBeyondTheLimitAreNotLeft) {
    // The size that `ulimit -f` takes is in blocks of 512 or 1024 bytes; the image has 3 MB.
    EXPECT_EQ(shell("ulimit -f 8; '" GLINT_PROGRAM
                    "' render a.json --backend cpu --size 500x500 -o a.pfm 2> err.txt"),
              1);
    EXPECT_EQ(readText("err.txt"), "glint: a.pfm: cannot write: File too large\n");
    EXPECT_EQ(names(), (std::set<std::string>{"a.json", "err.txt"}));
}

#ifndef __SANITIZE_ADDRESS__  // whose shadow memory takes terabytes of address space
// They have the pixels of an image that was rendered at once.
TEST_F(Process, PicturesBeyondTheLimitOfAddressSpaceAreDrawnInBands) {
    const std::string render =
        "'" GLINT_PROGRAM "' render a.json --backend cpu --size 2000x1500 --stats json ";
    ASSERT_EQ(shell(render + "-o whole.pfm > whole.txt"), 0);
    // In this much address space the program starts, with some 60 MB to spare, and the picture takes 87 MB.
    int status = -1;
    for (int kilobytes = 100000; status != 0 && kilobytes < 400000; kilobytes += 20000)
        status = shell("ulimit -v " + std::to_string(kilobytes) + "; " + render +
                       "-o bands.pfm > bands.txt 2> err.txt");
    ASSERT_EQ(status, 0) << readText("err.txt");
    EXPECT_HAS(readText("bands.txt"), "\"bands\": ");
    EXPECT_EQ(readBytes("whole.pfm"), readBytes("bands.pfm"));
}
#endif

TEST_F(Process, AnInterruptedPictureInBandsHoldsWhatWasFinished) {
    Child child(kLong + "--progress plain --band-rows 16");
    ASSERT_TRUE(child.waitForPercent(1)) << child.err();
    expectFinishedPart(child, SIGINT, 1000, 4000);
}

// Writing empty rows is fast: the image has 32,768 x 16,384 pixels, and only one band is rendered.
TEST_F(Process, AnInterruptedPictureOfAnySizeEndsSoon) {
    for (const std::string name : {"out.png", "out.pfm"}) {
        Child child({"render", "a.json", "-o", name, "--backend", "cpu", "--size", "32768x16384",
                     "--progress", "plain", "--band-rows", "8"});
        ASSERT_TRUE(child.waitForPercent(0)) << child.err();
        child.send(SIGINT);
        EXPECT_EQ(child.wait(), 130);  // in 6 s on an idle machine; all bands take hours
        EXPECT_HAS(child.err(), "holds the ");
    }
}

TEST_F(Process, InterruptSavesTheFinishedPart) {
    for (const int signal : {SIGINT, SIGTERM}) {
        Child child(kLong + "--progress plain");
        ASSERT_TRUE(child.waitForPercent(0)) << child.err();  // said only once a row is finished
        expectFinishedPart(child, signal, 1000, 4000);
        std::filesystem::remove("out.png");
    }
}

// At any time the file is a whole picture of one writer, also where one dies in the middle, and no other
// is left.
TEST_F(Process, SeveralWritersOfOneFileLeaveAWholeOne) {
    const auto wholeOrNone = [] {
        if (!std::filesystem::exists("out.exr")) return;
        const Image image = readImage("out.exr");
        EXPECT_EQ(image.height, 64);
        EXPECT_TRUE(image.width == 256 || image.width == 512 || image.width == 768) << image.width;
    };
    for (int round = 0; round < 4; ++round) {
        std::vector<std::unique_ptr<Child>> writers;
        for (const char* size : {"256x64", "512x64", "768x64", "768x64"})
            writers.push_back(
                std::make_unique<Child>(Words("render a.json --backend cpu -q -o out.exr --size") + size));
        writers[3]->waitForWork(0.01 * round);
        writers[3]->send(SIGKILL);
        for (int i = 0; i < 3; ++i) {
            wholeOrNone();
            EXPECT_EQ(writers[static_cast<size_t>(i)]->wait(), 0) << writers[static_cast<size_t>(i)]->err();
        }
        writers[3]->wait();
        wholeOrNone();
        EXPECT_EQ(names(), (std::set<std::string>{"a.json", "out.exr"}));
    }
}

TEST_F(Process, InterruptBeforeAnythingIsFinishedWritesNoFile) {
    for (const int signal : {SIGINT, SIGTERM}) {
        Child child(kLongRows);
        ASSERT_TRUE(child.waitForWork(0.5));
        expectNothingWritten(child, signal);
        EXPECT_STARTS(child.err(), "glint: interrupted before");
        EXPECT_EQ(std::count(child.err().begin(), child.err().end(), '\n'), 1) << child.err();
    }
}

TEST_F(Process, InterruptedBenchTellsHowFarItCame) {
    Child child("bench a.json --backend cpu --repeat 1000 --size 1000x1000");
    ASSERT_TRUE(child.waitForWork(0.2));
    child.send(SIGINT);
    EXPECT_EQ(child.wait(), 130);
    EXPECT_EQ(child.err(), "glint: interrupted: 0 of 1 scene measured\n");
    EXPECT_EQ(child.out(), "");
}

// Waiting for rays on standard input is not rendering: there is nothing to save.
TEST_F(Process, InterruptEndsACommandThatHasNothingToSave) {
    Child child("trace a.json --rays - --backend cpu", {}, true);
    ASSERT_TRUE(child.waitForHandler(SIGINT));
    child.type("\x03");  // Ctrl-C
    EXPECT_EQ(child.wait(), 130);
    EXPECT_HAS(child.err(), "glint: interrupted");
}

TEST_F(Process, RaysFromStandardInput) {
    Child child("trace a.json --rays - --backend cpu", {}, true);
    child.type("0,0,5,0,0,-1\n\x04");  // end of the file
    EXPECT_EQ(child.wait(), 0);
    EXPECT_HAS(child.err(), "1,4,0,0,0,0,0,0,1,0,0,1");
}

TEST_F(Process, NoProgressWithoutAnOptionOrATerminal) {
    for (const char* options : {"", "--progress none", "-q --progress plain"}) {
        Child child(kLong + options);
        ASSERT_TRUE(child.waitForWork(0.1));
        usleep(1500000);  // progress starts after a second
        child.send(SIGINT);
        EXPECT_EQ(child.wait(), 130);
        EXPECT_STARTS(child.err(), "glint: interrupted");
    }
}

// A real Ctrl-C: the terminal turns it into SIGINT.
TEST_F(Process, BarOnATerminalIsClearedAtTheEnd) {
    Child child(kLong, {}, true);
    ASSERT_TRUE(child.waitForPercent(0)) << child.err();
    child.type("\x03");
    EXPECT_EQ(child.wait(), 130);
    const std::string& text = child.err();
    const size_t bar = text.find("\rrender  [");
    ASSERT_NE(bar, std::string::npos) << text;
    // The last thing before the program's words are as many spaces as the bar was long, between two returns.
    const size_t words = text.find("wrote out.png");
    ASSERT_NE(words, std::string::npos) << text;
    ASSERT_EQ(text[words - 1], '\r');
    const size_t blank = text.rfind('\r', words - 2);
    EXPECT_GT(words - blank, 40u);
    EXPECT_EQ(text.substr(blank + 1, words - blank - 2), std::string(words - blank - 2, ' '));
    EXPECT_HAS(text, "glint: interrupted: out.png holds the ");
}

TEST_F(Process, FullDiskOnStandardOutputIsAnError) {
    writeText("r.csv", "0,0,5,0,0,-1\n");
    EXPECT_EQ(shell("'" GLINT_PROGRAM "' trace a.json --rays r.csv --backend cpu > /dev/full 2> err.txt"), 1);
    EXPECT_EQ(readText("err.txt"), "glint: cannot write to standard output: No space left on device\n");
}

const Child::Environment kNoDriver = {{"VK_DRIVER_FILES", "/nonexistent"},
                                      {"VK_ICD_FILENAMES", "/nonexistent"}};

constexpr const char* kListOfCpu =
    "cpu\n   double precision on the processor, without Vulkan\n   usable: --backend cpu\n";

void expectNoVulkan(const Child::Environment& environment, const std::string& line) {
    Child cpu("render a.json --backend cpu -o cpu.png", environment);
    EXPECT_EQ(cpu.wait(), 0) << cpu.err();
    EXPECT_EQ(readImage("cpu.png").width, 64);
    for (const Words args :
         {"render a.json -o gpu.png", "verify a.json", "trace a.json --pixel 0,0", "devices"}) {
        Child gpu(args, environment);
        EXPECT_EQ(gpu.wait(), 4) << args[0];
        const std::string instead =
            args[0] == "verify" ? "" : "; or use --backend cpu, which needs no device";
        EXPECT_EQ(gpu.err(), "glint: " + line + instead + "\n") << args[0];
        EXPECT_EQ(gpu.out(), args[0] == "devices" ? kListOfCpu : "") << args[0];
    }
    EXPECT_FALSE(std::filesystem::exists("gpu.png"));
}

TEST_F(Process, WithoutVulkanDriver) {
    expectNoVulkan(kNoDriver,
                   "no Vulkan device found: VK_DRIVER_FILES is \"/nonexistent\"; unset it, or name a "
                   "driver's .json file");
}

// The first libvulkan.so.1 on the search path is no library.
TEST_F(Process, WithoutVulkanLoader) {
    std::filesystem::create_directory("lib");
    writeText("lib/libvulkan.so.1", "");
    writeText("lib/libvulkan.so", "");
    expectNoVulkan({{"LD_LIBRARY_PATH", (folder_ / "lib").string()}},
                   "no Vulkan loader (libvulkan.so.1) found: install libvulkan1 and a driver such as "
                   "mesa-vulkan-drivers");
}

}  // namespace glint::app::test::process_test
