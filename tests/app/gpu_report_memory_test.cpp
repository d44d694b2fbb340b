// What `glint report` takes of memory is known before it begins.
#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "app/common.h"
#include "core/error.h"
#include "report/run.h"
#include "report/sweep.h"
#include "support.h"

namespace glint::app::test::gpu_report_memory_test {
namespace {

// "VmRSS" and the like, in bytes.
uint64_t statusOf(const std::string& key) {
    std::ifstream file("/proc/self/status");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with(key + ":")) return std::stoull(line.substr(key.size() + 1)) * 1024;
    return 0;
}

// Of address space, as long as it lives.
class Limit {
  public:
    explicit Limit(uint64_t bytes) {
        getrlimit(RLIMIT_AS, &before_);
        rlimit limit = before_;
        limit.rlim_cur = bytes;
        setrlimit(RLIMIT_AS, &limit);
    }
    ~Limit() { setrlimit(RLIMIT_AS, &before_); }

  private:
    rlimit before_{};
};

class GpuReportMemory : public FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        writeSmallScene("a.json");
        std::filesystem::create_directory("out");
    }
    LoadedScene loaded() {
        SceneOptions scene;
        scene.scene = "a.json";
        std::ostringstream warnings;
        return loadAndPack(scene, warnings);
    }
    // The settings that hold most at a time: four kinds of renderer, one of which has all features.
    report::Options options(int width) {
        report::Options options;
        options.folder = "out";
        options.width = width;
        options.repeats = 1;
        options.truthSamples = 2;
        options.only = {"default", "nothing", "ray", "storage", "texel"};
        return options;
    }
    report::MemoryNeed need(const report::Options& options) {
        report::SweepLimits limits;
        limits.wanted = [&](const report::Configuration& c) {
            return c.twin == 0 && std::any_of(options.only.begin(), options.only.end(),
                                              [&](const auto& start) { return c.family.starts_with(start); });
        };
        return report::SceneSweep(device_, "a.json", loaded(), options.width, limits).memory(options.width);
    }
    void run(const report::Options& options) {
        std::vector<report::Subject> subjects;
        subjects.push_back({"a.json", "", loaded()});
        report::run(device_, std::move(subjects), std::nullopt, options);
    }
    gpu::Device device_;
};

TEST_F(GpuReportMemory, TooMuchIsRefusedBeforeAnythingIsDrawn) {
    report::Options many = options(4096);
    const auto errorWith = [&](uint64_t bytes) {
        many.memory = [bytes] { return bytes; };
        return errorOf(ErrorKind::Failed, [&] { run(many); });
    };
    const std::string error = errorWith(uint64_t{1} << 30);
    EXPECT_TRUE(error.starts_with("pictures 4096 pixels wide, with all that they are compared with, take "))
        << error;
    const std::string fits = " of memory, 1.0 GiB are free; ask for a smaller --size (";
    ASSERT_NE(error.find(fits), std::string::npos) << error;
    // The width that is named fits, and one more does not.
    const int width = std::stoi(error.substr(error.find(fits) + fits.size()));
    const auto bytesOf = [&](int wide) {
        const report::MemoryNeed need = this->need(options(wide));
        return need.kept + need.passing;
    };
    EXPECT_LE(bytesOf(width), uint64_t{1} << 30);
    EXPECT_GT(bytesOf(width + 1), uint64_t{1} << 30);
    EXPECT_TRUE(errorWith(1).ends_with("are free; ask for fewer settings (--only) or scenes"));
    EXPECT_TRUE(std::filesystem::is_empty("out"));
}

TEST_F(GpuReportMemory, TheLimitOfAddressSpaceCounts) {
    // Room for a driver with a validation layer above it: in 400 MiB SwiftShader died.
    const Limit limit(statusOf("VmSize") + (uint64_t{1} << 30));
    const Ran ran = runGlint({"report", "a.json", "-o", "out", "--size", "4096"});
    EXPECT_EQ(ran.code, 1);
    EXPECT_TRUE(ran.err.starts_with("glint: pictures 4096 pixels wide")) << ran.err;
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
    EXPECT_TRUE(std::filesystem::is_empty("out"));
}

}  // namespace
}  // namespace glint::app::test::gpu_report_memory_test
