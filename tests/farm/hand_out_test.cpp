#include "farm/hand_out.h"

#include <gtest/gtest.h>

#include <random>

namespace glint::farm::test::hand_out_test {
namespace {

TEST(HandOut, GoesInOrderAndEndsWhenAllAreDone) {
    HandOut out(3, 3);
    EXPECT_EQ(out.next(0, 0), 1);
    EXPECT_EQ(out.next(1, 0), 2);
    EXPECT_EQ(out.next(0, 0), 3);
    EXPECT_EQ(out.next(1, 0), std::nullopt);
    for (const int unit : {3, 1, 2}) {
        EXPECT_FALSE(out.complete());
        EXPECT_TRUE(out.done(unit, 0, 1));
        EXPECT_FALSE(out.done(unit, 1, 1));
    }
    EXPECT_TRUE(out.complete());
    EXPECT_EQ(out.next(0, 2), std::nullopt);
}

TEST(HandOut, WhatTheDeadHadComesFirst) {
    HandOut out(5, 5);
    for (const int unit : {1, 2, 3}) EXPECT_EQ(out.next(unit, 0), unit);
    out.lose(1);
    EXPECT_EQ(out.next(2, 0), 1);
    EXPECT_EQ(out.next(2, 0), 4);
    out.lose(7);  // had nothing
    EXPECT_EQ(out.next(2, 0), 5);
}

// It comes back, and is done before the other.
TEST(HandOut, WhoWasGivenUpMayStillDeliver) {
    HandOut out(1, 1);
    EXPECT_EQ(out.next(1, 0), 1);
    out.lose(1);
    EXPECT_EQ(out.next(2, 1), 1);
    EXPECT_TRUE(out.done(1, 1, 2));
    EXPECT_FALSE(out.done(1, 2, 3));
    EXPECT_TRUE(out.complete());
}

TEST(HandOut, UnitsBeyondTheWindowWait) {
    HandOut out(4, 2);
    EXPECT_EQ(out.next(0, 0), 1);
    EXPECT_EQ(out.next(1, 0), 2);
    EXPECT_EQ(out.next(2, 0), std::nullopt);
    out.done(2, 1, 1);
    out.settle(2);
    EXPECT_EQ(out.next(1, 1), std::nullopt);  // unit 1 still holds them up
    out.done(1, 0, 1);
    EXPECT_EQ(out.next(0, 1), std::nullopt);  // it is not written
    out.settle(1);
    EXPECT_EQ(out.next(0, 1), 3);
    EXPECT_EQ(out.next(1, 1), 4);
}

// Not before there is nothing else, and not before it has taken three times as long as others did.
TEST(HandOut, TheSlowGetHelp) {
    HandOut out(3, 3);
    EXPECT_EQ(out.next(1, 0), 1);
    EXPECT_EQ(out.next(2, 0), 2);
    out.done(2, 2, 2);
    EXPECT_EQ(out.next(2, 10), 3);
    out.done(3, 2, 12);
    EXPECT_EQ(out.next(1, 12), std::nullopt);  // has it
    EXPECT_EQ(out.next(2, 5), std::nullopt);
    EXPECT_EQ(out.next(2, 12), 1);
    EXPECT_TRUE(out.holds(1, 1) && out.holds(1, 2));
    EXPECT_EQ(out.next(3, 12), std::nullopt);  // two are enough
    out.lose(2);
    EXPECT_EQ(out.next(3, 12), 1);
    EXPECT_TRUE(out.done(1, 3, 13));
    EXPECT_TRUE(out.complete());
}

// Whoever dies and comes whenever: all is done once, as long as anybody asks.
TEST(HandOut, NothingIsLostWhateverHappens) {
    for (uint32_t seed = 0; seed < 200; ++seed) {
        std::mt19937 random(seed);
        constexpr int kUnits = 40, kWorkers = 6;
        HandOut out(kUnits, 1 + static_cast<int>(random() % 8));
        std::vector<int> has(kWorkers, 0), taken(kUnits + 1, 0);
        double now = 0;
        for (int step = 0; step < 20'000 && !out.complete(); ++step, now += 0.1) {
            const int who = static_cast<int>(random() % kWorkers);
            int& unit = has[static_cast<size_t>(who)];
            if (random() % 5 == 0) {
                out.lose(who);
                if (random() % 2 == 0) unit = 0;  // else it was only thought dead
            } else if (unit == 0) {
                unit = out.next(who, now).value_or(0);
            } else {
                if (out.done(unit, who, now)) {
                    ++taken[static_cast<size_t>(unit)];
                    out.settle(unit);
                }
                unit = 0;
            }
        }
        EXPECT_TRUE(out.complete()) << seed;
        for (int unit = 1; unit <= kUnits; ++unit) EXPECT_EQ(taken[static_cast<size_t>(unit)], 1);
    }
}

}  // namespace
}  // namespace glint::farm::test::hand_out_test
