// Devices that fail (fault_layer.cpp), and `glint render --fallback cpu`, which gets over it.
#include <functional>
#include <nlohmann/json.hpp>

#include "app/child.h"
#include "app/support.h"
#include "support/environment.h"

namespace glint::app::test::fallback_test {
using glint::test::ScopedEnvironment;

class Fallback : public FolderTest {
  protected:
    void SetUp() override {
        writeSmallScene("a.json");
        ASSERT_EQ(runGlint({"render", "a.json", "-q", "--backend", "cpu", "-o", "cpu.pfm"}).code, 0);
        ASSERT_EQ(runGlint({"render", "a.json", "-q", "-o", "gpu.pfm"}).code, 0);
        ASSERT_NE(readBytes("cpu.pfm"), readBytes("gpu.pfm")) << "tells nothing about who drew";
    }

    static Ran render(const std::string& fault, const Words& more = {}) {
        const ScopedEnvironment environment("GLINT_FAULT", fault.empty() ? nullptr : fault.c_str());
        return runGlint({"render", "a.json", "-o", "out.pfm"}, more);
    }

    // The reference's image, one warning that says why, and the facts in --stats. False if no device failed.
    static bool expectFallback(const std::string& fault, const std::string& reason) {
        std::filesystem::remove("out.pfm");
        const Ran ran = render(fault, {"--fallback", "cpu", "--stats", "json"});
        EXPECT_EQ(ran.code, 0) << fault << ran.err;
        if (ran.code != 0 || !fellBack(ran)) return false;
        EXPECT_STARTS(ran.err, "glint: warning: ");
        EXPECT_HAS(ran.err, reason);
        EXPECT_ENDS(ran.err, "; rendered by the reference instead (--fallback cpu)\n");
        EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
        EXPECT_EQ(readBytes("out.pfm"), readBytes("cpu.pfm")) << fault;
        const auto json = nlohmann::json::parse(ran.out);
        EXPECT_EQ(json.at("backend"), "cpu");
        EXPECT_HAS(json.at("fallback").at("reason").get<std::string>(), reason);
        EXPECT_EQ(json.at("reproducible"), false);
        return true;
    }

    // Exit code 4, one line, and no picture.
    static void expectFailure(const std::string& fault, const std::string& reason) {
        std::filesystem::remove("out.pfm");
        const Ran ran = render(fault);
        EXPECT_EQ(ran.code, 4) << fault;
        EXPECT_HAS(ran.err, reason);
        EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
        EXPECT_FALSE(std::filesystem::exists("out.pfm"));
    }

    // The first call fails, the second one, and so on, until an image needs no more, but `least` at least.
    static void expectEachReplaced(const std::string& call, const std::string& reason, int least) {
        expectFailure(call + " 1", reason);
        int calls = 0;
        while (calls < 200 && expectFallback(call + " " + std::to_string(calls + 1), reason)) ++calls;
        EXPECT_LT(calls, 200) << call;
        EXPECT_GE(calls, least) << call;
        EXPECT_EQ(readBytes("out.pfm"), readBytes("gpu.pfm"));
    }

    // Runs `work` with the device lost at ever later submissions, until it is lost no more. True if it found
    // for one of them what it looks for.
    static bool anyFault(const std::function<std::pair<Ran, bool>()>& work) {
        bool any = false;
        for (int submission = 1; submission < 2000; submission += 1 + submission / 5) {
            const std::string fault = "vkQueueSubmit " + std::to_string(submission);
            const ScopedEnvironment environment("GLINT_FAULT", fault.c_str());
            const auto [ran, found] = work();
            EXPECT_EQ(ran.code, 0) << ran.err;
            any = any || found;
            if (!fellBack(ran)) return any;
        }
        ADD_FAILURE() << "no end of submissions";
        return any;
    }

