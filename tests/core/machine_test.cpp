// Threads and memory of this machine, and the context of calls.
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>
#include <algorithm>
#include <atomic>
#include <csignal>
#include <limits>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/available_memory.h"
#include "core/context.h"
#include "core/interrupt.h"
#include "core/parallel.h"
#include "support/support.h"

namespace glint::machine_test {

TEST(ParallelFor, EveryIndexOnce) {
    for (unsigned threads : {0u, 1u, 2u, 7u}) {
        std::vector<std::atomic<int>> visits(10'000);
        parallelFor({.threads = threads}, visits.size(), [&](size_t i) { ++visits[i]; });
        for (size_t i = 0; i < visits.size(); ++i)
            ASSERT_EQ(visits[i], 1) << i << " with " << threads << " threads";
    }
}

TEST(ParallelFor, NothingToDo) {
    parallelFor({}, 0, [](size_t) { FAIL() << "called for no item"; });
}

TEST(ParallelFor, OneThreadGoesInOrder) {
    std::vector<size_t> order;
    parallelFor({.threads = 1}, 100, [&](size_t i) { order.push_back(i); });
    for (size_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], i);
    EXPECT_EQ(order.size(), 100u);
}

TEST(ParallelFor, UsesAsManyThreadsAsAsked) {
    // Each of the four waits for the other three: with fewer threads this would not end.
    std::atomic<int> arrived{0};
    parallelFor({.threads = 4}, 4, [&](size_t) {
        ++arrived;
        while (arrived < 4) std::this_thread::yield();
    });
    EXPECT_EQ(arrived, 4);
}

TEST(ParallelFor, ExceptionsReachTheCallerAndStopTheRest) {
    for (unsigned threads : {1u, 4u}) {
        std::atomic<size_t> calls{0};
        const size_t count = 1'000'000;
        try {
            parallelFor({.threads = threads}, count, [&](size_t i) {
                ++calls;
                if (i == 10) {
                    throw std::runtime_error("item 10");
                }
            });
            FAIL() << "the exception was lost";
        } catch (const std::runtime_error& error) {
            EXPECT_STREQ(error.what(), "item 10");
        }
        EXPECT_GE(calls, 11u);
        if (threads == 1) {
            EXPECT_EQ(calls, 11u);
        }
    }
}

TEST(ParallelFor, OneOfManyExceptionsIsReported) {
    const Context four{.threads = 4};
    EXPECT_THROW(parallelFor(four, 1000, [](size_t) { throw std::runtime_error("each"); }),
                 std::runtime_error);
}

TEST(ParallelFor, MayBeNested) {
    std::atomic<int> calls{0};
    const Context two{.threads = 2};
    parallelFor(two, 8, [&](size_t) { parallelFor(two, 8, [&](size_t) { ++calls; }); });
    EXPECT_EQ(calls, 64);
}

TEST(ParallelFor, StopsWhenItIsCancelled) {
    for (const unsigned threads : {1u, 4u}) {
        std::atomic<int> calls{0};
        Context context{.threads = threads};
        context.cancelled = [&] { return calls >= 10; };
        EXPECT_THROW(parallelFor(context, 1'000'000, [&](size_t) { ++calls; }), Cancelled);
        EXPECT_LT(calls, 10 + static_cast<int>(threads));
    }
}

TEST(DefaultThreadCount, FollowsTheAffinityMask) {
    cpu_set_t all;
    ASSERT_EQ(sched_getaffinity(0, sizeof(all), &all), 0);
    EXPECT_EQ(defaultThreadCount(), static_cast<unsigned>(CPU_COUNT(&all)));
    int first = 0;
    while (!CPU_ISSET(first, &all)) ++first;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(first, &one);
    ASSERT_EQ(sched_setaffinity(0, sizeof(one), &one), 0);
    EXPECT_EQ(defaultThreadCount(), 1u);
    sched_setaffinity(0, sizeof(all), &all);
}

// Memory that the system, control groups and limits of the process leave free.

constexpr uint64_t kMebibyte = uint64_t{1} << 20;

// A machine of folders and files.
class AvailableMemory : public test::FolderTest {
  protected:
    void write(const std::string& name, const std::string& text) {
        std::filesystem::create_directories(file(name).parent_path());
        test::writeText(file(name), text);
    }
    static std::string mebibytes(uint64_t count) { return std::to_string(count * kMebibyte) + "\n"; }
    void SetUp() override {
        write("proc/meminfo", "MemTotal:       9000000 kB\nMemFree: 1 kB\nMemAvailable:    4096000 kB\n");
    }
};

TEST_F(AvailableMemory, IsWhatTheSystemSays) {
    EXPECT_EQ(availableMemory(folder_), 4000 * kMebibyte);
    EXPECT_EQ(availableMemory(folder_ / "nowhere"), std::numeric_limits<uint64_t>::max());
}

// The group's own limit is above that of the group around it; pages of files can be had back.
TEST_F(AvailableMemory, IsLessInControlGroups) {
    write("proc/self/cgroup", "0::/box/inner\n");
    write("sys/fs/cgroup/box/inner/memory.max", "max\n");
    write("sys/fs/cgroup/box/inner/memory.current", mebibytes(100));
    EXPECT_EQ(availableMemory(folder_), 4000 * kMebibyte);
    write("sys/fs/cgroup/box/memory.max", mebibytes(500));
    write("sys/fs/cgroup/box/memory.current", mebibytes(200));
    EXPECT_EQ(availableMemory(folder_), 300 * kMebibyte);
    write("sys/fs/cgroup/box/memory.stat", "anon 5\ninactive_file " + mebibytes(50));
    EXPECT_EQ(availableMemory(folder_), 350 * kMebibyte);
    write("sys/fs/cgroup/box/memory.current", mebibytes(600));
    EXPECT_EQ(availableMemory(folder_), 0u);
}

TEST_F(AvailableMemory, IsLessInControlGroupsOfVersion1) {
    write("proc/self/cgroup", "5:devices:/\n4:cpu,memory:/box\n0::/\n");
    write("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
    EXPECT_EQ(availableMemory(folder_), 4000 * kMebibyte);
    write("sys/fs/cgroup/memory/box/memory.limit_in_bytes", mebibytes(300));
    write("sys/fs/cgroup/memory/box/memory.usage_in_bytes", mebibytes(100));
    EXPECT_EQ(availableMemory(folder_), 200 * kMebibyte);
}

TEST_F(AvailableMemory, IsLessWithLittleAddressSpace) {
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_AS, &before), 0);
    write("proc/self/statm", "10000 1 1\n");  // pages
    const auto page = static_cast<uint64_t>(::getpagesize());
    rlimit limit = before;
    limit.rlim_cur = std::min<rlim_t>(before.rlim_max, rlim_t{1} << 50);
    ASSERT_EQ(::setrlimit(RLIMIT_AS, &limit), 0);
    write("proc/meminfo", "MemAvailable: 9000000000000000 kB\n");
    const uint64_t available = availableMemory(folder_);
    ASSERT_EQ(::setrlimit(RLIMIT_AS, &before), 0);
    EXPECT_EQ(available, limit.rlim_cur - 10000 * page);
}

