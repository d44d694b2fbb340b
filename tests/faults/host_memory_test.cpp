// Memory of the processor runs out: an operator new fails, in whichever thread and library. glint says so in
// one line, with exit code 1, and leaves no file and no part of one.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "../app/support.h"
#include "core/image_io.h"

namespace {

// Of the allocations of at least so many bytes: how many still succeed, and how many fail after that.
std::atomic<long> theLeft{-1}, theFaults{0};
std::atomic<size_t> theLeast{0};

bool fails(size_t size) {
    if (theLeft.load() < 0 || size < theLeast.load()) return false;
    if (theLeft.fetch_sub(1) > 0) return false;
    theLeft = 0;
    return theFaults.fetch_sub(1) > 0;
}

void* allocate(size_t size, size_t alignment) {
    if (fails(size)) return nullptr;
    if (alignment <= alignof(std::max_align_t)) return std::malloc(size == 0 ? 1 : size);
    return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

void* allocateOrThrow(size_t size, size_t alignment) {
    void* memory = allocate(size, alignment);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

}  // namespace

// The libraries take these too. The forms that return null are made of them by the standard library.
#pragma GCC visibility push(default)
void* operator new(size_t size) {
    return allocateOrThrow(size, 1);
}
void* operator new[](size_t size) {
    return allocateOrThrow(size, 1);
}
void* operator new(size_t size, std::align_val_t alignment) {
    return allocateOrThrow(size, static_cast<size_t>(alignment));
}
void* operator new[](size_t size, std::align_val_t alignment) {
    return allocateOrThrow(size, static_cast<size_t>(alignment));
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete[](void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, size_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, size_t, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, size_t, std::align_val_t) noexcept {
    std::free(memory);
}
#pragma GCC visibility pop

namespace glint::app::test::host_memory_test {
namespace {

using glint::test::readText;

constexpr int kFinished = 255;  // the exit code of a child in which nothing failed any more

class HostMemory : public FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        writeSmallScene("a.json");
        writeText(
            "m.obj",
            "mtllib m.mtl\nv -1 -1 0\nv 1 -1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n");
        writeText("m.mtl", "newmtl a\nKd 1 1 1\nmap_Kd t.png\n");
        writeImage("t.png", Image(4, 4, 3));
        writeText("rays.csv", "0,0,5,0,0,-1\n");
    }

    // A line for each way in which `arguments` answered badly, or "". Its n-th allocation of at least `least`
    // bytes fails, and the `more` after it, for n = 1, 2 ... 60, and then in steps of a thirtieth, until none
    // does.
    std::string failings(const std::vector<std::string>& arguments, const std::string& output, size_t least,
                         long more) {
        std::string bad;
        int refused = 0;
        for (long n = 0; n < 1000000; n += 1 + (n < 60 ? 0 : n / 30)) {
            if (!output.empty()) writeText(output, "old");
            const auto before = names();
            const pid_t child = fork();
            if (child == 0) _exit(answer(arguments, n, least, more));
            int status = 0;
            waitpid(child, &status, 0);
            if (WIFEXITED(status) && WEXITSTATUS(status) == kFinished) {
                EXPECT_TRUE(output.empty() || readText(output) != "old");
                RecordProperty("allocations", static_cast<int>(n));
                RecordProperty("refused", refused);
                EXPECT_GT(refused, 10) << "too few allocations have failed";
                return bad;
            }
            const std::string which = "allocation " + std::to_string(n + 1) + ": ";
            const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
            refused += code == 1 ? 1 : 0;
            // What can do without, does.
            if (code != 1 && code != 0) bad += which + "exit code " + std::to_string(code) + "\n";
            if (code != 0 && !output.empty() && readText(output) != "old")
                bad += which + "the old file is gone\n";
            if (names() != before) bad += which + "a file is left\n";
        }
        return bad + "there is no end of allocations";
    }

    // In a child process.
    static int answer(const std::vector<std::string>& arguments, long n, size_t least, long more) {
        theLeast = least;
        theFaults = 1 + more;
        theLeft = n;
        const Ran ran = runGlint(arguments);
        const bool failed = theFaults <= more;
        theLeft = -1;
        if (!failed) return kFinished;
        const bool oneLine = ran.err.starts_with("glint: ") && ran.err.find('\n') + 1 == ran.err.size();
        if (ran.code != 0 && !oneLine) return 99;
        return ran.code;
    }
};

TEST_F(HostMemory, EveryAllocationOfAPictureMayFail) {
    EXPECT_EQ(failings({"render", "a.json", "--backend", "cpu", "-q", "-o", "out.png"}, "out.png", 0, 0), "");
}

TEST_F(HostMemory, SoMayThoseOfAModelInBands) {
    EXPECT_EQ(failings({"render", "m.obj", "--backend", "cpu", "-q", "--size", "32x24", "--band-rows", "8",
                        "--aov", "color,depth", "-o", "out.exr"},
                       "out.exr", 0, 0),
              "");
}

TEST_F(HostMemory, SoMayThoseOfRaysAndFacts) {
    EXPECT_EQ(failings({"trace", "m.obj", "--backend", "cpu", "--rays", "rays.csv"}, "", 0, 0), "");
    EXPECT_EQ(failings({"info", "m.obj"}, "", 0, 0), "");
}

// As where memory is short: what is small is still there, what is large is not, and never will be.
TEST_F(HostMemory, LargePiecesMayBeRefusedForGood) {
    EXPECT_EQ(failings({"render", "a.json", "--backend", "cpu", "-q", "--size", "200x100", "-o", "out.png"},
                       "out.png", 1024, 1 << 20),
              "");
}

}  // namespace
}  // namespace glint::app::test::host_memory_test
