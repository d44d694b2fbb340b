// Interrupts of the program itself, on a device.
#include <csignal>

#include "child.h"
#include "support.h"

namespace glint::app::test::gpu_process_test {
using GpuProcess = ChildTest;

TEST_F(GpuProcess, InterruptSavesTheFinishedPart) {
    for (const int signal : {SIGINT, SIGTERM}) {
        Child child("render a.json --size 2000x2000 --spp 32 -o out.png --progress plain");
        // The first slice has 64 tiles of 64 of the four million pixels, less than 1 %.
        ASSERT_TRUE(child.waitForPercent(1)) << child.err();
        expectFinishedPart(child, signal, 2000, 2000);
        std::filesystem::remove("out.png");
    }
}

TEST_F(GpuProcess, InterruptBeforeAnythingIsFinishedWritesNoFile) {
    for (const int signal : {SIGINT, SIGTERM}) {
        Child child("render a.json --size 3000x3000 --spp 65536 -o out.png --progress plain");
        ASSERT_TRUE(child.waitForPercent(0)) << child.err();
        expectNothingWritten(child, signal);
    }
}

// The files list the scene that was finished with its verdict, the others as skipped.
TEST_F(GpuProcess, InterruptEndsVerify) {
    writeText("b.json",
              "{\"image\": {\"width\": 2000, \"height\": 2000}, \"ambient\": 1, "
              "\"objects\": [{\"type\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 1}]}");
    Child child("verify a.json b.json a.json --spp 4 --progress plain --json r.json --junit r.xml");
    ASSERT_TRUE(child.waitForPercent(0, "verify b.json")) << child.err();
    child.send(SIGINT);
    EXPECT_EQ(child.wait(), 130);
    EXPECT_ENDS(child.err(), "glint: interrupted while verifying b.json\n");
    EXPECT_EQ(names(), (std::set<std::string>{"a.json", "b.json", "r.json", "r.xml"}));
    const std::string xml = glint::test::readText("r.xml");
    EXPECT_HAS(xml, "tests=\"3\" failures=\"0\" errors=\"0\" skipped=\"2\"");
    EXPECT_HAS(xml, "<skipped message=\"interrupted while verifying b.json\">");
    EXPECT_HAS(glint::test::readText("r.json"), "\"passed\": 1");
}

TEST_F(GpuProcess, InterruptedReportIsAReport) {
    // On a busy machine the default budget of 60 s may end before the test reads the first progress.
    Child child(
        "report a.json -o out --size 1500 --truth-spp 2 --only grid --progress plain --budget 100000");
    ASSERT_TRUE(child.waitForPercent(0)) << child.err();
    child.send(SIGINT);
    EXPECT_EQ(child.wait(), 130);
    EXPECT_ENDS(
        child.err(),
        "glint: interrupted: out/report.json holds the results so far; repeat the command to resume\n");
    EXPECT_HAS(glint::test::readText("out/report.json"), "\"complete\": false");
    EXPECT_TRUE(std::filesystem::exists("out/report.html"));
}

// A picture that nobody validated is not written as if it had been.
TEST_F(GpuProcess, ValidationWithoutItsLayerDrawsNothing) {
    for (const std::string command : {"render", "bench", "verify"}) {
        Words args = {command, "a.json", "--validation"};
        if (command == "render") args += "-o out.png";
        Child child(args, {{"VK_LAYER_PATH", "/nonexistent"}});
        EXPECT_EQ(child.wait(), 4) << command;
        EXPECT_EQ(child.err(),
                  "glint: the validation layer VK_LAYER_KHRONOS_validation is not installed (Debian package "
                  "vulkan-validationlayers)\n");
        EXPECT_EQ(child.out(), "") << command;
        EXPECT_EQ(names(), std::set<std::string>{"a.json"});
    }
}

}  // namespace glint::app::test::gpu_process_test