    static bool fellBack(const Ran& ran) { return ran.err.find("(--fallback cpu)") != std::string::npos; }
};

TEST_F(Fallback, ALostDeviceIsReplaced) {
    expectEachReplaced("vkQueueSubmit", "vkQueueSubmit failed: VK_ERROR_DEVICE_LOST", 2);
}

TEST_F(Fallback, AHungDeviceIsReplaced) {
    expectEachReplaced("vkWaitForFences", "hangs: a batch of work has not finished after ", 2);
}

TEST_F(Fallback, KernelsThatDoNotCompileAreReplaced) {
    expectEachReplaced("vkCreateComputePipelines", "VK_ERROR_INVALID_SHADER_NV", 1);
}

TEST_F(Fallback, DevicesThatDoNotOpenAreReplaced) {
    expectFailure("vkCreateDevice 1", "vkCreateDevice failed: VK_ERROR_INITIALIZATION_FAILED");
    EXPECT_TRUE(expectFallback("vkCreateDevice 1", "vkCreateDevice failed: VK_ERROR_INITIALIZATION_FAILED"));
    const Ran none = render("", {"--device", "no such device", "--fallback", "cpu"});
    EXPECT_EQ(none.code, 0);
    EXPECT_TRUE(fellBack(none)) << none.err;
    EXPECT_EQ(readBytes("out.pfm"), readBytes("cpu.pfm"));
    const ScopedEnvironment old("VK_ICD_FILENAMES", "/nonexistent.json"),
        files("VK_DRIVER_FILES", "/nonexistent.json");
    expectFailure("", "no Vulkan device");
    EXPECT_TRUE(expectFallback("", "no Vulkan device"));
}

TEST_F(Fallback, EveryAllocationMayFail) {
    for (const std::string call : {"vkAllocateMemory", "vkCreateBuffer"})
        expectEachReplaced(call, call + " failed: VK_ERROR_OUT_OF_", 5);
}

TEST_F(Fallback, APartIsOfOneOfThem) {
    int replaced = 0;
    anyFault([&] {
        const Ran part = runGlint(
            {"render", "a.json", "--part", "1/1", "-o", "a.part", "--fallback", "cpu", "--stats", "json"});
        if (fellBack(part)) {
            ++replaced;
            EXPECT_EQ(nlohmann::json::parse(part.out).at("backend"), "cpu");
            EXPECT_EQ(runGlint({"merge", "a.part", "-q", "-o", "merged.pfm"}).code, 0);
            EXPECT_EQ(readBytes("merged.pfm"), readBytes("cpu.pfm"));
        }
        return std::pair(part, true);
    });
    EXPECT_GE(replaced, 2);
}

// Units that the device finished are kept, and the warning about mixed bits is that of mixed farms.
TEST_F(Fallback, ACheckpointKeepsWhatTheDeviceFinished) {
    EXPECT_TRUE(anyFault([&] {
        const Ran ran =
            runGlint({"render", "a.json", "-o", "out.pfm", "--checkpoint", "a.check", "--fallback", "cpu"});
        EXPECT_FALSE(std::filesystem::exists("a.check"));
        const auto bytes = readBytes("out.pfm");
        if (!fellBack(ran)) {
            EXPECT_EQ(bytes, readBytes("gpu.pfm"));
        }
        // Of the background both know the same bits.
        return std::pair(ran, bytes != readBytes("gpu.pfm") && bytes != readBytes("cpu.pfm"));
    })) << "no fault came between two units";
}

TEST_F(Fallback, FramesAreOfOneOfThem) {
    const std::string scene = glint::test::sourcePath("scenes/turntable.json");
    const auto frames = [&](const std::string& output, const Words& more) {
        return runGlint({"render", scene, "--frames", "0:3", "--size", "24x16", "-o", output, "--overwrite"},
                        more);
    };
    ASSERT_EQ(frames("gpu.#.pfm", {}).code, 0);
    ASSERT_EQ(frames("cpu.#.pfm", {"--backend", "cpu"}).code, 0);
    EXPECT_TRUE(anyFault([&] {
        const Ran ran = frames("out.#.pfm", {"--fallback", "cpu"});
        int byDevice = 0;
        for (const std::string number : {"0", "1", "2", "3"}) {
            const auto bytes = readBytes("out." + number + ".pfm");
            if (bytes == readBytes("gpu." + number + ".pfm"))
                ++byDevice;
            else
                EXPECT_EQ(bytes, readBytes("cpu." + number + ".pfm")) << "frame " << number;
        }
        return std::pair(ran, byDevice > 0 && byDevice < 4);
    })) << "no fault came between two frames";
}

TEST_F(Fallback, AnErrorIsReachedByTheReference) {
    const auto draw = [] {
        return runGlint({"render", "a.json", "-o", "out.pfm", "--error", "0.01", "--fallback", "cpu",
                         "--stats", "json", "--size", "32x24"});
    };
    const int submissions = nlohmann::json::parse(draw().out).at("submissions");
    EXPECT_GT(submissions, 5);
    const std::string last = "vkQueueSubmit " + std::to_string(submissions);
    const ScopedEnvironment environment("GLINT_FAULT", last.c_str());
    const Ran ran = draw();
    ASSERT_EQ(ran.code, 0) << ran.err;
    EXPECT_TRUE(fellBack(ran)) << ran.err;
    EXPECT_EQ(nlohmann::json::parse(ran.out).at("error").at("reached"), true) << ran.out;
}

TEST_F(Fallback, OtherFaultsStayWhatTheyAre) {
    EXPECT_EQ(runGlint({"render", "b.json", "--fallback", "cpu"}).code, 3);
    EXPECT_EQ(render("", {"--fallback", "cpu", "--backend", "cpu"}).err,
              "glint: --fallback: needs --backend gpu\n");
    EXPECT_EQ(render("", {"--fallback", "cpu", "--validation"}).code, 2);
    EXPECT_EQ(render("", {"--fallback", "gpu"}).code, 2);
    const Ran well = render("", {"--fallback", "cpu"});
    EXPECT_EQ(well.code, 0);
    EXPECT_FALSE(fellBack(well)) << well.err;
    EXPECT_EQ(readBytes("out.pfm"), readBytes("gpu.pfm"));
    EXPECT_EQ(render("vkQueueSubmit 2", {"--fallback", "cpu", "-q"}).err, "");
}

}  // namespace glint::app::test::fallback_test
