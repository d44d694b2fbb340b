#include "core/interrupt.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>

namespace glint::interrupt_test {
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

TEST_F(InterruptDeathTest, SecondSigintEndsTheProcess) {
    EXPECT_EXIT(
        {
            std::raise(SIGINT);
            std::raise(SIGINT);
            _exit(0);
        },
        ::testing::ExitedWithCode(130), "");
}

TEST_F(InterruptDeathTest, SigintAfterSigtermEndsTheProcess) {
    EXPECT_EXIT(
        {
            std::raise(SIGTERM);
            std::raise(SIGINT);
            _exit(0);
        },
        ::testing::ExitedWithCode(130), "");
}

TEST_F(Interrupt, IgnoredSignalsStayIgnored) {
    std::signal(SIGINT, SIG_IGN);
    installInterruptHandler();
    std::raise(SIGINT);
    EXPECT_FALSE(interrupted());
}

}  // namespace glint::interrupt_test
