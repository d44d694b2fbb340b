// `glint render --checkpoint`: processes that are killed and interrupted.
#include <chrono>
#include <csignal>
#include <thread>

#include "child.h"
#include "core/stopwatch.h"
#include "support.h"

namespace glint::app::test::checkpoint_test {
using namespace std::chrono_literals;
class Checkpoints : public FolderTest {
  protected:
    void SetUp() override {
        writeSmallScene("a.json");
        ASSERT_EQ(runGlint(with("-o whole.pfm -q")).code, 0);
        whole_ = readBytes("whole.pfm");
    }
    // A second or so of work in 16 units.
    static Words with(Words more) {
        Words args = "render a.json --backend cpu --size 256x192 --spp 24";
        args += more;
        return args;
    }
    std::vector<uint8_t> whole_;
};

// Killed at any moment and started again until it is done.
TEST_F(Checkpoints, AKilledProcessIsResumed) {
    const Words args = with("--checkpoint c.part -o all.pfm -q");
    int kills = 0;
    for (; kills < 50; ++kills) {
        Child child(args);
        const Stopwatch watch;
        const auto before = std::filesystem::exists("c.part") ? std::filesystem::file_size("c.part") : 0;
        std::error_code code;
        while (watch.seconds() < 60 && !std::filesystem::exists("all.pfm")) {
            const auto size = std::filesystem::file_size("c.part", code);
            if (!code && size > before + (before > 0 ? 100'000 : 0)) break;
            std::this_thread::sleep_for(1ms);
        }
        if (std::filesystem::exists("all.pfm")) {
            EXPECT_EQ(child.wait(), 0);
            break;
        }
        child.send(SIGKILL);
        child.wait();
    }
    EXPECT_GE(kills, 1);
    EXPECT_EQ(readBytes("all.pfm"), whole_);
    EXPECT_FALSE(std::filesystem::exists("c.part"));
}

TEST_F(Checkpoints, AnInterruptedProcessReportsItsUnits) {
    std::string said;
    int code = 0;
    // On a busy machine the child may be done before this process gets its turn to interrupt it.
    for (int trial = 0; trial < 20 && code == 0; ++trial) {
        Child child(with("--checkpoint c.part -o all.pfm -q"));
        const Stopwatch watch;
        const auto held = [] {
            std::error_code missing;
            const auto size = std::filesystem::file_size("c.part", missing);
            return missing ? 0 : size;
        };
        while (watch.seconds() < 10 && held() < 50'000) std::this_thread::sleep_for(1ms);
        child.send(SIGINT);
        code = child.wait();
        said = child.err();
    }
    EXPECT_EQ(code, 130);
    EXPECT_STARTS(said, "glint: interrupted: c.part holds ");
    const Ran other = runGlint(with("--checkpoint c.part -o all.pfm --max-depth 1"));
    EXPECT_EQ(other.code, 1);
    EXPECT_EQ(other.err,
              "glint: c.part: is a checkpoint of another render: maxDepth is 5 there and 1 here; remove it, "
              "or give another name\n");
    EXPECT_EQ(runGlint(with("--checkpoint c.part -o all.pfm -q")).code, 0);
    EXPECT_EQ(readBytes("all.pfm"), whole_);
    expectError(with("--checkpoint ./all.pfm -o all.pfm"), 2,
                "all.pfm: is the checkpoint, too; name another file with --output");
}

}  // namespace glint::app::test::checkpoint_test
