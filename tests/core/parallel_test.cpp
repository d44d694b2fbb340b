#include "core/parallel.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "core/call_terms.h"

namespace glint::parallel_test {
namespace {

TEST(ParallelFor, EveryIndexOnce) {
    for (unsigned threads : {0u, 1u, 2u, 7u}) {
        std::vector<std::atomic<int>> visits(10'000);
        parallelFor(
            visits.size(), [&](size_t i) { ++visits[i]; }, threads);
        for (size_t i = 0; i < visits.size(); ++i) {
            ASSERT_EQ(visits[i], 1) << i << " with " << threads << " threads";
        }
    }
}

TEST(ParallelFor, NothingToDo) {
    parallelFor(0, [](size_t) { FAIL() << "called for no item"; });
}

TEST(ParallelFor, OneThreadGoesInOrder) {
    std::vector<size_t> order;
    parallelFor(
        100, [&](size_t i) { order.push_back(i); }, 1);
    for (size_t i = 0; i < order.size(); ++i) {
        ASSERT_EQ(order[i], i);
    }
    EXPECT_EQ(order.size(), 100u);
}

TEST(ParallelFor, UsesAsManyThreadsAsAsked) {
    // Each of the four waits for the other three: with fewer threads this would not end.
    std::atomic<int> arrived{0};
    std::mutex mutex;
    std::set<std::thread::id> ids;
    parallelFor(
        4,
        [&](size_t) {
            ++arrived;
            while (arrived < 4) {
                std::this_thread::yield();
            }
            const std::lock_guard lock(mutex);
            ids.insert(std::this_thread::get_id());
        },
        4);
    EXPECT_EQ(ids.size(), 4u);
}

TEST(ParallelFor, ExceptionsReachTheCallerAndStopTheRest) {
    for (unsigned threads : {1u, 4u}) {
        std::atomic<size_t> calls{0};
        const size_t count = 1'000'000;
        try {
            parallelFor(
                count,
                [&](size_t i) {
                    ++calls;
                    if (i == 10) {
                        throw std::runtime_error("item 10");
                    }
                },
                threads);
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
    EXPECT_THROW(parallelFor(
                     1000, [](size_t) { throw std::runtime_error("each"); }, 4),
                 std::runtime_error);
}

TEST(ParallelFor, MayBeNested) {
    std::atomic<int> calls{0};
    parallelFor(
        8,
        [&](size_t) {
            parallelFor(
                8, [&](size_t) { ++calls; }, 2);
        },
        2);
    EXPECT_EQ(calls, 64);
}

// How often the thread at hand has been in a loop.
thread_local int visitsOfThread = 0;

// The least and the most visits of the threads that have been in the next loop, which is all four.
std::pair<int, int> visitsOfFour() {
    std::atomic<int> arrived{0};
    std::mutex mutex;
    std::vector<int> visits;
    parallelFor(
        4,
        [&](size_t) {
            ++arrived;
            while (arrived < 4) std::this_thread::yield();
            const std::lock_guard lock(mutex);
            visits.push_back(++visitsOfThread);
        },
        4);
    const auto [least, most] = std::minmax_element(visits.begin(), visits.end());
    return {*least, *most};
}

TEST(KeptThreads, AreThoseOfTheLoopBefore) {
    visitsOfThread = 0;
    {
        const KeptThreads threads;
        for (int loop = 1; loop <= 20; ++loop)
            EXPECT_EQ(visitsOfFour(), (std::pair{loop, loop})) << "in loop " << loop;
    }
    EXPECT_EQ(visitsOfFour(), (std::pair{1, 21})) << "new ones once they are not kept";
}

TEST(KeptThreads, EveryIndexOnceInEachOfManyLoops) {
    const KeptThreads threads;
    std::vector<std::atomic<int>> visits(64);
    for (int loop = 0; loop < 2000; ++loop) {
        const auto wanted = static_cast<unsigned>(2 + loop % 3);
        parallelFor(
            visits.size(), [&](size_t i) { ++visits[i]; }, wanted);
        for (size_t i = 0; i < visits.size(); ++i) ASSERT_EQ(visits[i], loop + 1) << i << " in loop " << loop;
    }
}

TEST(KeptThreads, WorkOnTheTermsOfEachCall) {
    const KeptThreads threads;
    std::array<CallTerms, 2> each;
    for (CallTerms& terms : each) terms.threads = 4;
    for (size_t loop = 0; loop < 50; ++loop) {
        const CallTerms& terms = each[loop % 2];
        const CallScope scope(&terms);
        std::atomic<int> arrived{0}, others{0};
        parallelFor(4, [&](size_t) {
            ++arrived;
            while (arrived < 4) std::this_thread::yield();
            if (CallScope::current() != &terms) ++others;
        });
        ASSERT_EQ(others, 0) << "in loop " << loop;
    }
}

TEST(KeptThreads, ExceptionsAndNestedLoopsAsWithoutThem) {
    const KeptThreads threads;
    for (int loop = 0; loop < 20; ++loop) {
        EXPECT_THROW(parallelFor(
                         1000, [](size_t) { throw std::runtime_error("each"); }, 4),
                     std::runtime_error);
        std::atomic<int> calls{0};
        parallelFor(
            8,
            [&](size_t) {
                parallelFor(
                    8, [&](size_t) { ++calls; }, 2);
            },
            2);
        EXPECT_EQ(calls, 64);
    }
}

TEST(KeptThreads, AreNotWaitedForByALoopWithinTheirOwn) {
    const KeptThreads threads;
    const std::thread::id caller = std::this_thread::get_id();
    std::atomic<int> arrived{0}, calls{0};
    std::atomic<bool> done{false};
    parallelFor(
        2,
        [&](size_t) {
            ++arrived;
            while (arrived < 2) std::this_thread::yield();
            if (std::this_thread::get_id() == caller) {
                parallelFor(
                    8, [&](size_t) { ++calls; }, 2);
                done = true;
            }
            while (!done) std::this_thread::yield();  // for what the other does after its loop
        },
        2);
    EXPECT_EQ(calls, 8);
}

TEST(DefaultThreadCount, FollowsTheAffinityMask) {
    cpu_set_t all;
    ASSERT_EQ(sched_getaffinity(0, sizeof(all), &all), 0);
    EXPECT_EQ(defaultThreadCount(), static_cast<unsigned>(CPU_COUNT(&all)));
    int first = 0;
    while (!CPU_ISSET(first, &all)) {
        ++first;
    }
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(first, &one);
    ASSERT_EQ(sched_setaffinity(0, sizeof(one), &one), 0);
    EXPECT_EQ(defaultThreadCount(), 1u);
    sched_setaffinity(0, sizeof(all), &all);
}

}  // namespace
}  // namespace glint::parallel_test
