// The limits that follow from counts of pixels.
#include "reference/sensitivity.h"

#include <gtest/gtest.h>

#include <cmath>

namespace glint::reference::test::sensitivity_test {

// Tables of the Poisson distribution, and its own definition.
TEST(Sensitivity, LimitsOfCountsAreThoseOfThePoissonDistribution) {
    EXPECT_NEAR(greatestMean(0), -std::log(1 - kConfidence), 1e-9);
    for (const uint64_t count : {uint64_t{1}, uint64_t{10}, uint64_t{400}, uint64_t{3000}}) {
        const double mean = greatestMean(count);
        EXPECT_GT(mean, static_cast<double>(count) + 3 * std::sqrt(static_cast<double>(count)));
        EXPECT_LT(mean, static_cast<double>(count) + 3.3 * std::sqrt(static_cast<double>(count)) + 8);
    }
    EXPECT_EQ(greatestCount(0), 0u);
    EXPECT_EQ(greatestCount(1), 5u);    // P(X > 5) = 0.0006, P(X > 4) = 0.0037
    EXPECT_EQ(greatestCount(10), 21u);  // P(X > 21) = 0.0007, P(X > 20) = 0.0016
    EXPECT_NEAR(static_cast<double>(greatestCount(10000)), 10000 + 3.09 * 100, 3);
}

TEST(Sensitivity, WideMovesCountForAsManyUnits) {
    Sensitivity s;
    s.tried = 1000;
    s.changedWidely = 100;
    const double gain = kShareOfPrediction / 1000;
    EXPECT_NEAR(s.explainedShare(), gain * greatestMean(100) / kWideUnits, 1e-12);
    s.changed = 50;  // chaotic: far more than a thirty-second of them
    EXPECT_NEAR(s.explainedShare(), gain * greatestMean(50), 1e-12);
    s.moves = 3;  // by all three together
    const double moved = gain * greatestMean(50) / 3;
    EXPECT_NEAR(s.explainedShare(), moved, 1e-12);
    s.open = 5;  // all of which may differ
    EXPECT_NEAR(s.explainedShare(), moved + greatestMean(5) / 1000, 1e-12);
}

}  // namespace glint::reference::test::sensitivity_test
