// `glint render` on devices that fail (fault_layer.cpp).
#include "app/child.h"
#include "app/support.h"
#include "support/environment.h"

namespace glint::app::test::fault_test {
using glint::test::ScopedEnvironment;

class DeviceFault : public FolderTest {
  protected:
    void SetUp() override {
        writeSmallScene("a.json");
        ASSERT_EQ(render("", "gpu.pfm").code, 0);
    }

    static Ran render(const std::string& fault, const std::string& output, const Words& more = {}) {
        const ScopedEnvironment environment("GLINT_FAULT", fault.empty() ? nullptr : fault.c_str());
        return runGlint({"render", "a.json", "-q", "-o", output}, more);
    }

    // Exit code 4, one line with the reason and the way out, and no image. False if no device failed.
    static bool expectFailure(const std::string& fault, const std::string& reason) {
        std::filesystem::remove("out.pfm");
        const Ran ran = render(fault, "out.pfm");
        if (ran.code == 0) return false;
        EXPECT_EQ(ran.code, 4) << fault;
        EXPECT_HAS(ran.err, reason);
        EXPECT_HAS(ran.err, "use --backend cpu");
        EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
        EXPECT_FALSE(std::filesystem::exists("out.pfm"));
        return true;
    }

    // The first call fails, the second one, and so on, until an image needs no more, but `least` at least.
    static void expectEachFails(const std::string& call, const std::string& reason, int least) {
        int calls = 0;
        while (calls < 200 && expectFailure(call + " " + std::to_string(calls + 1), reason)) ++calls;
        EXPECT_LT(calls, 200) << call;
        EXPECT_GE(calls, least) << call;
        EXPECT_EQ(readBytes("out.pfm"), readBytes("gpu.pfm"));
    }
};

TEST_F(DeviceFault, ALostDeviceEndsTheRender) {
    expectEachFails("vkQueueSubmit", "vkQueueSubmit failed: VK_ERROR_DEVICE_LOST", 2);
}

TEST_F(DeviceFault, AHungDeviceEndsTheRender) {
    expectEachFails("vkWaitForFences", "hangs: a batch of work has not finished after ", 2);
}

TEST_F(DeviceFault, KernelsThatDoNotCompileEndTheRender) {
    expectEachFails("vkCreateComputePipelines", "VK_ERROR_INVALID_SHADER_NV", 1);
}

TEST_F(DeviceFault, DevicesThatDoNotOpenEndTheRender) {
    EXPECT_TRUE(expectFailure("vkCreateDevice 1", "vkCreateDevice failed: VK_ERROR_INITIALIZATION_FAILED"));
    const ScopedEnvironment old("VK_ICD_FILENAMES", "/nonexistent.json"),
        files("VK_DRIVER_FILES", "/nonexistent.json");
    EXPECT_TRUE(expectFailure("", "no Vulkan device"));
}

TEST_F(DeviceFault, EveryAllocationMayFail) {
    for (const std::string call : {"vkAllocateMemory", "vkCreateBuffer"})
        expectEachFails(call, call + " failed: VK_ERROR_OUT_OF_", 5);
}

TEST_F(DeviceFault, ACheckpointKeepsWhatTheDeviceFinished) {
    int failed = 0, kept = 0;
    for (int submission = 1; submission < 2000; submission += 1 + submission / 5, ++failed) {
        const std::string fault = "vkQueueSubmit " + std::to_string(submission);
        const Ran ran = render(fault, "out.pfm", {"--checkpoint", "a.check"});
        if (ran.code == 0) break;
        EXPECT_EQ(ran.code, 4) << ran.err;
        kept += std::filesystem::exists("a.check") ? 1 : 0;
        EXPECT_EQ(render("", "out.pfm", {"--checkpoint", "a.check"}).code, 0);
        EXPECT_EQ(readBytes("out.pfm"), readBytes("gpu.pfm")) << fault;
        std::filesystem::remove("out.pfm");
    }
    EXPECT_GE(failed, 2);
    EXPECT_GE(kept, 1) << "no fault came between two units";
}

}  // namespace glint::app::test::fault_test
