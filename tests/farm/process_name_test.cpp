#include "farm/process_name.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmath>

namespace glint::farm::test::process_name_test {
namespace {

// The name that a child of this process has, and its number.
struct Named {
    pid_t pid;
    std::string name;
};

Named child() {
    int pipe[2];
    EXPECT_EQ(::pipe(pipe), 0);
    const pid_t pid = ::fork();
    if (pid == 0) {
        ::close(pipe[1]);
        char byte = 0;
        [[maybe_unused]] const ssize_t ignored = ::read(pipe[0], &byte, 1);
        ::_exit(0);
    }
    ::close(pipe[0]);
    return {pid, processNamed(pid)};
}

TEST(ProcessName, TheLivingHaveNotEnded) {
    EXPECT_EQ(nameOfThisProcess().find(' '), std::string::npos);
    EXPECT_EQ(nameOfThisProcess(), processNamed(::getpid()));
    EXPECT_FALSE(hasEnded(nameOfThisProcess()));
    const Named other = child();
    EXPECT_FALSE(hasEnded(other.name));
    ::kill(other.pid, SIGSTOP);
    EXPECT_FALSE(hasEnded(other.name));
    ::kill(other.pid, SIGKILL);
    ::waitpid(other.pid, nullptr, 0);
}

TEST(ProcessName, TheDeadHave) {
    const Named other = child();
    ::kill(other.pid, SIGKILL);
    siginfo_t info{};
    ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(other.pid), &info, WEXITED | WNOWAIT), 0);
    EXPECT_TRUE(hasEnded(other.name));  // as long as nobody has asked for its end, too
    ::waitpid(other.pid, nullptr, 0);
    EXPECT_TRUE(hasEnded(other.name));
}

// A number that has been given to another process.
TEST(ProcessName, NumbersAreUsedAgain) {
    std::string name = nameOfThisProcess();
    name += '1';  // started at another time
    EXPECT_TRUE(hasEnded(name));
}

// The name ends with that time: clock ticks since the system was started, which a clock of its own counts
// too.
TEST(ProcessName, HasTheTimeOfItsStart) {
    timespec now{};
    ASSERT_EQ(::clock_gettime(CLOCK_BOOTTIME, &now), 0);
    const Named other = child();
    const double seconds = static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
    const double ticks = std::stod(other.name.substr(other.name.rfind('/') + 1));
    EXPECT_LT(std::abs(ticks / static_cast<double>(::sysconf(_SC_CLK_TCK)) - seconds), 2) << other.name;
    ::kill(other.pid, SIGKILL);
    ::waitpid(other.pid, nullptr, 0);
}

TEST(ProcessName, WhatCannotBeToldIsNotSaid) {
    std::string name = nameOfThisProcess();
    name.front() =
        name.front() == 'f' ? 'e' : 'f';  // another machine, or the same before it was started anew
    EXPECT_FALSE(hasEnded(name));
    for (const char* text : {"", "?", "?/1/2", "a/b/c", "///"}) EXPECT_FALSE(hasEnded(text)) << text;
}

}  // namespace
}  // namespace glint::farm::test::process_name_test