TEST(Context, GrantsAllByDefault) {
    const Context context;
    EXPECT_FALSE(context.isCancelled());
    context.checkCancelled();
    context.report(0.5);
    EXPECT_FALSE(context.charge(1000));
    EXPECT_FALSE(context.part(0, 0.5).progress);
}

TEST(Context, PartsReportTheirPartOfTheWhole) {
    std::vector<double> told;
    const Context context{.progress = [&](double fraction) { told.push_back(fraction); }};
    const Context half = context.part(0.5, 1);
    half.report(0.5);
    half.step(1, 2).report(1);
    EXPECT_EQ(told, (std::vector<double>{0.5, 0.75, 0.75, 1}));
}

TEST(Context, PacedLoopsEndWhenTheyAreCancelled) {
    std::vector<double> told;
    const Context context{.cancelled = [&] { return told.size() == 3; },
                          .progress = [&](double fraction) { told.push_back(fraction); }};
    constexpr uint64_t kCount = 1u << 18;
    uint64_t step = 0;
    EXPECT_THROW(for (; step < kCount; ++step) context.pace(step, kCount), Cancelled);
    EXPECT_EQ(told, (std::vector<double>{0, 0.0625, 0.125}));
    EXPECT_EQ(step, 3u << 14);
}

TEST(Context, AnAccountCountsChargesUntilTheirEnd) {
    struct Account : MemoryAccount {
        void take(uint64_t bytes) override { held += bytes; }
        void give(uint64_t bytes) noexcept override { held -= bytes; }
        uint64_t held = 0;
    };
    const auto account = std::make_shared<Account>();
    const Context context{.account = account};
    {
        const MemoryCharge one = context.charge(100);
        MemoryCharge two = context.part(0, 1).charge(20);
        EXPECT_EQ(account->held, 120u);
        two = {};
        EXPECT_EQ(account->held, 100u);
    }
    EXPECT_EQ(account->held, 0u);
}

class Interrupt : public ::testing::Test {
  protected:
    void SetUp() override {
        clearInterrupt();
        installInterruptHandler();
    }
    void TearDown() override {
        std::signal(SIGINT, SIG_DFL);
        std::signal(SIGTERM, SIG_DFL);
        clearInterrupt();
    }
};

using InterruptDeathTest = Interrupt;

TEST_F(Interrupt, SignalsSetTheFlag) {
    for (int signal : {SIGINT, SIGTERM}) {
        EXPECT_FALSE(interrupted());
        std::raise(signal);
        EXPECT_TRUE(interrupted());
        clearInterrupt();
    }
    EXPECT_FALSE(interrupted());
}

TEST_F(Interrupt, RepeatedSigtermOnlyKeepsTheFlag) {
    std::raise(SIGTERM);
    std::raise(SIGTERM);
    EXPECT_TRUE(interrupted());
}

TEST_F(InterruptDeathTest, SigintAfterAnySignalEndsTheProcess) {
    for (const int first : {SIGINT, SIGTERM}) {
        EXPECT_EXIT(
            {
                std::raise(first);
                std::raise(SIGINT);
                _exit(0);
            },
            ::testing::ExitedWithCode(130), "")
            << first;
    }
}

TEST_F(Interrupt, IgnoredSignalsStayIgnored) {
    std::signal(SIGINT, SIG_IGN);
    installInterruptHandler();
    std::raise(SIGINT);
    EXPECT_FALSE(interrupted());
}

}  // namespace glint::machine_test
