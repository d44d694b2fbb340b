// Memory of the processor runs out: an operator new fails, in whichever thread and library. glint says so in
// one line, with exit code 1, and leaves no file and no part of one.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>

#include "../app/support.h"
#include "app/cli.h"
#include "core/image_io.h"
#include "failing_new.h"

namespace glint::app::test::host_memory_test {
using glint::test::readText;

constexpr int kFinished = 255;  // the exit code of a child in which nothing failed any more

class HostMemory : public FolderTest {
  protected:
    void SetUp() override {
        writeSmallScene("a.json");
        writeText(
            "m.obj",
            "mtllib m.mtl\nv -1 -1 0\nv 1 -1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n");
        writeText("m.mtl", "newmtl a\nKd 1 1 1\nmap_Kd t.png\n");
        writeImage("t.png", Image(4, 4, 3));
        writeText("rays.csv", "0,0,5,0,0,-1\n");
    }

    // A line for each way in which `arguments` answered badly, or "". Its n-th allocation of at least `least`
    // bytes fails, and the `more` after it, for n = 1, 2 ... 60, then in steps of a thirtieth until none
    // does, then each of the last `tail` at least: those of files that are finished.
    std::string failings(const std::vector<std::string>& arguments, const std::string& output, size_t least,
                         long more, long tail = 0) {
        const auto before = names();
        EXPECT_EQ(codeOf(arguments, -1, least, more), kFinished);
        const std::string whole = output.empty() ? "" : readText(output);
        std::string bad;
        int refused = 0;
        long last = 0;  // that failed
        bool each = false;
        for (long n = 0; n < 1000000; n += 1 + (each || n < 60 ? 0 : n / 30)) {
            if (!output.empty()) writeText(output, "old");
            const int code = codeOf(arguments, n, least, more);
            const std::string found = output.empty() ? "" : readText(output);
            if (code == kFinished) {
                EXPECT_EQ(found, whole);
                EXPECT_GT(refused, 10) << "too few allocations have failed";
                if (each || tail == 0) return bad;
                each = true;
                n = std::max(last - tail, -1L);
                continue;
            }
            last = n;
            refused += code == 1 ? 1 : 0;
            const std::string which = "allocation " + std::to_string(n + 1) + ": ";
            // What can do without, does. What fails after the picture is written leaves the picture.
            if (code != 1 && code != 0) bad += which + "exit code " + std::to_string(code) + "\n";
            if (found != whole && (code == 0 || found != "old")) bad += which + "what file is this?\n";
            if (!output.empty()) std::filesystem::remove(output);
            if (names() != before) bad += which + "a file is left\n";
        }
        return bad + "there is no end of allocations";
    }

    static int codeOf(const std::vector<std::string>& arguments, long n, size_t least, long more) {
        const pid_t child = fork();
        if (child == 0) {
            alarm(30);  // whoever waits for ever ends with 142
            _exit(answer(arguments, n, least, more));
        }
        int status = 0;
        waitpid(child, &status, 0);
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }

    // In a child process.
    static int answer(const std::vector<std::string>& arguments, long n, size_t least, long more) {
        std::ostringstream out, err;
        glint::test::failAllocations(least, n, 1 + more);
        const int code = run(arguments, out, err);
        const bool failed = glint::test::stopFailing() <= more;
        if (!failed) return kFinished;
        const std::string said = err.str();
        const bool oneLine = said.starts_with("glint: ") && said.find('\n') + 1 == said.size();
        if (code != 0 && !oneLine) return 99;
        return code;
    }
};

TEST_F(HostMemory, EveryAllocationOfAPictureMayFail) {
    EXPECT_EQ(failings({"render", "a.json", "--backend", "cpu", "-q", "-o", "out.png"}, "out.png", 0, 0, 100),
              "");
}

// OpenEXR's pool of threads is made but once in a process: in the child, which is why the parent writes none.
TEST_F(HostMemory, SoMayThoseOfAnExr) {
    EXPECT_EQ(failings({"render", "a.json", "--backend", "cpu", "-q", "-o", "out.exr"}, "out.exr", 0, 0, 100),
              "");
}

TEST_F(HostMemory, SoMayThoseOfAnExrThatIsRead) {
    ASSERT_EQ(codeOf({"render", "a.json", "--backend", "cpu", "-q", "-o", "a.exr"}, -1, 0, 0), kFinished);
    EXPECT_EQ(failings({"diff", "a.exr", "a.exr"}, "", 0, 0, 500), "");
}

TEST_F(HostMemory, SoMayThoseOfAModelInBands) {
    EXPECT_EQ(failings({"render", "m.obj", "--backend", "cpu", "-q", "--size", "32x24", "--band-rows", "8",
                        "-o", "out.pfm"},
                       "out.pfm", 0, 0),
              "");
}

TEST_F(HostMemory, SoMayThoseOfRays) {
    EXPECT_EQ(failings({"trace", "m.obj", "--backend", "cpu", "--rays", "rays.csv"}, "", 0, 0), "");
}

// As where memory is short: what is small is still there, what is large is not, and never will be.
TEST_F(HostMemory, LargePiecesMayBeRefusedForGood) {
    EXPECT_EQ(failings({"render", "a.json", "--backend", "cpu", "-q", "--size", "200x100", "-o", "out.png"},
                       "out.png", 1024, 1 << 20),
              "");
}

}  // namespace glint::app::test::host_memory_test
