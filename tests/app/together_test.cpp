// `glint render --checkpoint` and `--join`: processes that are killed, stopped and come late.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>
#include <random>
#include <thread>

#include "child.h"
#include "core/stopwatch.h"
#include "support.h"

namespace glint::app::test::together_test {
namespace {

using namespace std::chrono_literals;
using glint::test::readText;

class Together : public FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        writeSmallScene("a.json");
        ASSERT_EQ(runGlint(with({"-o", "whole.pfm", "-q"})).code, 0);
        whole_ = readBytes("whole.pfm");
    }
    // A second or so of work in 16 units.
    static std::vector<std::string> with(std::vector<std::string> more) {
        std::vector<std::string> args = {"render", "a.json",  "--backend", "cpu",
                                         "--size", "256x192", "--spp",     "24"};
        args.insert(args.end(), more.begin(), more.end());
        return args;
    }
    static std::vector<std::string> joined() {
        return with({"--join", "farm", "--lease", "1", "-o", "all.pfm", "-q"});
    }
    static std::ptrdiff_t results() {
        std::error_code code;
        std::ptrdiff_t found = 0;
        for (std::filesystem::directory_iterator at("farm", code), end; !code && at != end;
             at.increment(code))
            found += at->path().extension() == ".part" ? 1 : 0;
        return found;
    }
    static void waitForResults(std::ptrdiff_t count) {
        const Stopwatch watch;
        while (results() < count && watch.seconds() < 60) std::this_thread::sleep_for(2ms);
    }

    std::vector<uint8_t> whole_;
};

TEST_F(Together, OneProcessAlone) {
    const Ran ran = runGlint(joined());
    EXPECT_EQ(ran.code, 0);
    EXPECT_EQ(ran.err, "");
    EXPECT_GE(results(), 5);
    EXPECT_EQ(readBytes("all.pfm"), whole_);
    // The same once more: nothing is left to do, or only to write.
    EXPECT_EQ(runGlint(joined()).code, 0);
    std::filesystem::remove("all.pfm");
    EXPECT_EQ(runGlint(joined()).code, 0);
    EXPECT_EQ(readBytes("all.pfm"), whole_);
}

TEST_F(Together, SeveralProcesses) {
    std::vector<std::unique_ptr<Child>> children;
    for (int i = 0; i < 4; ++i) children.push_back(std::make_unique<Child>(joined()));
    for (auto& child : children) EXPECT_EQ(child->wait(), 0) << child->err();
    EXPECT_EQ(readBytes("all.pfm"), whole_);
}

// One of three is killed at any moment; the others finish, and so would one that comes later.
TEST_F(Together, TheDeadLoseNothing) {
    std::mt19937 random(std::random_device{}());
    for (int trial = 0; trial < 3; ++trial) {
        std::filesystem::remove_all("farm");
        std::filesystem::remove("all.pfm");
        Child first(joined()), second(joined()), victim(joined());
        waitForResults(1);
        std::this_thread::sleep_for(std::chrono::milliseconds(random() % 300));
        victim.send(SIGKILL);
        EXPECT_EQ(first.wait(), 0) << first.err();
        EXPECT_EQ(second.wait(), 0) << second.err();
        EXPECT_EQ(readBytes("all.pfm"), whole_);
    }
}

TEST_F(Together, AllMayDie) {
    {
        Child first(joined()), second(joined());
        waitForResults(2);
        first.send(SIGKILL);
        second.send(SIGKILL);
    }
    const auto before = results();
    EXPECT_EQ(runGlint(joined()).code, 0);
    EXPECT_GE(before, 2);
    EXPECT_EQ(readBytes("all.pfm"), whole_);
}

// A process that stands still is not waited for longer than its lease. It goes on later, and does no harm.
TEST_F(Together, StragglersAreNotWaitedFor) {
    Child straggler(joined());
    waitForResults(1);
    straggler.send(SIGSTOP);
    Child other(joined());
    EXPECT_EQ(other.wait(), 0) << other.err();
    EXPECT_EQ(readBytes("all.pfm"), whole_);
    straggler.send(SIGCONT);
    EXPECT_EQ(straggler.wait(), 0) << straggler.err();
    EXPECT_EQ(readBytes("all.pfm"), whole_);
}

TEST_F(Together, AnotherPictureIsRefused) {
    ASSERT_EQ(runGlint(joined()).code, 0);
    std::vector<std::string> other = joined();
    other.insert(other.end(), {"--max-depth", "2"});
    const Ran ran = runGlint(other);
    EXPECT_EQ(ran.code, 1);
    EXPECT_EQ(ran.err, "glint: farm: is the folder of another picture: maxDepth is 5 there and 2 here\n");
    glint::test::writeText("file", "");
    const Ran file = runGlint(with({"--join", "file"}));
    EXPECT_EQ(file.code, 1);
    EXPECT_TRUE(file.err.starts_with("glint: file: cannot be used: ")) << file.err;
    EXPECT_EQ(runGlint(with({"--join", "farm", "--checkpoint", "c"})).err,
              "glint: --checkpoint: not together with --join\n");
}

// Killed at any moment and started again until it is done.
TEST_F(Together, CheckpointsGoOn) {
    const std::vector<std::string> args = with({"--checkpoint", "c.part", "-o", "all.pfm", "-q"});
    int kills = 0;
    for (; kills < 50; ++kills) {
        Child child(args);
        const Stopwatch watch;
        const auto before = std::filesystem::exists("c.part") ? std::filesystem::file_size("c.part") : 0;
        std::error_code code;
        while (watch.seconds() < 60 && !std::filesystem::exists("all.pfm")) {
            const auto size = std::filesystem::file_size("c.part", code);
            if (!code && before > 0 && size > before + 100'000) break;
            if (!code && before == 0) break;
            std::this_thread::sleep_for(1ms);
        }
        if (std::filesystem::exists("all.pfm")) {
            EXPECT_EQ(child.wait(), 0);
            break;
        }
        child.send(SIGKILL);
        child.wait();
    }
    EXPECT_GE(kills, 2);
    EXPECT_EQ(readBytes("all.pfm"), whole_);
    EXPECT_FALSE(std::filesystem::exists("c.part"));
}

TEST_F(Together, InterruptedCheckpointsSayHowMuchTheyHold) {
    std::string said;
    int code = 0;
    // On a busy machine the child may be done before this process gets its turn to interrupt it.
    for (int trial = 0; trial < 20 && code == 0; ++trial) {
        Child child(with({"--checkpoint", "c.part", "-o", "all.pfm", "-q"}));
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
    EXPECT_TRUE(said.starts_with("glint: interrupted: c.part holds ")) << said;
    const Ran other = runGlint(with({"--checkpoint", "c.part", "-o", "all.pfm", "--max-depth", "1"}));
    EXPECT_EQ(other.code, 1);
    EXPECT_EQ(other.err,
              "glint: c.part: is a checkpoint of another picture: maxDepth is 5 there and 1 here; remove it, "
              "or give "
              "another name\n");
    EXPECT_EQ(runGlint(with({"--checkpoint", "c.part", "-o", "all.pfm", "-q"})).code, 0);
    EXPECT_EQ(readBytes("all.pfm"), whole_);
}

}  // namespace
}  // namespace glint::app::test::together_test
