#include <gtest/gtest.h>

#include <unistd.h>
#include <csignal>
#include <vector>

#include "core/context.h"
#include "core/interrupt.h"

namespace glint::context_test {

TEST(Context, GrantsAllByDefault) {
    const Context context;
    EXPECT_FALSE(context.isCancelled());
    context.checkCancelled();
    context.report(0.5);
    EXPECT_EQ(context.charge(1000).bytes(), 0u);
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

}  // namespace glint::context_test
