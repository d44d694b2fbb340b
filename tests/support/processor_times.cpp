// GLINT_TEST_TIMES=FILE: every test appends a line with the processor seconds that it took, all threads and
// children together, and its name. Elapsed times say nothing on a machine that does other work besides, or of
// a device that is the same processor.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>

namespace glint::test {
namespace {

double processorSeconds() {
    double seconds = 0;
    for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
        rusage usage{};
        getrusage(who, &usage);
        for (const timeval& t : {usage.ru_utime, usage.ru_stime})
            seconds += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    }
    return seconds;
}

// Test environments count as their program's first test, set-ups of a suite as the suite's first.
class ProcessorTimes : public testing::EmptyTestEventListener {
    void OnTestEnd(const testing::TestInfo& test) override {
        const double now = processorSeconds();
        // Opened anew for each line: several programs may append to one file.
        if (std::FILE* file = std::fopen(std::getenv("GLINT_TEST_TIMES"), "a")) {
            std::fprintf(file, "%.3f %s.%s\n", now - last_, test.test_suite_name(), test.name());
            std::fclose(file);
        }
        last_ = now;
    }
    double last_ = 0;
};

[[maybe_unused]] const bool listens = [] {
    // googletest owns listeners.
    if (std::getenv("GLINT_TEST_TIMES"))
        testing::UnitTest::GetInstance()->listeners().Append(new ProcessorTimes);
    return true;
}();

}  // namespace
}  // namespace glint::test
